"""`harness run`: one recording through every model and engine, into a report."""

from __future__ import annotations

import math
import shlex
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

import click

from analytic.motion import State
from harness.cli.outputs import all_or_nothing, manifest, report_folder, to_json, write_tables
from harness.cli.progress import told_on_stderr
from harness.comparison import Choices, Study, prepare, study
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of, parameters_of, read_settings
from harness.engines.protocol import Engine, EngineParameters
from harness.errors import EngineFailure, InputError
from harness.metrics import Score
from harness.recording import Case
from harness.report.comparison import render_comparison
from harness.tolerances import Checked, Tolerances, check, render_table, tolerances_for


def run_case(
    case: Case,
    *,
    out: Path | None = None,
    recording: str | None = None,
    engines: Sequence[str] = (),
    assignments: Sequence[str] = (),
    parameters: Path | None = None,
    start: State | None = None,
    level_angle: float | Literal["estimate"] | None = None,
    windows: Sequence[float] = (),
    tube: float = 0.010,
    seed: int = 0,
    check_limits: bool = False,
    tolerances: Path | None = None,
    as_json: bool = False,
) -> int:
    """Run the comparison, write its files, say the answer; return the exit code.

    Raises:
        InputError: anything the user gave cannot be used; nothing has been written then.
    """
    begin = time.monotonic()
    chosen = _choose_engines(engines, read_settings(parameters, assignments))
    limits = tolerances_for(case.path, tolerances) if check_limits or tolerances else None
    if limits is not None and engines:  # limits on engines that the user left out are not what was asked
        limits = limits.without(set(limits.engines) - set(engines))
    choices = Choices(
        recording=recording,
        start=start,
        level_angle=level_angle,
        lengths=tuple(windows) or Choices.lengths,
        tolerance=tube,
        seed=seed,
    )
    if limits is not None:
        choices = limits.settle(choices)
    progress = told_on_stderr()
    folder = out or report_folder(case)
    with all_or_nothing(folder) as scratch:  # entered first: what cannot be written need not be computed
        progress("drive and measured state")
        result = study(prepare(case, choices), chosen, progress)
        checks = check(result, limits) if limits is not None else []
        progress("report")
        write_tables(result, scratch)
        facts = manifest(result, command=shlex.join(["harness", *sys.argv[1:]]), wall_time=time.monotonic() - begin)
        (scratch / "manifest.json").write_text(to_json(facts) + "\n", encoding="utf-8")
        (scratch / "report.html").write_text(render_comparison(result, facts, checks=checks), encoding="utf-8")
    progress("")
    click.echo(_as_json(result, checks, folder) if as_json else _as_text(result, checks, limits, folder))
    for text in _failures(result):
        click.echo(f"error: {text}", err=True)
    if result.failures:
        return 3
    return 0 if all(one.passed for one in checks) else 1


def _choose_engines(
    names: Sequence[str], settings: Mapping[str, Mapping[str, Any]]
) -> list[tuple[Engine, EngineParameters]]:
    """Those that are named; else the default ones and whichever has settings. All settings are checked."""
    idle = sorted(set(settings) - set(names)) if names else []
    if idle:
        raise InputError(f"parameters of {', '.join(idle)} are set, but --engine leaves it out; name it or drop them")
    engines = {name: engine_of(name) for name in dict.fromkeys((*(names or DEFAULT_ENGINES), *settings))}
    checked = {name: parameters_of(engine, settings.get(name, {})) for name, engine in engines.items()}
    return [(engines[name], checked[name]) for name in dict.fromkeys(names or engines)]


def _failures(result: Study) -> list[str]:
    """One message an engine, however many of its runs failed."""
    by_engine: dict[str, list[EngineFailure]] = {}
    for failure in result.failures:
        by_engine.setdefault(failure.engine, []).append(failure)
    runs = {run.source: 0 for run in result.runs}
    for run in result.runs:
        runs[run.source] += len(run.horizon.first)
    return [
        f"{failures[0]} ({len(failures)} of its {runs[name]} runs failed; the report has the other sources)"
        for name, failures in by_engine.items()
    ]


def _as_json(result: Study, checks: Sequence[Checked], folder: Path) -> str:
    return to_json(
        {
            "out": str(folder),
            "report": str(folder / "report.html"),
            "recording": result.setting.recording.name,
            "origin": result.setting.case.origin,
            "headline": result.headline.name,
            "scores": [asdict(score) for score in result.scores],
            "claims": [asdict(claim) for claim in result.claims],
            "attribution": {one.source: one.rms() for one in result.attributions},
            "checks": [asdict(one) for one in checks],
            "findings": [asdict(one) for one in result.setting.case.findings],
            "failures": [str(failure) for failure in result.failures],
        }
    )


def _as_text(result: Study, checks: Sequence[Checked], limits: Tolerances | None, folder: Path) -> str:
    """The answer on a terminal: the table of the headline horizon, the checks, where the report is."""
    from harness.report.answer import answer

    setting = result.setting
    lines = [
        f"{setting.recording.path} ({setting.case.origin})" if setting.case.origin else str(setting.recording.path)
    ]
    lines += [
        f"  {one.severity}: {one.where}: {one.text}" for one in setting.case.findings if one.severity == "warning"
    ]
    for one in setting.estimates:
        spread = f" ± {one.std:.2g}" if math.isfinite(one.std) else ""  # what is assumed has none
        unit = "" if one.unit == "1" else f" {one.unit}"
        lines.append(f"  {one.name} = {one.value:.5g}{spread}{unit} ({one.how})")
    lines += ["", *answer(result), "", _table([result.score_of(name, result.headline) for name in result.sources])]
    if limits is not None:
        lines += ["", f"tolerances: {limits.path} ({limits.chosen})", render_table(checks)]
    return "\n".join([*lines, "", f"report: {folder / 'report.html'}"])


def _table(scores: Sequence[Score]) -> str:
    head = f"{'source':<30}{'RMS [mm]':>10}{'max [mm]':>10}{'fit [%]':>9}{'E/u_val':>9}{'ISO 18571':>11}"
    rows = [
        f"{s.source:<30}{s.rms_error_mm:>10.2f}{1e3 * s.max_error_m:>10.2f}{s.fit_percent:>9.1f}"
        f"{s.rms_error_over_uncertainty:>9.1f}{s.iso18571_rating:>11.2f}"
        for s in scores
    ]
    return "\n".join([f"horizon: {scores[0].horizon}", head, *rows])
