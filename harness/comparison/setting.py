"""Prepares a comparison: drive, complete rig, start state and horizons, common to all models and engines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from analytic.effects import CATALOGUE, Acting, EffectError, acting, motion_with, parameters_with
from analytic.models import Model
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig, RigError
from analytic.slots import ORIGIN
from harness.comparison.horizons import Horizon, horizons
from harness.errors import InputError
from harness.metrics import TOLERANCE
from harness.preparation.rig_completion import complete, missing, rough_rig
from harness.preparation.rig_estimate import Estimate, Fitted, Observed
from harness.recording import Case, Recording, inferred_resolution
from harness.signals.ball_state import BallEstimate, estimate_ball
from harness.signals.drive import Drive, make_drive

_MIN_POSITIONS = 3  # for estimating a state


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
        start: ball state at the start of the free run.
        horizons: the whole recording first, then windows.
    """

    case: Case
    recording: Recording
    choices: Choices
    rig: Rig
    fitted: Fitted | None
    estimates: tuple[Estimate, ...]
    acting: tuple[Acting, ...]
    drive: Drive
    ball: BallEstimate
    start: State
    horizons: tuple[Horizon, ...]

    @property
    def used(self) -> tuple[Recording, ...]:
        """All recordings used: the compared one, and those from which the rig was estimated."""
        others = self.case.identify if self.fitted is not None else ()
        names = dict.fromkeys((self.recording.name, *others))
        return tuple(self.case.recordings[name] for name in names if name in self.case.recordings)

    @property
    def reading_noise(self) -> float:
        """Standard deviation of a position reading, quantisation included [m]."""
        return _reading_noise(self.case, self.recording, self.ball)

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
        return float(self.ball.position[self.horizons[0].first[0]])

    def vector(self, model: Model, rig: Rig | None = None) -> FloatArray:
        """Kernel parameters of `model` with the declared effects, for `rig` or the setting's rig; shape (SLOTS,)."""
        vector = parameters_with(model, rig or self.rig, self.acting)
        vector[ORIGIN] = self.origin
        return vector

    def starts(self, horizon: Horizon) -> FloatArray:
        """Initial s [m] and ṡ [m/s] of the runs of `horizon`, shape (runs, 2)."""
        starts = np.column_stack((self.ball.position[horizon.first], self.ball.velocity[horizon.first]))
        if self.choices.start is not None and horizon.seconds is None:
            starts[0] = self.choices.start.position, self.choices.start.velocity
        return starts


def drive_of(case: Case, recording: Recording) -> Drive:
    """Smoothed beam motion of one recording, with the declared or inferred resolution of its angle sensor."""
    resolution = case.sensors.angle_resolution or inferred_resolution(recording.angle)
    return make_drive(recording.time, recording.angle, resolution=resolution, noise=case.sensors.angle_noise)


def ball_of(case: Case, recording: Recording, drive: Drive, rig: Rig) -> BallEstimate:
    """Smoothed ball state of one recording.

    Raises:
        InputError: fewer than three positions are known.
    """
    if int(recording.known.sum()) < _MIN_POSITIONS:
        raise InputError(
            f"{recording.path}: fewer than three ball positions are known, too few to estimate the start state; "
            "check that its column is there and named ball_position_m, or choose another recording with --recording"
        )
    return estimate_ball(
        recording.time,
        recording.position,
        drive,
        rig,
        noise=case.sensors.position_noise,
        resolution=_position_resolution(case, recording),
    )


def _position_resolution(case: Case, recording: Recording) -> float | None:
    return case.sensors.position_resolution or inferred_resolution(recording.position)


def _reading_noise(case: Case, recording: Recording, ball: BallEstimate) -> float:
    rounding = (_position_resolution(case, recording) or 0.0) / math.sqrt(12.0)
    return math.hypot(ball.noise, rounding)


def _observe(case: Case, recording: Recording, drive: Drive, ball: BallEstimate) -> Observed:
    return Observed(drive, ball, recording.position, _reading_noise(case, recording, ball))


def prepare(case: Case, choices: Choices) -> Setting:
    """Prepares the comparison of one recording.

    Raises:
        InputError: the recording is not in the case or has no positions, the rig cannot be completed, or a declared
            effect is not in the catalogue.
    """
    effects = _declared(case)
    recording = _choose(case, choices.recording)
    drive = drive_of(case, recording)
    rough = rough_rig(case.rig)
    ball = ball_of(case, recording, drive, rough)
    requested = choices.level_angle
    if isinstance(requested, float):
        try:
            rough = rough.with_(level_angle=requested)
        except RigError as error:
            raise InputError(f"--level-angle: {error}") from error
    level = requested == "estimate" or (requested is None and case.rig.level_angle is None and bool(missing(case.rig)))

    def observed() -> list[Observed]:
        others = [case.recordings[name] for name in case.identify if name != recording.name]
        found = [_observe(case, recording, drive, ball)]
        for other in others:
            if int(other.known.sum()) >= _MIN_POSITIONS:
                motion = drive_of(case, other)
                found.append(_observe(case, other, motion, ball_of(case, other, motion, rough)))
        return found

    rig, fitted, estimates = complete(case.rig, rough, observed, level=level)
    if fitted is not None:
        ball = ball_of(case, recording, drive, rig)  # again, relative to the estimated rig
    spans = tuple(horizons(recording.time, recording.known & ball.trusted, choices.lengths))
    start = choices.start or ball.state(int(spans[0].first[0]))
    return Setting(case, recording, choices, rig, fitted, tuple(estimates), effects, drive, ball, start, spans)


def _declared(case: Case) -> tuple[Acting, ...]:
    try:
        return tuple(acting(one.name, one.parameters) for one in case.declared)
    except EffectError as error:
        own = "" if all(one.name in CATALOGUE for one in case.declared) else " Give a file of your own with --effects."
        raise InputError(f"{case.path}: rig.toml, [[declared]]: {error}{own}") from error


def _choose(case: Case, name: str | None) -> Recording:
    if name is None:
        name = (*case.identify, *case.recordings)[0]
    if name not in case.recordings:
        raise InputError(f"{case.path}: there is no recording {name!r}; there are {', '.join(case.recordings)}")
    return case.recordings[name]
