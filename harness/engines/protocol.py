"""The interface of all engines: contact parameters with names and bounds, and a driven run with its health."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Generic, TypeVar

from analytic.geometry import RAIL_REACH
from analytic.motion import BallForce, BeamMotion, FloatArray, State, Trajectory
from analytic.rig import Rig
from harness.engines.health import Failure, Health
from harness.engines.leapfrog import Grid, Start, Track, beam_on, grid_of, sample, start_of
from harness.engines.parameters import EngineParameters
from harness.engines.watch import Limits, Samples, judge, limits_of
from harness.errors import EngineFailure, HarnessError, InputError


@dataclass(frozen=True)
class EngineRun:
    """Result of an engine run.

    Attributes:
        trajectory: at the requested time stamps.
        rolled_angle: φ − α, rotation of the ball relative to the beam since the start, shape (n,)
            [rad]; for pure rolling it is (s − s₀)/r.
        health: extreme values during the run.
    """

    trajectory: Trajectory
    rolled_angle: FloatArray
    health: Health


Parameters = TypeVar("Parameters", bound=EngineParameters)


@dataclass(frozen=True)
class Task(Generic[Parameters]):
    """What an engine is to simulate: the rig, its settings, the driven beam, the ball's start, an additional force, the
    limits beyond which it may stop, and where the middle of the track lies across the beam's joint [m]."""

    rig: Rig
    settings: Parameters
    grid: Grid
    first: Start
    force: BallForce | None
    limits: Limits
    across: float = 0.0


class Engine(ABC, Generic[Parameters]):
    """A physics engine with a prescribed beam motion and a free ball.

    Attributes:
        name: as in results.
        parameters: its settings.
        scene_file: of the user's own scene; empty for the built-in one, which is made from the rig.
        threads: whether runs without an additional force release Python's lock, so that threads run side by side.
    """

    name: str
    parameters: type[Parameters]
    scene_file: str = ""
    threads: bool = False

    @abstractmethod
    def version(self) -> str:
        """Version of the engine's package, for the manifest.

        Raises:
            InputError: it is not installed.
        """

    @abstractmethod
    def drive(self, task: Task[Parameters]) -> tuple[Track, Samples]:
        """Steps through the grid; stops early if the run is invalid."""

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
        """Simulates the ball on a beam driven with `motion`.

        Args:
            rig: the rig; `level_angle` tilts gravity.
            motion: of the beam, evaluated on the engine's own grid from `time[0]` to `time[-1]`.
            start: ball state at `time[0]`, rolling without slip.
            time: output stamps, shape (n,), strictly increasing, possibly uneven [s].
            parameters: `None` for the defaults.
            force: additional force along the beam on the ball's centre, evaluated every step.
            base: the rig before effects altered it; `None` if none did. The built-in scene is made from `rig` alone.

        Raises:
            EngineFailure: the run is invalid (see `harness.engines.health.Failure`).
            InputError: the engine's package is missing, or stamps, motion, settings or groove are invalid.
        """
        settings = self._checked(parameters)
        limits = limits_of(rig, reach=RAIL_REACH, slip=settings.slip_limit)
        grid = grid_of(motion, time, settings.time_step)
        task = Task(rig, settings, grid, start_of(rig, motion, grid, start, force), force, limits)
        track, samples = self._driven(task)
        health = judge(self.name, rig, grid, track, samples, limits, beam_on(grid, motion, time))
        return EngineRun(*sample(self.name, rig, grid, track, start, time), health)

    def try_out(self, rig: Rig) -> None:
        """Load what does not follow from the rig.

        Raises:
            InputError: it cannot be driven.
        """
        return None

    def elsewhere(self, parameter: str) -> str:
        """Where a parameter is set that this engine does not take; empty if there is no such parameter."""
        return ""

    def _checked(self, parameters: EngineParameters | None) -> Parameters:
        """Settings of this engine, its defaults for `None`."""
        settings = self.parameters() if parameters is None else parameters
        if not isinstance(settings, self.parameters):
            raise InputError(f"{self.name} needs {self.parameters.__name__}, not {type(settings).__name__}")
        return settings

    def _driven(self, task: Task[Parameters]) -> tuple[Track, Samples]:
        """As `drive`; whatever the engine's package raises is a failure of the engine."""
        try:
            return self.drive(task)
        except HarnessError:
            raise
        except Exception as error:
            what = f"{type(error).__name__}: {error}; {Failure.CRASHED.value}"
            raise EngineFailure(self.name, Failure.CRASHED, float(task.grid.time[0]), what) from error
