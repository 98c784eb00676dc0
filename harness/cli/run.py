"""`harness run`: compare every model and engine with one recording, write a report."""

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from harness.api.comparison import HEADS, REPORT, Comparison, compare, headline_rows
from harness.api.outputs import report_folder, to_json
from harness.cli.options import is_quiet
from harness.recording.case import BUNDLED, load_case
from harness.recording.findings import warnings_of
from harness.recording.rig_changes import RIG_CHANGES, with_rig_changes


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
    folder = out or report_folder(path or BUNDLED)
    case = with_rig_changes(load_case(path or BUNDLED), parameters)
    made = compare(case, settings=settings, check=check_limits, out=folder, progress=not is_quiet(), **options)
    brief = "\n".join([*made.answer[:1], f"report: {folder / REPORT}"])
    click.echo(_as_json(made, folder) if as_json else brief if is_quiet() else _as_text(made, folder))
    for text in (*_failures(made), *made.report_failures):
        click.echo(f"error: {text}", err=True)
    if made.study.engine_failures or made.report_failures:
        return 3
    return 0 if all(one.passed for one in made.checks) else 1


def _failures(result: Comparison) -> list[str]:
    """One message per engine, whatever the number of its failed runs."""
    failed = Counter(failure.engine for failure in result.study.engine_failures)
    first = {failure.engine: failure for failure in reversed(result.study.engine_failures)}
    runs = Counter(run.source for run in result.study.runs for _ in run.horizon.first)
    return [
        f"{first[name]} ({count} of its {runs[name]} runs failed; the report has the other sources)"
        for name, count in failed.items()
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
            "scores": result.scores,
            "claims": result.claims,
            "attribution": {one.source: one.rms() for one in result.attributions},
            "checks": made.checks,
            "findings": result.setting.case.findings,
            "lift_off": dict(result.lift_offs),
            "failures": [str(failure) for failure in (*made.study.engine_failures, *made.report_failures)],
        }
    )


def _as_text(made: Comparison, folder: Path) -> str:
    """Text for the terminal: answer, scores at the headline horizon, checks, path of the report."""
    result, limits = made.study, made.limits
    setting = result.setting
    lines = [
        f"{setting.recording.path} ({setting.case.origin})" if setting.case.origin else str(setting.recording.path)
    ]
    lines += [f"  {one}" for one in warnings_of(setting.case.findings)]
    lines += [f"  {one}" for one in setting.case.findings if one.code == RIG_CHANGES]
    for one in setting.estimates:
        error = f" ± {one.std:.2g}" if math.isfinite(one.std) else ""  # an assumed value has none
        unit = "" if one.unit == "1" else f" {one.unit}"
        lines.append(f"  {one.name} = {one.value:.5g}{error}{unit} ({one.how})")
    lines += ["", *made.answer, "", _table(made)]
    if limits is not None:
        from harness.tolerances import render_table

        lines += ["", f"tolerances: {limits.path} ({limits.chosen})", render_table(made.checks)]
    return "\n".join([*lines, "", f"report: {folder / REPORT}"])


def _table(made: Comparison) -> str:
    rows = [HEADS, *headline_rows(made.study)]
    lines = [f"{name:<30}" + "".join(map(str.rjust, cells, (10, 10, 9, 9, 11))) for name, *cells in rows]
    return "\n".join([f"horizon: {made.study.headline.name}", *lines])
