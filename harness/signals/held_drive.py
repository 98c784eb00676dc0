"""The drive of a command that is held from stamp to stamp, as a digital controller gives it.

A command that a controller computes from the reading of the same stamp has the noise of that reading. If the beam of a
model has begun to follow it before, as between two stamps of an interpolated angle, its acceleration moves the ball by
that noise, and the model predicts a part of the reading from itself: 0.2 of it on a beam with 3 cm of lever. Here a
beam that lags is given each command at its stamp, within 0.05 ms. One that does not has the mean of the commands half a
hold before and after, which changes smoothly with a delay, and no rate or acceleration that could throw the ball. The
command has no error.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.motion import BeamMotion, DelayedMotion, FloatArray
from analytic.quintic import LinearMotion, QuinticMotion
from harness.signals.drive import AngleSensor, Drive
from harness.signals.error_process import ErrorProcess

# Of the time to the stamp before or after, and at most [s]: how long before and after its stamp the beam turns to a
# command. What lags then has at the stamp, where a step of the integration ends and the next one begins, the mean of
# its accelerations before and after. Where the beam turned after the stamp, a lag of 100 ms came out 1 ms too short.
_TURNING, _LONGEST = 0.0625, 5e-5
_ERROR = 1e-6  # rad: nothing, but no density that a filter divides by


@dataclass(frozen=True, kw_only=True)
class HeldDrive(Drive):
    """A beam that turns to each reading at its stamp and stays there; `time` has three knots a stamp.

    `states`, `std` and `reading` are at the knots: where the beam begins to turn, the stamp, and where it has turned.
    `smoothed` is what the readings would tell of a beam whose angle is measured, `commands` are those of its stamps,
    shape (n,) [rad].
    """

    smoothed: Drive
    commands: FloatArray

    @property
    def gentle(self) -> BeamMotion:
        """The smoothed commands, late by half the time from stamp to stamp, as held ones are on average."""
        time = self.smoothed.time
        return DelayedMotion(self.smoothed, 0.5 * float(np.median(np.diff(time))), float(time[0]), float(time[-1]))

    @cached_property
    def exact(self) -> QuinticMotion:
        """What a beam that lags follows: each command from its stamp on."""
        return LinearMotion(self.time, self.states)

    @cached_property
    def _middles(self) -> tuple[FloatArray, FloatArray]:
        """The middle of each hold [s] and the command [rad], shape (n,) each."""
        time = self.smoothed.time
        last = 0.5 * float(time[-1] - time[-2])
        return np.append(0.5 * (time[1:] + time[:-1]), time[-1] + last), self.commands

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape: its mean over half a hold before and after, which moves with a delay."""
        return np.interp(time, *self._middles)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """Zero: how fast the beam turns to a command is not in the command."""
        return np.zeros(np.shape(time))

    def states_at(self, time: FloatArray) -> FloatArray:
        """α [rad], α̇ [rad/s], α̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        return np.column_stack((self.evaluate(time), np.zeros((len(time), 2))))

    @property
    def commanded(self) -> bool:
        """Always."""
        return True

    @cached_property
    def error(self) -> ErrorProcess:
        """White, of 1e-6 rad, and none of the rates."""
        n, none = len(self.time), np.zeros((3, 3))
        only = none.copy()
        only[0, 0] = _ERROR
        return ErrorProcess(np.tile(only**2, (n, 1, 1)), np.tile(none, (n - 1, 1, 1)), np.tile(only, (n - 1, 1, 1)))

    def rougher(self, factor: float) -> Drive:
        """The same: nothing is smoothed."""
        return self

    def quieter(self, share: float) -> Drive:
        """The same: there is no noise."""
        return self

    def draw(self, count: int, seed: int) -> list[QuinticMotion]:
        """`count` beam motions that scatter by the error."""
        random = np.random.default_rng(seed)
        scatter = np.zeros((count, *self.states.shape))
        scatter[:, :, 0] = _ERROR * random.standard_normal((count, len(self.time)))
        return [QuinticMotion(self.time, self.states + one) for one in scatter]


def held_drive(smoothed: Drive) -> HeldDrive:
    """A beam that is given each angle at its stamp.

    Args:
        smoothed: from the same stamps and angles; where none is known, the one before stays.
    """
    time, angle = smoothed.time, smoothed.reading
    known = np.flatnonzero(np.isfinite(angle))
    given = angle[known[np.maximum(np.searchsorted(known, np.arange(len(time)), side="right") - 1, 0)]]
    turning = np.minimum(_TURNING * np.diff(time), _LONGEST)
    before = np.concatenate((given[:1], given[:-1]))
    early, late = np.append(0.0, turning), np.append(turning, 0.0)
    # No turn to the first command, before which none is known; half of one to the last, which moves nothing.
    knots = np.column_stack((time - early, time, time + late)).ravel()[1:-1]
    values = np.column_stack((before, 0.5 * (before + given), given)).ravel()[1:-1]
    states = np.column_stack((values, np.zeros((len(knots), 2))))
    std = np.zeros_like(states)
    std[:, 0] = _ERROR
    exact = AngleSensor(0.0, 0.0, estimated=False)
    return HeldDrive(knots, states, std, exact, 1.0, values, smoothed=smoothed, commands=given)
