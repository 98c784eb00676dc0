"""Rigs with a hidden effect of which a short recording exists, and the virtual plant that plays what is proposed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from analytic.motion import State
from analytic.quintic import QuinticMotion
from harness.identify.design.choose import RivalPair
from harness.identify.design.proposal import NOTHING, Proposal
from harness.identify.estimate.fit import Fit, fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.preparation.recordings import observe
from harness.recording import Case, load_case, load_recording
from harness.simulator import Experiment, write_case
from harness.simulator.plant import Run, simulate
from harness.simulator.protocol import record, recording_text

ROLLING, LEVEL, RADIUS, GAIN = "rolling_resistance", "level_error", "rolling_radius", "position_gain"
DECLARED = {ROLLING: {"coefficient": 0.002}}
SEEDS = (100, 101, 102)


@dataclass(frozen=True)
class Short:
    """A short recording of a rig with a hidden effect, on which a rival does nearly as well."""

    folder: Path
    experiment: Experiment
    case: Case
    problem: Problem
    found: Fit
    rival: Fit

    @property
    def pair(self) -> RivalPair:
        """The two."""
        return RivalPair(
            *(" + ".join(one.hypothesis.names) or NOTHING for one in (self.found, self.rival)), self.rival, 2.45
        )

    def played(self, proposal: Proposal) -> Run:
        """What the plant does when it plays the proposed angle without any feedback."""
        rate = np.gradient(proposal.angle, proposal.time)
        bent = np.gradient(rate, proposal.time)
        start = State(float(proposal.reading[0]), 0.0)
        motion = QuinticMotion(proposal.time, np.column_stack((proposal.angle, rate, bent)))
        return simulate(
            self.experiment.plant(SEEDS[0], self.experiment.acting), motion, start, float(proposal.time[-1])
        )

    def recorded(self, run: Run, seed: int) -> PreparedRecording:
        """What its sensors write down, read as any recording is."""
        path = self.folder / "new.csv"
        sensors = self.experiment.sensors
        written = record(run, replace(sensors, laser=replace(sensors.laser, near=0.0, far=1.0)), seed)
        path.write_text(recording_text(written), encoding="utf-8", newline="\n")
        return PreparedRecording.of(observe(load_recording(path), self.case.sensors, self.problem.rig))


def short(
    folder: Path, hidden: Mapping[str, Mapping[str, float]], rival: str, duration: float = 5.0, seed: int = 3
) -> Short:
    """Record it and fit both."""
    declared = {} if ROLLING in hidden else DECLARED
    experiment = Experiment(declared=declared, hidden=hidden, duration=duration, identify=1, predict=0, seed=seed)
    write_case(folder, experiment)
    case = load_case(folder)
    problem = problem_of(case)
    found = fit(problem, Hypothesis(tuple(hidden)))
    return Short(folder, experiment, case, problem, found, fit(problem, Hypothesis((rival,))))


def on_flat_rail(problem: Problem) -> Problem:
    """The same recordings of a smaller ball that rolls on its own radius, with the same K."""
    rig, radius = problem.rig, 0.0105
    inertia = rig.inertia * (radius / rig.rolling_radius) ** 2
    return replace(problem, rig=rig.with_(radius=radius, rolling_radius=radius, inertia=inertia))
