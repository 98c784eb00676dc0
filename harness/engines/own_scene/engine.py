"""An engine that runs the user's scene: driven, watched and judged as the built-in one, by what is measured in it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator

import numpy as np

from analytic.law import acceleration
from analytic.models import CAM, coefficients
from analytic.motion import BallForce, BeamMotion, FloatArray, State, beam_states
from analytic.rig import Rig
from analytic.slots import LEVEL
from harness.engines.leapfrog import beam_on, grid_of, sample, start_of
from harness.engines.own_scene.checks import Check, Use, judged
from harness.engines.own_scene.measuring import Measured
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine, EngineRun, Parameters, Task
from harness.engines.watch import Limits, judge
from harness.scene import Scene

CLEARANCE = 1e-4  # within which a ball has reached the end of the track [m]


class SceneEngine(Engine[Parameters]):
    """A physics engine with a scene of the user's. What is measured in the scene takes the place of the rig file's
    quantities: a scene that contradicts the rig file is simulated as it is, and the difference shows."""

    built_in: type[EngineParameters]

    def __init__(self, scene: Scene) -> None:
        """Name the scene; nothing is loaded yet."""
        file = scene.file_of(self.name)
        if file is None:
            raise ValueError(f"the scene has no file for {self.name}")
        self.scene, self.file = scene, file
        self._measured: dict[Rig, Measured] = {}
        self.scene_file = file.relative_to(scene.folder).as_posix()

    def elsewhere(self, parameter: str) -> str:
        """Where a parameter of the built-in scene is set, if this is one."""
        if parameter not in self.built_in.model_fields:
            return ""
        return f" That is a parameter of the built-in scene; here {self.file.name} decides it."

    def measured(self, rig: Rig) -> Measured:
        """What the scene is, by touch.

        Args:
            rig: has the quantities that the file does not give: those of a ball without a file, and g in PyBullet.

        Raises:
            InputError: the engine cannot load it, or it is no ball on a beam.
        """
        if rig not in self._measured:
            self._measured[rig] = self.measure(rig)
        return self._measured[rig]

    def try_out(self, rig: Rig) -> None:
        """Load and measure the scene; exceptions as of `measured`."""
        self.measured(rig.with_(level_angle=0.0))

    @property
    def last_measured(self) -> Measured | None:
        """What was measured last; `None` if nothing was."""
        return next(reversed(self._measured.values()), None)

    def checks(self, rig: Rig, use: Use, *, compared: bool = True) -> Iterator[Check]:
        """Checks of the scene; an `InputError` among them, which ends them, is what keeps it from being driven.

        Args:
            rig: what `rig.toml` says, or what is assumed in its place.
            use: what the recordings ask for.
            compared: whether `rig` is what the scene should be.

        Raises:
            InputError: as of `measured`.
        """
        seen = self.measured(rig.with_(level_angle=0.0))
        yield from judged(self.scene, seen, rig if compared else None, use)
        yield from self.own_checks(rig, use)

    @abstractmethod
    def own_checks(self, rig: Rig, use: Use) -> Iterator[Check]:
        """Checks of what only this engine's files have."""

    @abstractmethod
    def measure(self, rig: Rig) -> Measured:
        """As `measured`, anew."""

    def run(
        self,
        rig: Rig,
        motion: BeamMotion,
        start: State,
        time: FloatArray,
        *,
        parameters: EngineParameters | None = None,
        force: BallForce | None = None,
        base: Rig | None = None,
    ) -> EngineRun:
        """As `Engine.run`; of `rig` the level angle alone counts, and in what it differs from `base`.

        A quantity that an effect changes, such as the rolling radius, cannot be changed in a scene: a force along the
        beam stands for it, the difference that it makes in eq. 14.
        """
        settings = self._checked(parameters)
        seen = self.measured((base or rig).with_(level_angle=0.0))
        own = seen.rig(rig.level_angle)
        force = _with_altered_rig(force, rig, base, own, motion, time, settings.time_step)
        grid = grid_of(motion, time, settings.time_step)
        first, limits = start_of(own, motion, grid, start, force), _limits(seen, settings)
        task = Task(own, settings, grid, first, force, limits, seen.across)
        track, samples = self._driven(task)
        health = judge(self.name, own, grid, track, samples, limits, beam_on(grid, motion, time))
        return EngineRun(*sample(self.name, own, grid, track, start, time), health)


def _limits(seen: Measured, settings: EngineParameters) -> Limits:
    """Bounds of a valid run on the track that was measured."""
    begin, end = seen.track
    return Limits(
        across=seen.lateral_limit,
        height=0.1 * seen.rolling_radius,
        along=0.5 * (end - begin) + CLEARANCE,
        slip=settings.slip_limit,
        middle=0.5 * (begin + end),
        contacts=seen.contacts,
    )


def _with_altered_rig(
    force: BallForce | None,
    rig: Rig,
    base: Rig | None,
    own: Rig,
    motion: BeamMotion,
    stamps: FloatArray,
    time_step: float,
) -> BallForce | None:
    """`force` and the one that stands for the difference of `rig` from `base` but for its level angle."""
    if base is None or rig.with_(level_angle=base.level_angle) == base:
        return force
    altered, plain = coefficients(CAM, rig), coefficients(CAM, base)
    plain[LEVEL] = altered[LEVEL]
    inertia = own.mass / own.rolling_ratio
    begin, last = float(stamps[0]), float(stamps[-1])
    grid = begin + time_step * np.arange(int(np.ceil((last - begin) / time_step)) + 3)
    beam = beam_states(motion, np.minimum(grid, last)).tolist()

    def both(s: float, v: float, angle: float, time: float) -> float:
        _, rate, angular = beam[round((time - begin) / time_step)]
        more = acceleration(s, v, angle, rate, angular, altered) - acceleration(s, v, angle, rate, angular, plain)
        return inertia * more + (0.0 if force is None else force(s, v, angle, time))

    return both
