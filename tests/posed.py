"""Problems with a known truth: cases of the virtual rig, whose plant shares no equation with the models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from harness.identify.pose import problem_of
from harness.identify.problem.problem import Problem
from harness.recording import Case, load_case
from harness.simulator import Experiment, SimulatedRecording, write_case

Effects = Mapping[str, Mapping[str, float]]
DECLARED: Effects = {"rolling_resistance": {"coefficient": 0.002}}


@dataclass(frozen=True)
class Posed:
    """A case, the problem that it poses, and what really happened in its recordings."""

    case: Case
    problem: Problem
    truth: tuple[SimulatedRecording, ...]


def pose(
    folder: Path, seed: int, hidden: Effects | None = None, *, unlisted: Effects | None = None, predict: int = 0
) -> Posed:
    """Two recordings of 16 s with these effects; rolling resistance is declared unless it is hidden."""
    hidden = hidden or {}
    experiment = Experiment(
        declared={} if "rolling_resistance" in hidden else DECLARED,
        hidden=hidden,
        unlisted=unlisted or {},
        predict=predict,
        seed=seed,
    )
    truth = write_case(folder, experiment)
    case = load_case(folder)
    return Posed(case, problem_of(case), tuple(truth))
