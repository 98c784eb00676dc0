"""Free runs of an engine over windows, as functions of its tuned parameters and of the windows' starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from analytic.effects import SensorLaw, rig_with, sensor_with
from analytic.motion import FloatArray, State
from analytic.rig import Rig, RigError
from harness.engines.catalogue import parameters_of
from harness.engines.injection import engine_settings, force_of, motion_for_engine
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import EngineFailure, InputError
from harness.identify.problem.problem import Problem
from harness.jobs import Executor
from harness.parallel import side_by_side
from harness.tuning.estimate.free import Free
from harness.tuning.estimate.windows import Stretch

LOST = 3.0
"""Position that stands for a run that failed [m]: beyond any beam, so that a fit turns back."""
_WORTH = 4.0  # simulated seconds from which another process is worth its start

Values = Mapping[str, float]


def known_positions(run: FloatArray) -> FloatArray:
    """Positions of a run, shape (m,) [m], with NaN where it failed or left any beam."""
    return np.where(np.abs(run) < LOST, run, np.nan)


@dataclass(frozen=True)
class Model:
    """An engine with what stays as it is, and what may be tuned.

    Attributes:
        engine: that runs.
        problem: whose rig and declared effects it is given.
        settings: of the engine, as the user set them.
        free: what may be tuned, by name; the level angle among them.
        jobs: processes of this machine for the runs.
        executor: that whole fits are handed to; `None` where this process does them.
    """

    engine: Engine
    problem: Problem
    settings: Mapping[str, Any]
    free: Mapping[str, Free]
    jobs: int = 1
    executor: Executor | None = None

    @property
    def alone(self) -> Model:
        """The same for a single process, which an executor may hand to another machine."""
        return replace(self, jobs=1, executor=None)

    def rig(self, values: Values) -> Rig:
        """The rig with these values of the tuned quantities.

        Raises:
            RigError: they are impossible together.
        """
        changes = {self.free[name].quantity: value for name, value in values.items() if self.free[name].quantity}
        return rig_with(self.problem.rig.with_(**changes), self.problem.declared)

    def engine_values(self, values: Values) -> dict[str, Any]:
        """Settings of the engine with these values, and what they need beside them."""
        made = dict(self.settings)
        chosen = [self.free[name] for name in values if not self.free[name].quantity]
        beside: dict[str, Any] = {}
        for one in chosen:
            for key, value in one.beside.items():
                # Two that need a contact dimension need the larger one; of two rates the slower one is safe.
                pick = min if key == "friction_relaxation" else max
                beside[key] = pick(value, beside.get(key, value))
        made = {**beside, **made} | {one.name: values[one.name] for one in chosen}
        return engine_settings(self.problem.declared, self.engine.name) | made

    def parameters(self, values: Values) -> EngineParameters:
        """The same, checked.

        Raises:
            InputError: they are impossible together.
        """
        return parameters_of(self.engine, self.engine_values(values))

    def runs(self, windows: Sequence[Stretch], requests: Sequence[tuple[Values, FloatArray]]) -> list[list[FloatArray]]:
        """Recorded positions in every window, shape (m,) each [m], for every request.

        Args:
            requests: values of the tuned parameters, and starts s [m] and ṡ [m/s], shape (windows, 2).
        """
        seconds = sum(float(one.time[-1] - one.time[0]) for one in windows)
        jobs = [partial(self._over, windows, values, starts) for values, starts in requests]
        return [positions for positions, _ in side_by_side(jobs, self.jobs if seconds > _WORTH else 1)]

    def failed(self, windows: Sequence[Stretch], values: Values, starts: FloatArray) -> EngineFailure | None:
        """How the engine fails with these values, if it does."""
        return self._over(windows, values, starts)[1]

    def _over(
        self, windows: Sequence[Stretch], values: Values, starts: FloatArray
    ) -> tuple[list[FloatArray], EngineFailure | None]:
        failed: EngineFailure | None = None
        made = []
        try:
            rig, parameters = self.rig(values), self.parameters(values)
        except (RigError, InputError):
            return [np.full(len(one.time), LOST) for one in windows], None
        for window, start in zip(windows, starts, strict=True):
            try:
                made.append(self._run(window, rig, parameters, start))
            except EngineFailure as error:
                failed = error
                made.append(np.full(len(window.time), LOST))
        return made, failed

    def _run(self, window: Stretch, rig: Rig, parameters: EngineParameters, start: FloatArray) -> FloatArray:
        """Recorded positions at the cells of one window, shape (m,) [m]."""
        recording, declared = window.recording, self.problem.declared
        sensor = sensor_with(declared)
        motion = motion_for_engine(declared, recording.drive.gentle, recording.drive.time)
        at = window.time - sensor.delay
        force = force_of(declared, rig, motion, at, parameters.time_step, origin=recording.origin)
        position = float(sensor.position(start[:1])[0])
        velocity = float(start[1] / sensor.slope(np.array([position]))[0])
        run = self.engine.run(rig, motion, State(position, velocity), at, parameters=parameters, force=force)
        along = run.trajectory.position
        if sensor.lag > 0.0:
            along = SensorLaw(lag=sensor.lag).recorded(at, along, behind=sensor.lag * velocity)
        return np.asarray(np.clip(sensor.curve(along), -LOST, LOST))
