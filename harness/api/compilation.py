"""Compiling before it is needed: the kernels of the commands, kept where numba keeps them (`analytic.compiled`)."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from analytic.effects import LEVEL_ERROR, LINKAGE_BACKLASH, ROLLING_RESISTANCE
from harness.api.progress import shown
from harness.formatting import number
from harness.progress import Progress
from harness.report.tables import Summarised, Summary, Table, texts

_PACKAGES = ("analytic.", "harness.")
_DURATION = 3.0  # of a simulated recording [s]: what is compiled does not depend on it
# Together they lead through every kernel that engines and the virtual rig have: a dry friction, a Dahl friction, a
# beam that follows late, a linkage with play, and each kind of an imperfect record.
_DECLARED = {ROLLING_RESISTANCE.name: {"coefficient": 1e-3}, LINKAGE_BACKLASH.name: {"width": 0.002}}
_HIDDEN = {LEVEL_ERROR.name: {"angle": 0.004}}


@dataclass(frozen=True)
class Kernel:
    """A function that was compiled: its name with that of its module, and the time that took with what it calls [s]."""

    name: str
    seconds: float


@dataclass(frozen=True)
class CompiledPart:
    """Part of the work.

    Attributes:
        name: what was run.
        seconds: that it took in all [s].
        kernels: what was compiled for it, in this order; empty where all of it had been compiled before.
    """

    name: str
    seconds: float
    kernels: tuple[Kernel, ...]


@dataclass(frozen=True, repr=False)
class Compilation(Summarised):
    """What `compile_kernels` did.

    Attributes:
        parts: simulation, comparison, diagnosis.
        cache: folder of the kernels of `analytic`; those of other folders are beside it, or beside their sources.
    """

    parts: tuple[CompiledPart, ...]
    cache: Path

    @property
    def kernels(self) -> tuple[Kernel, ...]:
        """Everything that was compiled."""
        return tuple(one for part in self.parts for one in part.kernels)

    @property
    def seconds(self) -> float:
        """Time of all parts [s]."""
        return sum(part.seconds for part in self.parts)

    def summary(self) -> Summary:
        """How many functions were compiled for each part, and how long that took."""
        rows = [(part.name, number(part.seconds), str(len(part.kernels))) for part in self.parts]
        line = f"{len(self.kernels)} functions compiled in {self.seconds:.0f} s; kept in {self.cache} and beside it."
        table = Table("Parts", [*texts("part"), "time [s]", "functions compiled"], rows)
        return Summary("Compilation of the kernels", [line], [table])

    def record(self) -> dict[str, Any]:
        """As JSON."""
        return {"cache": str(self.cache), "compiled": len(self.kernels), "seconds": self.seconds} | {
            "parts": [asdict(part) for part in self.parts]
        }


def compile_kernels(*, progress: bool | Progress = False) -> Compilation:
    """Compile what the commands need, so that the first of them need not wait for it.

    Runs a comparison and a diagnosis of a simulated recording of three seconds, in a folder that is removed in the end;
    numba keeps what it compiles for them: in `NUMBA_CACHE_DIR` if that is set, else beside the sources. What has been
    compiled from the same sources is only loaded.

    Args:
        progress: show a bar on stderr, or a function to be told.
    """
    with shown(progress) as tell, tempfile.TemporaryDirectory(prefix="harness-compile-") as folder:
        case = Path(folder, "case")
        work: Sequence[tuple[str, Callable[[], object]]] = (
            ("simulation", partial(_simulate, Path(folder), case)),
            ("comparison", partial(_compare, case)),
            ("diagnosis", partial(_diagnose, Path(folder), case)),
        )
        parts = []
        for number, (name, act) in enumerate(work):
            tell(f"compiling kernels: {name}", share=number / len(work))
            parts.append(_part(name, act))
    from analytic.kernel import _integrate

    return Compilation(tuple(parts), Path(_integrate._cache.cache_path))  # type: ignore[attr-defined]


def _part(name: str, act: Callable[[], object]) -> CompiledPart:
    """Act, and take note of what numba compiles for it, in whatever thread."""
    from numba.core.event import install_recorder

    begin = time.monotonic()
    with install_recorder("numba:compile") as recorder:
        act()
    return CompiledPart(name, time.monotonic() - begin, _kernels(recorder.buffer))


def _kernels(events: Sequence[tuple[float, Any]]) -> tuple[Kernel, ...]:
    """Our own functions among numba's events; numba compiles one function at a time, callees within their callers."""
    begun, kernels = [], []
    for when, event in events:
        if event.is_start:
            begun.append(when)
            continue
        since, function = begun.pop(), event.data["dispatcher"].py_func
        if function.__module__.startswith(_PACKAGES):
            kernels.append(Kernel(f"{function.__module__}.{function.__qualname__}", when - since))
    return tuple(kernels)


def _simulate(folder: Path, case: Path) -> None:
    from harness.simulator import KINDS, Experiment, with_imperfections, write_case

    experiment = Experiment(declared=_DECLARED, hidden=_HIDDEN, duration=_DURATION, identify=2, predict=1, seed=1)
    write_case(case, experiment)
    write_case(folder / "imperfect", with_imperfections(experiment, list(KINDS), seed=1))


def _compare(case: Path) -> None:
    from harness.api.comparison import compare

    compare(case, windows=(1.0,))


def _diagnose(folder: Path, case: Path) -> None:
    from harness.api.diagnosis import diagnose
    from harness.identify.estimate.window_runs import FreeRuns
    from harness.identify.pose import problem_of
    from harness.identify.problem.hypothesis import NOTHING
    from harness.identify.problem.spline_term import Kind, Regressor, blank
    from harness.identify.problem.windows import fitted_windows
    from harness.recording import load_case

    diagnose(case, out=folder / "out")  # the report has kernels of its own
    # This recording asks for no spline term, nor for free runs, which a search fits that held-out errors decide.
    curve = blank(Kind(Regressor.POSITION), 0.0, 1.0)
    curve.at(np.zeros(1))
    curve.slope_at(np.zeros(1))
    problem = problem_of(load_case(case))
    runs = FreeRuns(problem, fitted_windows(problem.recordings))
    runs.runs(NOTHING, runs.first_starts())
