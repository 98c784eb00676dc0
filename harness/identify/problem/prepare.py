"""From a case to a problem: drives read, rig completed, spikes set aside, noise measured."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.effects import CATALOGUE
from analytic.effects.effect import UnknownQuantity
from analytic.rig import Rig
from harness.comparison import Choices, Setting
from harness.comparison import prepare as settle
from harness.errors import InputError
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.preparation.rig_completion import missing
from harness.recording import Case, KnownRig, Recording, Sensors, inferred_resolution
from harness.signals.ball_state import estimate_ball
from harness.signals.drive import make_drive

_LEAST = 3  # positions to start from
_STOOD_FOR: tuple[UnknownQuantity, ...] = ("ratio", "level")  # of an incompletely known rig
_FEWEST = 20  # readings that a recording must hold to say anything


def problem_of(case: Case, names: Sequence[str] | None = None) -> tuple[Problem, Setting]:
    """The problem that the recordings `names` pose (by default those to identify from), and the setting of the first.

    Raises:
        InputError: no recording has positions enough.
    """
    names = [name for name in (names or case.identify) if int(case.recordings[name].known.sum()) >= _FEWEST]
    if not names:
        raise InputError(f"{case.path}: no recording to identify from has {_FEWEST} known positions or more")
    setting = settle(case, Choices(recording=names[0]))
    records, variances = [], []
    for name in names:
        record, noise = record_of(case, case.recordings[name], setting.rig)
        records.append(record)
        variances.append(noise**2)
    noise = float(np.mean(variances))
    return Problem(tuple(records), setting.rig, setting.acting, noise, unknown=unknown_effects(case.rig)), setting


def unknown_effects(known: KnownRig) -> tuple[str, ...]:
    """Effects that stand for what a rig file leaves open: K scales the angle's effect, α₀ is added to the angle."""
    open_ = missing(known)
    if open_ and known.level_angle is None:
        open_ |= {"level"}
    standing = {effect.relations.stands_for: name for name, effect in CATALOGUE.items()}
    return tuple(standing[quantity] for quantity in _STOOD_FOR if quantity in open_)


def record_of(case: Case, recording: Recording, rig: Rig) -> tuple[PreparedRecording, float]:
    """One recording of a case with its drive, spikes set aside, and the standard deviation of its readings [m]."""
    return record_from(recording, case.sensors, rig)


def record_from(recording: Recording, sensors: Sensors, rig: Rig) -> tuple[PreparedRecording, float]:
    """As `record_of`, for a recording that comes with its sensors instead of a case."""
    drive = make_drive(
        recording.time,
        recording.angle,
        resolution=sensors.angle_resolution or inferred_resolution(recording.angle),
        noise=sensors.angle_noise,
    )
    resolution = sensors.position_resolution or inferred_resolution(recording.position)
    if int(recording.known.sum()) < _LEAST:
        raise InputError(
            f"{recording.path}: {_LEAST} known positions are needed to start from, {int(recording.known.sum())} are "
            "known; leave the positions of the first second or so in it"
        )
    ball = estimate_ball(
        recording.time, recording.position, drive, rig, noise=sensors.position_noise, resolution=resolution
    )
    reading = np.where(ball.trusted, recording.position, np.nan)
    noise = float(np.hypot(ball.noise, (resolution or 0.0) / np.sqrt(12.0)))
    return PreparedRecording(recording.name, np.array(recording.time), reading, drive), noise
