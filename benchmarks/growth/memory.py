"""`python -m benchmarks.growth.memory`: memory of `harness diagnose` and `harness run` against what is told beforehand.

Writes the section "Memory" of `docs/reliability.md`, and ends with exit code 1 where a command took more than that.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import click

from benchmarks.growth.cases import HIDDEN
from benchmarks.kept_rows import KeptRows
from benchmarks.sections import put
from harness.api.case import load_case
from harness.api.memory import comparison_memory, diagnosis_memory
from harness.comparison import Choices
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of
from harness.provenance import code_digest
from harness.recording import Case
from harness.simulator import Experiment, write_case

_ROWS, _DOCS = Path("build/growth/memory.jsonl"), Path("docs/reliability.md")
# Folders that decide how much: a row counts as long as they are the same.
_BOTH = ("analytic", "harness/preparation", "harness/engines", "harness/report")
_MEASURED = {
    "diagnose": ("analytic", "harness/identify", *_BOTH[1:]),
    "run": (*_BOTH, "harness/comparison", "harness/metrics"),
}
_EVERY = 0.05  # between two looks at the processes [s]
_SEED = 20
_DONE = (0, 3)  # exit codes of a diagnosis that was written; 3 where an engine failed
_MEGA, _KIBI = 1e6, 1024
# Writes its child's peak into a file. That counts what the parent held when the child was begun: a launcher, little.
_LAUNCHER = """
import os, sys
child = os.spawnvp(os.P_NOWAIT, sys.argv[2], sys.argv[2:])
_, status, used = os.wait4(child, 0)
with open(sys.argv[1], "w") as file:
    file.write(str(used.ru_maxrss))
sys.exit(os.waitstatus_to_exitcode(status))
"""


@dataclass(frozen=True)
class Shape:
    """Of a simulated case: so many recordings of this length [s] at this rate [Hz]."""

    recordings: int
    length: float
    rate: float

    @property
    def title(self) -> str:
        """In words."""
        return f"{self.recordings} × {self.length:g} s at {self.rate:g} Hz"


NOT_RUN = 5e9
"""A command that may take more than this is not measured, its estimate is told [bytes]."""
SHAPES = (Shape(2, 16.0, 100.0), Shape(10, 10.0, 200.0), Shape(4, 160.0, 100.0), Shape(1, 640.0, 100.0))


@dataclass(frozen=True)
class Peak:
    """The most memory that a command took [bytes].

    Attributes:
        largest: of its largest process, resident (`getrusage`).
        together: of all its processes, pages that several share counted once; the largest of looks every 0.05 s.
    """

    largest: int
    together: int


def peak_of(command: list[str]) -> Peak:
    """The memory that a command and the processes it starts take.

    Raises:
        RuntimeError: it failed.
    """
    together = 0
    with tempfile.TemporaryFile("w+") as errors, tempfile.NamedTemporaryFile("r") as largest:
        begun = [sys.executable, "-S", "-c", _LAUNCHER, largest.name, *command]
        process = subprocess.Popen(begun, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True)
        while process.poll() is None:
            together = max(together, _shared_out(process.pid))
            time.sleep(_EVERY)
        if process.returncode not in _DONE:
            errors.seek(0)
            raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}: {errors.read()[-2000:]}")
        peak = int(largest.read()) * _KIBI
    return Peak(peak, max(peak, together))


def _shared_out(session: int) -> int:
    """Memory of all processes of a session, a page's share in each of those that hold it [bytes]."""
    total = 0
    for one in Path("/proc").glob("[0-9]*"):
        try:
            # After the name, which may hold anything: state, parent, group, session.
            if int((one / "stat").read_text().rpartition(")")[2].split()[3]) == session:
                lines = (one / "smaps_rollup").read_text().splitlines()
                total += sum(int(line.split()[1]) * _KIBI for line in lines if line.startswith("Pss:"))
        except (OSError, IndexError):  # it has ended
            continue
    return total


@dataclass(frozen=True)
class Told:
    """What a command says beforehand of a case, and what it took; `None` where it was not run.

    Attributes:
        command: its name.
        shape: of the case.
        readings: of the recordings that it uses.
        estimate: the most memory that it says it takes [bytes].
        peak: measured.
    """

    command: str
    shape: Shape
    readings: int
    estimate: float
    peak: Peak | None

    @property
    def exceeded(self) -> bool:
        """Whether it took more than it said."""
        return self.peak is not None and self.peak.together > self.estimate


def section(rows: Sequence[Told]) -> str:
    """The section of `docs/reliability.md`."""
    lines = [
        f"| `{one.command}` | {one.shape.title} | {one.readings} | {_measured(one.peak)} | {one.estimate / _MEGA:.0f} |"
        for one in rows
    ]
    return _TEXT.format(rows="\n".join(lines))


def _measured(peak: Peak | None) -> str:
    return "not run | not run" if peak is None else f"{peak.largest / _MEGA:.0f} | {peak.together / _MEGA:.0f}"


def _estimates(case: Case) -> dict[str, tuple[int, float]]:
    """Readings and the most memory [bytes] by command."""
    used = [case.recordings[one] for one in case.identify]
    engines = [(engine_of(name), engine_of(name).parameters()) for name in DEFAULT_ENGINES]
    return {
        "diagnose": (sum(len(one.time) for one in used), diagnosis_memory(used)),
        "run": (len(used[0].time), comparison_memory(used[0], engines, Choices())),
    }


@click.command()
@click.option("--most", default=len(SHAPES), type=click.IntRange(1, len(SHAPES)), help="Cases, smallest first.")
@click.option("--rows", type=click.Path(path_type=Path), default=_ROWS, show_default=True, help="Measured so far.")
@click.option("--out", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Page to write into.")
def main(most: int, rows: Path, out: Path) -> None:
    """Measure the memory of `harness diagnose` and `harness run` on simulated cases; what was measured before counts.

    \b
    Example:
      python -m benchmarks.growth.memory --most 2
    """
    table: list[Told] = []
    with tempfile.TemporaryDirectory(prefix="memory-") as name:
        for number, shape in enumerate(SHAPES[:most]):
            path = Path(name) / str(number)
            experiment = Experiment(hidden=HIDDEN, rate=shape.rate, duration=shape.length, predict=0, seed=_SEED)
            write_case(path, replace(experiment, identify=shape.recordings))
            for command, (readings, estimate) in _estimates(load_case(path)).items():
                kept = KeptRows(rows, code_digest(packages=_MEASURED[command]))
                # The digests of the two commands tell their rows apart.
                peak = next((Peak(**row["result"]) for row in kept.current() if row["spec"] == shape.title), None)
                if peak is None and estimate < NOT_RUN:
                    words = [sys.executable, "-m", "harness", command, str(path), "--out", f"{path}-{command}", "--yes"]
                    peak = peak_of(words)
                    kept.append({"source": kept.source, "spec": shape.title, "result": asdict(peak)})
                table.append(Told(command, shape, readings, estimate, peak))
                click.echo(f"{command}, {shape.title}: {peak}, told {estimate:.3g}", err=True)
    table.sort(key=lambda one: one.command)
    page = out.read_text(encoding="utf-8") if out.exists() else ""
    out.write_text(put("memory", section(table), page, title="Reliability"), encoding="utf-8")
    sys.exit(1 if any(one.exceeded for one in table) else 0)


_TEXT = """\
## Memory

Made by `python -m benchmarks.growth.memory`, on two cores. Beyond ten minutes or 4 GB, `run`, `diagnose`, `tune` and
`sweep` say beforehand what they would take, and wait for `--yes`; `diagnose` tells it in any case. The memory is an
upper estimate (`harness/api/memory.py`): Python with its packages, compiled kernels and their compiler (0.6 GB), 0.1
GB for each process beside it, and the largest arrays. These are

- of `diagnose`, Jacobians of shape (readings, parameters), six copies on each core, with a parameter for each
  recording; 24 motions of the beam drawn from the smoothed angle; states and covariances of the smoothing; tables of
  the motion;
- of `run`, position and velocity of every source on every horizon; the positions of 40 combinations of model terms on
  one horizon; 64 drawn motions of the beam and what they move the ball by; the engine's steps, 1 kB each;
- of `tune`, those of `diagnose`, 256 drawn errors of the angle, and the engine's steps in a window on each core;
- of `sweep`, 0.3 GB and the engine's steps for each process. The memory of a cluster is not known.

The last two are not measured here. *Largest process* is the peak that the system gives (`getrusage`), *all processes*
the largest sum seen every 0.05 s, where pages that processes share count once. The cases are simulated; `run` uses
the first recording of each.

| command | case | readings | largest process (MB) | all processes (MB) | told beforehand (MB) |
|---|---|---|---|---|---|
{rows}
"""


if __name__ == "__main__":
    main()
