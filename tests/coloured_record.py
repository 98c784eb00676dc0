"""Simulated recordings whose reading noise is coloured."""

from __future__ import annotations

from pathlib import Path

from harness.identify.pose import problem_of
from harness.identify.problem.problem import Problem
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from harness.simulator.imperfections import Imperfections
from tests.posed import DECLARED, Effects

TIME = 0.0448  # correlation time: 0.8 from a reading to the next, 10 ms later [s]
NOISE = 0.3e-3  # as declared [m]


def coloured_problem(folder: Path, seed: int, hidden: Effects | None = None) -> Problem:
    """Three recordings of 16 s with `hidden` effects beside a declared rolling resistance, unless it is hidden."""
    hidden = hidden or {}
    experiment = Experiment(
        seed=seed,
        predict=0,
        identify=3,
        declared={} if "rolling_resistance" in hidden else DECLARED,
        hidden=hidden,
        position_noise=NOISE,
        imperfections=Imperfections(noise_time=TIME),
    )
    write_case(folder, experiment)
    return problem_of(load_case(folder))
