"""`python -m benchmarks.measured FOLDER`: diagnose every case of a folder; write a page on each and a table of all."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from benchmarks.measured.index import index
from benchmarks.measured.page import Rig, page
from benchmarks.measured.picture import draw_errors, draw_windows
from harness.api.case import Case, load_case
from harness.api.diagnosis import diagnose, input_hashes
from harness.api.saved import LoadedDiagnosis, load_diagnosis
from harness.errors import HarnessError
from harness.identify.record import FILE
from harness.recording.case import BUILT_IN, RIG_FILE

_PATH = click.Path(path_type=Path)


def cases_of(folder: Path, names: Sequence[str] = ()) -> list[Path]:
    """Case folders in a folder, by name; the built-in ones that it has count as these."""
    found = {file.parent.name: file.parent for file in sorted(folder.glob(f"*/{RIG_FILE}"))}
    missing = [name for name in names if name not in found]
    if missing or not found:
        what = f"has no case {', '.join(missing)}" if missing else "has no cases"
        raise click.UsageError(f"{folder} {what}; give a folder of folders with a {RIG_FILE} each")
    return [BUILT_IN.get(name, path) for name, path in found.items() if not names or name in names]


def made_or_kept(case: Case, reports: Path, keep: bool) -> LoadedDiagnosis:
    """The diagnosis of a case; the one in `reports` if it is to be kept and was made from the same files."""
    folder = reports / case.name
    if keep and (folder / FILE).is_file():
        kept = load_diagnosis(folder)
        if kept.record.inputs.hashes == input_hashes(case):
            return kept
    return diagnose(case, out=folder, jobs=os.cpu_count() or 1, progress=True)


def write_page(case: Case, diagnosis: LoadedDiagnosis, out: Path) -> Rig:
    """Write the page on a rig, with its pictures: readings are drawn of built-in cases only, which are free."""
    rig = Rig(case, diagnosis)
    out.mkdir(parents=True, exist_ok=True)
    pictures = []
    if rig.compared is not None:
        pictures.append((draw_errors(rig.compared, out / f"{case.name}_errors.png"), "held-out errors by source"))
    if case.name in BUILT_IN:
        where = draw_windows(case, diagnosis, out / f"{case.name}_windows.png")
        pictures.append((where, "windows, measured and predicted while held out"))
    (out / f"{case.name}.md").write_text(page(rig, pictures), encoding="utf-8", newline="\n")
    return rig


@click.command(help=__doc__)
@click.argument("folder", type=_PATH)
@click.option("--out", type=_PATH, default=Path("docs/measured_rigs"), show_default=True, help="Folder of the pages.")
@click.option(
    "--reports", type=_PATH, default=Path("reports/measured"), show_default=True, help="Folder of the diagnoses."
)
@click.option("--keep", is_flag=True, help="Keep diagnoses in --reports that were made from the same files.")
@click.option("--only", "names", multiple=True, metavar="NAME", help="Diagnose this case only; repeatable.")
def main(folder: Path, out: Path, reports: Path, keep: bool, names: tuple[str, ...]) -> None:
    """Diagnose, then write; a case that fails is named, left out, and makes the exit code 3."""
    rigs, failed = [], False
    for path in cases_of(folder, names):
        click.echo(f"{path.name} …", err=True)
        try:
            case = load_case(path)
            rigs.append(write_page(case, made_or_kept(case, reports, keep), out))
        except HarnessError as error:
            failed = True
            click.echo(f"error: {path.name}: {error}", err=True)
            continue
        click.echo(f"{case.name}: {rigs[-1].diagnosis.sentence}")
    if rigs:
        out.with_suffix(".md").write_text(index(rigs, out.name), encoding="utf-8", newline="\n")
    sys.exit(3 if failed else 0)


if __name__ == "__main__":
    main()
