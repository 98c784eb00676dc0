"""`harness run`: compare every model and engine with one recording, write a report."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.api.comparison import REPORT, Comparison, compare
from harness.api.outputs import report_folder, to_json
from harness.errors import EngineFailure
from harness.recording.case import BUNDLED

if TYPE_CHECKING:
    from harness.metrics import Score


def run_case(
    path: Path | None,
    *,
    out: Path | None,
    assignments: Sequence[str],
    parameters: Path | None,
    check_limits: bool,
    as_json: bool,
    **options: Any,
) -> int:
    """Run the comparison, write its files, print the result; return the exit code.

    Args:
        path: of the case; `None` for the bundled one.
        out: folder to write into.
        assignments, parameters: settings of engines, as texts and as a file.
        check_limits: check the result against tolerances.
        as_json: print JSON.
        options: of `harness.comparison`.

    Raises:
        InputError: an input cannot be used; nothing has been written then.
    """
    from harness.engines.catalogue import read_settings

    settings = read_settings(parameters, assignments)
    case = path or BUNDLED
    folder = out or report_folder(case)
    made = compare(case, settings=settings, check=check_limits, out=folder, progress=True, **options)
    click.echo(_as_json(made, folder) if as_json else _as_text(made, folder))
    for text in _failures(made):
        click.echo(f"error: {text}", err=True)
    if made.failures:
        return 3
    return 0 if all(one.passed for one in made.checks) else 1


def _failures(result: Comparison) -> list[str]:
    """One message per engine, whatever the number of its failed runs."""
    by_engine: dict[str, list[EngineFailure]] = {}
    for failure in result.failures:
        by_engine.setdefault(failure.engine, []).append(failure)
    runs = {run.source: 0 for run in result.study.runs}
    for run in result.study.runs:
        runs[run.source] += len(run.horizon.first)
    return [
        f"{failures[0]} ({len(failures)} of its {runs[name]} runs failed; the report has the other sources)"
        for name, failures in by_engine.items()
    ]


def _as_json(made: Comparison, folder: Path) -> str:
    result = made.study
    return to_json(
        {
            "out": str(folder),
            "report": str(folder / REPORT),
            "recording": result.setting.recording.name,
            "origin": result.setting.case.origin,
            "headline": result.headline.name,
            "scores": [asdict(score) for score in result.scores],
            "claims": [asdict(claim) for claim in result.claims],
            "attribution": {one.source: one.rms() for one in result.attributions},
            "checks": [asdict(one) for one in made.checks],
            "findings": [asdict(one) for one in result.setting.case.findings],
            "failures": [str(failure) for failure in result.failures],
        }
    )


def _as_text(made: Comparison, folder: Path) -> str:
    """Text for the terminal: answer, scores at the headline horizon, checks, path of the report."""
    result, limits = made.study, made.limits
    setting = result.setting
    lines = [
        f"{setting.recording.path} ({setting.case.origin})" if setting.case.origin else str(setting.recording.path)
    ]
    lines += [
        f"  {one.severity}: {one.where}: {one.text}" for one in setting.case.findings if one.severity == "warning"
    ]
    for one in setting.estimates:
        error = f" ± {one.std:.2g}" if math.isfinite(one.std) else ""  # an assumed value has none
        unit = "" if one.unit == "1" else f" {one.unit}"
        lines.append(f"  {one.name} = {one.value:.5g}{error}{unit} ({one.how})")
    lines += ["", *made.answer, "", _table([result.score_of(name, result.headline) for name in result.sources])]
    if limits is not None:
        from harness.tolerances import render_table

        lines += ["", f"tolerances: {limits.path} ({limits.chosen})", render_table(made.checks)]
    return "\n".join([*lines, "", f"report: {folder / REPORT}"])


def _table(scores: Sequence[Score]) -> str:
    head = f"{'source':<30}{'RMS [mm]':>10}{'max [mm]':>10}{'fit [%]':>9}{'E/u_val':>9}{'ISO 18571':>11}"
    rows = [
        f"{s.source:<30}{s.rms_error_mm:>10.2f}{1e3 * s.max_error_m:>10.2f}{s.fit_percent:>9.1f}"
        f"{s.rms_error_over_uncertainty:>9.1f}{s.iso18571_rating:>11.2f}"
        for s in scores
    ]
    return "\n".join([f"horizon: {scores[0].horizon}", head, *rows])
