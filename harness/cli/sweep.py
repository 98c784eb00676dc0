"""`harness sweep`: many runs over settings, step sizes, rig quantities, effects and recordings."""

from __future__ import annotations

import os
import shlex
import sys
from pathlib import Path

import click

from harness.cli.options import PathType, Whole, is_quiet, quiet_option


@click.command()
@click.argument("spec", type=PathType())
@click.option("--out", type=PathType(), help="Folder to write into [default: reports/<name of the spec>].")
@click.option(
    "--jobs",
    type=Whole(min=1),
    metavar="N",
    help="Processes on this machine [default: one a processor].",
)
@click.option(
    "--on",
    default="",
    metavar="dask://HOST:PORT",
    help="Run on the workers of this Dask cluster instead (extra dask).",
)
@click.option(
    "--force",
    is_flag=True,
    help="Discard the runs of another sweep in the folder, and replace files there that no sweep wrote.",
)
@click.option("--yes", is_flag=True, help="Go on although it takes over ten minutes or 4 GB.")
@click.option("--json", "as_json", is_flag=True, help="Print the results as JSON on stdout.")
@quiet_option
def sweep(spec: Path, out: Path | None, jobs: int | None, on: str, force: bool, yes: bool, as_json: bool) -> None:
    """Run models and engines over contact parameters, step sizes [s], rig quantities, effects and recordings.

    SPEC is a sweep.toml (docs/sweeps.md): a grid, a Latin hypercube or Sobol' points. Writes runs.parquet with one row
    a run, sweep.html (error against time, which parameter matters, best fit to the measurement, failures by name) and
    sweep.json. A sweep that was interrupted or killed goes on with the same command. A run that fails is a row; the
    exit code is 3 if all runs of an engine do.

    \b
    Examples:
      harness sweep docs/examples/sweep.toml
      harness sweep sweep.toml --out reports/friction --jobs 4
      harness sweep sweep.toml --on dask://192.0.2.7:8786 --yes
    """
    from harness.api.outputs import to_json
    from harness.api.sweep import REPORT, ROWS
    from harness.api.sweep import sweep as carry_out

    command = shlex.join(["harness", *sys.argv[1:]])
    workers = jobs or os.cpu_count() or 1
    made = carry_out(spec, out=out, jobs=workers, on=on, force=force, yes=yes, command=command, progress=not is_quiet())
    files = f"rows: {made.folder / ROWS}\nreport: {made.folder / REPORT}"
    click.echo(to_json(made.content()) if as_json else files if is_quiet() else f"{made!r}\n\n{files}")
    for name in made.failed_sources:
        click.echo(f"error: all runs of {name} failed; the report says how", err=True)
    for one in made.report_failures:
        click.echo(f"error: {one}", err=True)
    sys.exit(3 if made.failed_sources or made.report_failures else 0)
