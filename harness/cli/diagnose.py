"""`harness diagnose`: identify missing physics, write diagnosis.json and a report."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import click

from harness.api.diagnosis import REPORT, diagnose
from harness.api.outputs import report_folder
from harness.identify.record import FILE


def diagnose_case(path: Path, *, out: Path | None, also: Sequence[Path], effects: Sequence[Path], as_json: bool) -> int:
    """Diagnose a case, write the files, print the verdict; return the exit code. Options as for `harness.diagnose`.

    Raises:
        InputError: an input cannot be used; nothing has been written then.
    """
    folder = out or report_folder(path)
    made = diagnose(path, also=also, effects=effects, out=folder, jobs=os.cpu_count() or 1, progress=True)
    files = f"diagnosis: {folder / FILE}\nreport: {folder / REPORT}"
    click.echo(made.record.text() if as_json else f"{made.sentence}\n{files}")
    return 0
