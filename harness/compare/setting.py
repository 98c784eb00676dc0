"""Everything that has to be settled before models run: beam motion, rig, start state, horizons."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from analytic.motion import FloatArray, State
from analytic.rig import SOLID_SPHERE, Rig
from harness.ball_state import BallEstimate, estimate_ball
from harness.compare.segments import Horizon, horizons
from harness.compare.unknown import Estimate, Fitted, Observed, fit_unknown
from harness.drive import Drive, make_drive
from harness.errors import InputError
from harness.metrics import TOLERANCE
from harness.recording import Case, Recording, inferred_resolution

_LEVER_TRUSTED = 0.02  # an estimated lever less sure than this says nothing about the pivot [m]


@dataclass(frozen=True)
class Choices:
    """What a user may decide about a run.

    Attributes:
        recording: file name within the case; `None` for the first to identify from.
        start: ball state at the first known position; `None` to estimate it.
        level_angle: α₀ [rad]; "estimate"; `None` for the rig's own, or 0 where that is silent and the rig known.
        lengths: of the windows [s].
        tolerance: half width of the tube [m].
        draws: beam motions and starts drawn to propagate their uncertainty.
        seed: of these draws.
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
    """What all sources share.

    Attributes:
        case, recording: the input.
        choices: as given.
        rig: complete; quantities that were estimated or assumed are listed in `estimates`.
        fitted: K, ℓ, α₀ and their covariance when any was estimated, else `None`.
        estimates: what the rig file did not say, with standard errors.
        drive: the beam motion.
        ball: the ball's measured state.
        start: ball state at the first stamp of the whole run.
        horizons: the whole recording first, then windows.
    """

    case: Case
    recording: Recording
    choices: Choices
    rig: Rig
    fitted: Fitted | None
    estimates: tuple[Estimate, ...]
    drive: Drive
    ball: BallEstimate
    start: State
    horizons: tuple[Horizon, ...]

    @property
    def time(self) -> FloatArray:
        """Stamps, shape (n,) [s]."""
        return self.recording.time

    def starts(self, horizon: Horizon) -> FloatArray:
        """s [m] and ṡ [m/s] at which the runs of `horizon` begin, shape (runs, 2)."""
        starts = np.column_stack((self.ball.position[horizon.first], self.ball.velocity[horizon.first]))
        if self.choices.start is not None and horizon.seconds is None:
            starts[0] = self.choices.start.position, self.choices.start.velocity
        return starts


def drive_of(case: Case, recording: Recording) -> Drive:
    """The beam motion of one recording, read as its sensor allows."""
    resolution = case.sensors.angle_resolution or inferred_resolution(recording.angle)
    return make_drive(recording.time, recording.angle, resolution=resolution, noise=case.sensors.angle_noise)


def ball_of(case: Case, recording: Recording, drive: Drive, rig: Rig) -> BallEstimate:
    """The ball's measured state in one recording."""
    if int(recording.known.sum()) < 3:
        raise InputError(
            f"{recording.path}: fewer than three ball positions are known, so there is nothing to start a model from; "
            "choose another recording with --recording"
        )
    return estimate_ball(
        recording.time,
        recording.position,
        drive,
        rig,
        noise=case.sensors.position_noise,
        resolution=case.sensors.position_resolution or inferred_resolution(recording.position),
    )


def prepare(case: Case, choices: Choices) -> Setting:
    """Settle what a run needs.

    Raises:
        InputError: the recording is not in the case, has no positions, or the rig cannot be completed.
    """
    recording = _choose(case, choices.recording)
    drive = drive_of(case, recording)
    rough = _rough_rig(case)
    ball = ball_of(case, recording, drive, rough)
    rig, fitted, estimates = _complete(case, choices, rough, Observed(drive, ball, recording.position), recording)
    if fitted is not None:
        ball = ball_of(case, recording, drive, rig)  # anew, relative to the better model
    spans = tuple(horizons(recording.time, recording.known & ball.trusted, choices.lengths))
    start = choices.start or ball.state(int(spans[0].first[0]))
    return Setting(case, recording, choices, rig, fitted, estimates, drive, ball, start, spans)


def _choose(case: Case, name: str | None) -> Recording:
    if name is None:
        name = (*case.identify, *case.recordings)[0]
    if name not in case.recordings:
        raise InputError(f"{case.path}: there is no recording {name!r}; there are {', '.join(case.recordings)}")
    return case.recordings[name]


def _rough_rig(case: Case) -> Rig:
    """What is known, completed by the paper's proportions: good enough to smooth the measurement against."""
    known = case.rig
    radius = known.radius or (known.rolling_radius / 0.9 if known.rolling_radius else Rig.radius)
    mass = known.mass or Rig.mass
    return known.complete(
        mass=mass,
        radius=radius,
        inertia=SOLID_SPHERE * mass * radius**2,
        rolling_radius=radius * Rig.rolling_radius / Rig.radius,
        eccentricity=0.0,
        gravity=Rig.gravity,
    )


def _complete(
    case: Case, choices: Choices, rough: Rig, here: Observed, recording: Recording
) -> tuple[Rig, Fitted | None, tuple[Estimate, ...]]:
    """Complete the rig: given first, then estimated, then assumed."""
    unknown = set(case.rig.unknown)
    ratio = bool(unknown & {"mass", "inertia", "radius", "rolling_radius"})
    lever = "eccentricity" in unknown
    wish = choices.level_angle
    if wish is None and case.rig.level_angle is None and (ratio or lever):
        wish = "estimate"
    level = wish == "estimate"
    if isinstance(wish, float):
        rough = replace(rough, level_angle=wish)
    if not (ratio or lever or level):
        return rough, None, ()
    others = [case.recordings[name] for name in case.identify if name != recording.name]
    observed = [here]
    for other in others:
        drive = drive_of(case, other)
        observed.append(Observed(drive, ball_of(case, other, drive, rough), other.position))
    fitted = fit_unknown(observed, rough, ratio=ratio, level=level, lever=lever)
    std = np.sqrt(np.diag(fitted.covariance))
    if lever and std[2] > _LEVER_TRUSTED:
        rough = replace(rough, eccentricity=0.0)
        fitted = fit_unknown(observed, rough, ratio=ratio, level=level, lever=False)
        std = np.sqrt(np.diag(fitted.covariance))
    how = f"windows of 2 s of {len(observed)} recording{'s' if len(observed) > 1 else ''}, CAM with a Coulomb friction"
    estimates: list[Estimate] = []
    rig = replace(rough, level_angle=fitted.level)
    if ratio:
        estimates.append(Estimate("rolling ratio K", fitted.ratio, float(std[0]), "1", how))
        rig, assumed = _rig_of_ratio(case, rig, fitted.ratio)
        estimates.extend(assumed)
    if lever:
        eccentricity = fitted.lever - rig.rolling_radius - rig.inertia / (rig.mass * rig.rolling_radius)
        if std[2] == 0.0:
            note = "assumed: the α̈ term is too weak here to tell"
            estimates.append(Estimate("eccentricity h", 0.0, math.inf, "m", note))
        else:
            rig = replace(rig, eccentricity=eccentricity)
            estimates.append(Estimate("eccentricity h", eccentricity, float(std[2]), "m", how))
    if level:
        estimates.append(Estimate("level angle α₀", fitted.level, float(std[1]), "rad", how))
    return rig, fitted, tuple(estimates)


def _rig_of_ratio(case: Case, rig: Rig, ratio: float) -> tuple[Rig, list[Estimate]]:
    """A rig that rolls with the effective ratio K; its remaining freedom is filled by a solid ball if that can be.

    Trajectories fix only J/(m r²) = 1/K − 1. For a known or solid ball that gives r; where no r ≤ R does, the ball
    keeps the paper's r/R and gets the inertia that K asks for; where K ≥ 1 (no rolling body accelerates so) gravity
    carries the rest, as a wrong gain of the angle would.
    """
    notes = []
    share = 1.0 / ratio - 1.0
    if share > 0.0:
        r = math.sqrt(rig.inertia / (rig.mass * share))
        if case.rig.rolling_radius is None and 0.3 * rig.radius <= r <= 0.995 * rig.radius:
            notes.append(_assumed("rolling radius r", r, "m", "from K, for this ball's inertia"))
            return replace(rig, rolling_radius=r), notes
        inertia = rig.mass * rig.rolling_radius**2 * share
        notes.append(_assumed("inertia J", inertia, "kg m²", "from K: no rolling radius of a solid ball gives it"))
        return replace(rig, inertia=inertia), notes
    gravity = rig.gravity * ratio / rig.rolling_ratio
    notes.append(_assumed("gravity g", gravity, "m/s²", "scaled: K > 1 cannot be rolling; check the angle's gain"))
    return replace(rig, gravity=gravity), notes


def _assumed(name: str, value: float, unit: str, why: str) -> Estimate:
    return Estimate(name, value, math.inf, unit, f"assumed: {why}")
