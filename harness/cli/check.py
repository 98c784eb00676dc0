"""`harness check`: whether a case is fit for use, and which effects it could show at which size."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from harness.cli.options import CaseType, PathType, is_quiet, quiet_option


@click.command()
@click.argument("case", type=CaseType())
@click.option("--out", type=PathType(), help="Folder to write check.html and check.json into [default: none].")
@click.option(
    "--force", is_flag=True, help="Replace files that this command did not write, or that have been changed since."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON on stdout.")
@quiet_option
def check(case: Path, out: Path | None, force: bool, as_json: bool) -> None:
    """Check whether recordings are fit for use, and which effects they could show at which size.

    CASE is a folder with rig.toml and CSV recordings, a CSV file (then the paper's rig is assumed), or a bundled case.
    Nothing is searched for: it takes seconds, a minute or two with many recordings. The exit code is 1 if
    the recordings are not fit: a finding makes any verdict worthless, or they hold too little to go by.

    \b
    Examples:
      harness check my_rig/
      harness check my_rig/ --out reports/my_rig
      harness check swing.csv --json
    """
    from harness.api.check import FILE, REPORT
    from harness.api.check import check as look
    from harness.api.outputs import to_json

    made = look(case, out=out, force=force, progress=not is_quiet())
    if as_json:
        click.echo(to_json(made.record()))
    elif is_quiet():
        click.echo("\n".join([made.sentence, *made.reasons]))
    else:
        click.echo(made.summary().text())
    if out is not None and not as_json:
        click.echo(f"report: {out / REPORT}\nresult: {out / FILE}")
    sys.exit(0 if made.fit else 1)
