"""Prepares a recording for comparison and identification: drive, ball state, trusted readings and their noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.errors import InputError
from harness.preparation.readings import UsedReadings, used_readings
from harness.recording import Recording, Sensors
from harness.recording.fast_sensor import neighbours_in_mean
from harness.signals.ball_state import BallEstimate, estimate_ball
from harness.signals.drive import Drive, make_drive
from harness.signals.held_drive import held_drive

MIN_POSITIONS = 3  # for estimating a state


@dataclass(frozen=True)
class Observed:
    """A prepared recording.

    Attributes:
        recording: the checked input.
        drive: smoothed motion of the beam.
        ball: smoothed state of the ball, relative to CAM on some rig.
        noise: standard deviation of a position reading, quantisation included [m].
    """

    recording: Recording
    drive: Drive
    ball: BallEstimate
    noise: float

    @property
    def reading(self) -> FloatArray:
        """Positions, NaN where unknown, set aside or a spike, shape (n,) [m]."""
        return np.where(self.ball.trusted, self.recording.position, np.nan)

    @cached_property
    def used(self) -> UsedReadings:
        """The readings that an identification uses, in means where the sensor is fast."""
        return used_readings(self.ball, self.reading, self.noise, neighbours_in_mean(self.recording))


def _unused(recording: Recording) -> str:
    return " ".join(one.text[:1].upper() + one.text[1:] for one in recording.findings if one.code == "unused-columns")


def observe(
    recording: Recording, sensors: Sensors, rig: Rig, noise_share: float = 1.0, *, held_command: bool = False
) -> Observed:
    """Prepares a recording, with the declared or inferred resolution of its sensors.

    Args:
        recording: checked.
        sensors: what is declared of them.
        rig: complete; a rough one if it is unknown. The ball's motion is smoothed relative to CAM on this rig.
        noise_share: what of the scatter of the angle is an error (`Drive.quieter`) [1].
        held_command: the angle is a command that is held from stamp to stamp (`HeldDrive`).

    Raises:
        InputError: fewer than three positions are known.
    """
    count = int(recording.usable.sum())
    if count < MIN_POSITIONS:
        raise InputError(
            f"{recording.path}: {MIN_POSITIONS} known ball positions are needed to estimate the start state, {count} "
            "are known; check that the column is there and named ball_position_m, leave the positions of the first "
            f"second or so in it, or choose another recording. {_unused(recording)}".rstrip()
        )
    drive: Drive = make_drive(
        recording.time,
        recording.angle,
        resolution=sensors.angle_resolution or recording.angle_step,
        noise=sensors.angle_noise,
    ).quieter(noise_share)
    if held_command:
        drive = held_drive(drive)
    resolution = sensors.position_resolution or recording.position_step
    position = np.where(recording.usable, recording.position, np.nan)
    ball = estimate_ball(recording.time, position, drive, rig, noise=sensors.position_noise, resolution=resolution)
    return Observed(recording, drive, ball, math.hypot(ball.noise, (resolution or 0.0) / math.sqrt(12.0)))
