"""`python -m benchmarks.sweep_growth`: memory, time and disk of sweeps by size, a table in docs/sweeps.md.

Each size is one command in a process of its own. Time is the processor time of everything over that of the bare runs
alone, so that it holds for other machines.
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

from benchmarks.sections import put

_SPEC = """cases = ["paper_protocol"]
sources = ["mujoco"]
time_step = 5e-3
design = "latin_hypercube"
size = {size}
[mujoco]
friction = {{ low = 0.2, high = 1.0 }}
"""
_DOCS = Path("docs/sweeps.md")


@dataclass(frozen=True)
class Grown:
    """What a sweep of some size took.

    Attributes:
        runs: how many.
        memory: of its largest process [bytes].
        overhead: processor time of all of its processes over that of the bare runs [1].
        disk: of `runs.parquet` and of the rows before, together, over the runs [bytes].
    """

    runs: int
    memory: int
    overhead: float
    disk: float


def grown(size: int, folder: Path) -> Grown:
    """Carry out a sweep of `size` runs."""
    spec, out = folder / f"size_{size}.toml", folder / f"size_{size}"
    spec.write_text(_SPEC.format(size=size), encoding="utf-8")
    process = subprocess.Popen(
        [sys.executable, "-m", "harness", "sweep", str(spec), "--out", str(out), "--yes"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise click.ClickException(f"the sweep of {size} runs ended with {os.waitstatus_to_exitcode(status)}")
    rows = out / "runs.parquet"
    bare = sum(pq.read_table(rows, columns=["cpu_s"])["cpu_s"].to_pylist())
    spent = usage.ru_utime + usage.ru_stime
    return Grown(size, 1024 * usage.ru_maxrss, spent / bare, rows.stat().st_size / size)


def table(measured: list[Grown]) -> str:
    """Markdown."""
    lines = ["| runs | largest process [MB] | processor time over that of bare runs | `runs.parquet`, bytes a run |"]
    lines.append("|---|---|---|---|")
    lines += [f"| {one.runs} | {one.memory / 1e6:.0f} | {one.overhead:.2f} | {one.disk:.0f} |" for one in measured]
    return "\n".join(lines)


@click.command()
@click.option("--size", "sizes", type=int, multiple=True, default=(64, 256, 1024, 4096), show_default=True)
@click.option("--docs", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Page with the table.")
def main(sizes: tuple[int, ...], docs: Path) -> None:
    """Measure how memory, time and disk grow with the size of a sweep, and write the table.

    Example: python -m benchmarks.sweep_growth --size 64 --size 4096
    """
    with tempfile.TemporaryDirectory(prefix="sweep-growth-") as folder:
        measured = [grown(size, Path(folder)) for size in sizes]
    text = table(measured)
    docs.write_text(put("growth", text, docs.read_text(encoding="utf-8"), title="Sweeps"), encoding="utf-8")
    click.echo(text)


if __name__ == "__main__":
    main()
