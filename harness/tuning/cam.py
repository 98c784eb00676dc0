"""CAM on the same recordings: its level, its errors on held-out blocks without and with the effects of a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.effects import LEVEL_ERROR
from analytic.motion import FloatArray
from harness.failures import Failures
from harness.identify.estimate.block_errors import block_errors
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.record import DiagnosisRecord
from harness.identify.verdict import identify
from harness.numerics import rms
from harness.progress import Progress, silent


@dataclass(frozen=True)
class CamErrors:
    """Errors of CAM on held-out blocks.

    Attributes:
        effects: names of the effects found.
        unlisted: whether a law that no catalogue lists was found beside them.
        before, after: RMS error of every block of the recordings without and with them, shape (blocks,) [m].
        source: file of the diagnosis; empty if it was searched for.
    """

    effects: tuple[str, ...]
    unlisted: bool
    before: FloatArray
    after: FloatArray
    source: str = ""

    def rms(self, blocks: Sequence[int]) -> tuple[float, float]:
        """RMS errors over these blocks before and after [m]."""
        chosen = list(blocks)
        return rms(self.before[chosen]), rms(self.after[chosen])


def level_of_cam(problem: Problem) -> float | None:
    """The level angle with which CAM fits the readings best, by likelihood; `None` where it is declared [rad]."""
    name = LEVEL_ERROR.name
    if name in {one.effect.name for one in problem.declared}:
        return None
    found = fit(problem, Hypothesis(() if name in problem.unknown else (name,)))
    return problem.rig.level_angle + found.values()[name, LEVEL_ERROR.parameters[0].name]


def cam_of_search(problem: Problem, progress: Progress = silent, *, jobs: int = 1) -> CamErrors:
    """Search for effects, in `jobs` processes, and predict every block by fits without it."""
    progress("search for effects that CAM lacks")
    failures = Failures()
    said = identify(problem, progress, failures, jobs=jobs)
    same = said.found.hypothesis == said.base.hypothesis
    before = block_errors(problem, said.base)
    after = before if same else block_errors(problem, said.found)
    names = tuple(one.name for one in said.effects)
    return CamErrors(names, said.found.hypothesis.spline is not None, before, after)


def cam_of_record(record: DiagnosisRecord, source: str) -> CamErrors | None:
    """The errors that a saved diagnosis holds; `None` where its recordings were too short for any."""
    if record.baselines is None:
        return None
    before, after = (np.array(record.baselines.errors_m[which]) for which in ("before", "after"))
    return CamErrors(tuple(one.name for one in record.effects), record.unlisted is not None, before, after, source)
