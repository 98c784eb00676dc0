"""`python -m benchmarks.growth`: how the time of `harness diagnose` grows; writes `docs/growth.md` and `.json`."""

from __future__ import annotations

import json
import sys
import tempfile
from functools import partial
from pathlib import Path

import click

from benchmarks.calibration.store import sources_digest
from benchmarks.growth.cases import LENGTH, Size, write_sizes
from benchmarks.growth.measure import diagnosis_time, run
from benchmarks.growth.page import page, summary
from benchmarks.growth.rows import Rows

_RECORDINGS, _LENGTHS = (2, 4, 8, 16, 32, 64), (16.0, 32.0, 64.0, 128.0, 256.0, 640.0)
_ROWS, _DOCS = Path("build/growth/times.jsonl"), Path("docs")


@click.command()
@click.option("--most-recordings", type=click.IntRange(2), default=64, show_default=True, help="Largest number.")
@click.option("--longest", type=click.FloatRange(16.0), default=640.0, show_default=True, help="Largest length [s].")
@click.option(
    "--sysid",
    "case",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Case to compare with one fit by mujoco.sysid (extra `sysid`), a folder with rig.toml.",
)
@click.option("--rounds", type=click.IntRange(1), default=1, show_default=True, help="Repetitions of everything.")
@click.option("--rows", "path", type=click.Path(path_type=Path), default=_ROWS, show_default=True, help="Times so far.")
@click.option("--docs", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Folder of the page.")
def main(most_recordings: int, longest: float, case: Path | None, rounds: int, path: Path, docs: Path) -> None:
    """Measure `harness diagnose` on simulated cases of growing size, one after the other, smallest first.

    All of it takes a quarter of an hour; what has been measured from the same sources is not measured again, and the
    page is written after each measurement from what there is.

    \b
    Examples:
      python -m benchmarks.growth --most-recordings 8 --longest 64
      python -m benchmarks.growth --sysid my_rig/ --rounds 3
    """
    source = sources_digest()
    rows = Rows(path, source)
    of_number = [Size(count, LENGTH) for count in _RECORDINGS if count <= most_recordings]
    of_length = [Size(1, length) for length in _LENGTHS if length <= longest]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        cases = write_sizes(folder, [*of_number, *of_length])
        smallest = min(cases, key=lambda size: size.recordings * size.length)
        diagnosis_time(
            cases[smallest], folder / "out"
        )  # not counted: the first run of new sources compiles its kernels
        for number in range(rounds):
            tasks = [("recordings", float(size.recordings), cases[size]) for size in of_number]
            tasks += [("length", size.length, cases[size]) for size in of_length]
            tasks += [] if case is None else [("diagnose", 0.0, case)]
            for what, size, one in sorted(tasks, key=lambda task: task[1]):
                row = rows.measured(what, size, number, partial(diagnosis_time, one, folder / "out"))
                click.echo(f"{what} {size:g}: {row.cpu:.1f} s of processor time, {row.wall:.1f} s", err=True)
                if what == "diagnose":
                    fit = [sys.executable, "-m", "benchmarks.growth.by_sysid", str(one)]
                    row = rows.measured("sysid", 0.0, number, partial(run, fit))
                    click.echo(f"mujoco.sysid: {row.cpu:.1f} s of processor time, {row.wall:.1f} s", err=True)
                told = summary(rows.all, source)
                (docs / "growth.json").write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
                (docs / "growth.md").write_text(page(told, case.name if case else ""), encoding="utf-8")
    click.echo(docs / "growth.md")


if __name__ == "__main__":
    main()
