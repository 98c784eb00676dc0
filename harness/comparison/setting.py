"""Prepares a comparison: drive, complete rig, start state and horizons, common to all models and engines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from analytic.effects import Acting, motion_with, parameters_with, sensor_with
from analytic.models import Model
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from analytic.slots import ORIGIN
from harness.comparison.horizons import Horizon, horizons
from harness.errors import InputError
from harness.identify.estimate.rig import FittedRig
from harness.identify.rig_completion import RigEstimate, complete_rig
from harness.metrics import TOLERANCE
from harness.preparation.declared_effects import declared_effects
from harness.preparation.recordings import observe
from harness.recording import Case, Recording
from harness.signals.ball_state import BallEstimate
from harness.signals.drive import Drive


@dataclass(frozen=True)
class Choices:
    """Options of a comparison.

    Attributes:
        recording: file name within the case; `None` for the first recording for identification.
        start: ball state at the first known position; `None` to estimate it.
        level_angle: α₀ [rad]; "estimate"; `None` for that of rig.toml, or 0 if it has none and the rig is known.
        lengths: window lengths [s].
        tolerance: half width of the tube [m].
        draws: Monte Carlo draws of beam motion and start for uncertainty propagation.
        seed: of the draws.
    """

    recording: str | None = None
    start: State | None = None
    level_angle: float | Literal["estimate"] | None = None
    lengths: tuple[float, ...] = (1.0, 2.0, 5.0)
    tolerance: float = TOLERANCE
    draws: int = 64
    seed: int = 0


@dataclass(frozen=True)
class Setting:
    """Inputs common to all models and engines.

    Attributes:
        case, recording: the input.
        choices: options.
        rig: complete; estimated and assumed quantities are listed in `estimates`.
        fitted: K, ℓ, α₀ and their covariance if any of them was estimated, else `None`.
        estimates: quantities missing in rig.toml, with standard errors.
        acting: the declared effects, included in every model and engine.
        drive: the measured beam motion.
        ball: the ball's measured state.
        reading_noise: standard deviation of a position reading, quantisation included [m].
        start: ball state at the start of the free run.
        horizons: the whole recording first, then windows.
    """

    case: Case
    recording: Recording
    choices: Choices
    rig: Rig
    fitted: FittedRig | None
    estimates: tuple[RigEstimate, ...]
    acting: tuple[Acting, ...]
    drive: Drive
    ball: BallEstimate
    reading_noise: float
    start: State
    horizons: tuple[Horizon, ...]

    @property
    def used(self) -> tuple[Recording, ...]:
        """All recordings used: the compared one, and those from which the rig was estimated."""
        others = self.case.identify if self.fitted is not None else ()
        names = dict.fromkeys((self.recording.name, *others))
        return tuple(self.case.recordings[name] for name in names if name in self.case.recordings)

    @property
    def time(self) -> FloatArray:
        """Stamps, shape (n,) [s]."""
        return self.recording.time

    @property
    def motion(self) -> BeamMotion:
        """Motion of the beam: the measured one, modified by declared effects of the drive."""
        return motion_with(self.drive, self.time, self.acting)

    @property
    def origin(self) -> float:
        """Position at which the rolled angle is zero: the start of the free run [m]."""
        return float(sensor_with(self.acting).position(self.ball.position[self.horizons[0].first[0]]))

    def vector(self, model: Model, rig: Rig | None = None) -> FloatArray:
        """Kernel parameters of `model` with the declared effects, for `rig` or the setting's rig; shape (SLOTS,)."""
        vector = parameters_with(model, rig or self.rig, self.acting)
        vector[ORIGIN] = self.origin
        return vector

    def starts(self, horizon: Horizon) -> FloatArray:
        """Initial s [m] and ṡ [m/s] of the runs of `horizon`, shape (runs, 2)."""
        sensor = sensor_with(self.acting)
        position = sensor.position(self.ball.position[horizon.first])
        starts = np.column_stack((position, self.ball.velocity[horizon.first] / sensor.slope(position)))
        if self.choices.start is not None and horizon.seconds is None:
            starts[0] = self.choices.start.position, self.choices.start.velocity
        return starts


def prepare(case: Case, choices: Choices) -> Setting:
    """Prepares the comparison of one recording.

    Raises:
        InputError: the recording is not in the case or has no positions, the rig cannot be completed, or a declared
            effect is not in the catalogue.
    """
    effects = declared_effects(case)
    recording = _choose(case, choices.recording)
    completed = complete_rig(case, recording, choices.level_angle)
    observed = observe(recording, case.sensors, completed.rig)
    ball = observed.ball
    spans = tuple(horizons(recording.time, recording.known & ball.trusted, choices.lengths))
    return Setting(
        case=case,
        recording=recording,
        choices=choices,
        rig=completed.rig,
        fitted=completed.fitted,
        estimates=completed.estimates,
        acting=effects,
        drive=observed.drive,
        ball=ball,
        reading_noise=observed.noise,
        start=choices.start or ball.state(int(spans[0].first[0])),
        horizons=spans,
    )


def _choose(case: Case, name: str | None) -> Recording:
    if name is None:
        name = (*case.identify, *case.recordings)[0]
    if name not in case.recordings:
        raise InputError(f"{case.path}: there is no recording {name!r}; there are {', '.join(case.recordings)}")
    return case.recordings[name]
