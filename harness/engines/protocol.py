"""The interface of all engines: contact parameters with names and bounds, and a driven run with its health."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from pydantic import BaseModel, ConfigDict, Field

from analytic.motion import BallForce, BeamMotion, FloatArray, State, Trajectory
from analytic.rig import Rig
from harness.engines.health import Health


class EngineParameters(BaseModel):
    """Settings of one engine. Field names are what the user types (`--set mujoco.friction=0.3`); each field has a
    description with its unit, a default that attains the validated accuracy, and bounds."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    time_step: float = Field(1e-3, gt=0.0, le=0.02, description="integration step [s]")


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


class Engine(Protocol):
    """A physics engine with a prescribed beam motion and a free ball."""

    name: str
    parameters: type[EngineParameters]

    def version(self) -> str:
        """Version of the engine, for the manifest."""
        ...

    def run(
        self,
        rig: Rig,
        motion: BeamMotion,
        start: State,
        time: FloatArray,
        *,
        parameters: EngineParameters | None = None,
        force: BallForce | None = None,
    ) -> EngineRun:
        """Simulates the ball on a beam driven with `motion`.

        Args:
            rig: the rig; `level_angle` tilts gravity.
            motion: of the beam, evaluated on the engine's own grid from `time[0]` to `time[-1]`.
            start: ball state at `time[0]`, rolling without slip.
            time: output stamps, shape (n,), strictly increasing, possibly uneven [s].
            parameters: `None` for the defaults.
            force: additional force along the beam on the ball's centre, evaluated every step.

        Raises:
            EngineFailure: the run is invalid (see `harness.engines.health.Failure`).
        """
        ...
