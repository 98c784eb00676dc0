"""`python -m benchmarks.sweep_growth`: memory, time and disk of sweeps by size, two tables in docs/sweeps.md.

Each size is one command in a process of its own: so many runs of one recording, or 64 runs of each of so many
recordings. Time is the processor time of everything, as such and over that of the bare runs alone, which holds for
other machines.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import click
import pyarrow.parquet as pq

from benchmarks.growth.cases import LENGTH, Size, write_sizes
from benchmarks.sections import apart, put

_SPEC = """cases = ["{case}"]
recordings = {recordings}
sources = ["mujoco"]
time_step = 5e-3
design = "latin_hypercube"
size = {size}
[mujoco]
friction = {{ low = 0.2, high = 1.0 }}
"""
_DOCS = Path("docs/sweeps.md")
_CASE = "paper_protocol"
_EACH = 64  # runs of a recording, where the number of recordings grows
_RUNS, _RECORDINGS = (64, 256, 1024, 4096), (2, 8, 32)


@dataclass(frozen=True)
class Grown:
    """What a sweep of some size took.

    Attributes:
        runs: how many.
        recordings: of how many recordings.
        memory: of its largest process [bytes].
        seconds: processor time of all of its processes [s].
        overhead: processor time of all of its processes over that of the bare runs [1].
        disk: of `runs.parquet` over the runs [bytes].
    """

    runs: int
    recordings: int
    memory: int
    seconds: float
    overhead: float
    disk: float


def grown(size: int, folder: Path, case: str = _CASE, recordings: int = 1) -> Grown:
    """Carry out a sweep of `size` runs of each of the recordings of a case."""
    name = f"size_{size}_{recordings}"
    spec, out = folder / f"{name}.toml", folder / name
    chosen = '["rec_01.csv"]' if recordings == 1 else '"all"'
    spec.write_text(_SPEC.format(size=size, case=case, recordings=chosen), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "harness", "sweep", str(spec), "--out", str(out), "--yes"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise click.ClickException(f"the sweep {name} ended with {os.waitstatus_to_exitcode(status)}")
    rows = out / "runs.parquet"
    times = pq.read_table(rows, columns=["cpu_s"])["cpu_s"].to_pylist()
    spent = usage.ru_utime + usage.ru_stime
    assert len(times) == size * recordings
    disk = rows.stat().st_size / len(times)
    return Grown(len(times), recordings, 1024 * usage.ru_maxrss, spent, spent / sum(times), disk)


def table(measured: list[Grown]) -> str:
    """Markdown."""
    heads = (
        "recordings",
        "runs",
        "largest process [MB]",
        "processor time [s]",
        "over that of bare runs",
        "`runs.parquet`, bytes a run",
    )
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    lines += [
        f"| {one.recordings} | {one.runs} | {one.memory / 1e6:.0f} | {one.seconds:.0f} | {one.overhead:.2f} "
        f"| {one.disk:.0f} |"
        for one in measured
    ]
    return "\n".join(lines)


@click.command()
@click.option("--runs", type=int, multiple=True, default=_RUNS, show_default=True, help="Of one recording.")
@click.option("--recordings", type=int, multiple=True, default=_RECORDINGS, show_default=True, help="64 runs of each.")
@click.option("--docs", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Page with the tables.")
def main(runs: tuple[int, ...], recordings: tuple[int, ...], docs: Path) -> None:
    """Measure how memory, time and disk grow with the size of a sweep, and write the tables.

    Example: python -m benchmarks.sweep_growth --runs 64 --recordings 2
    """
    with tempfile.TemporaryDirectory(prefix="sweep-growth-") as scratch:
        folder = Path(scratch)
        of_runs = [grown(size, folder) for size in runs]
        cases = write_sizes(folder, [Size(count, LENGTH) for count in recordings])
        of_recordings = [grown(_EACH, folder, str(path), size.recordings) for size, path in cases.items()]
    page = docs.read_text(encoding="utf-8")
    for name, measured in (("growth", of_runs), ("growth of recordings", of_recordings)):
        click.echo(table(measured))
        page = apart(name, put(name, table(measured), page, title="Sweeps"))
    docs.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
