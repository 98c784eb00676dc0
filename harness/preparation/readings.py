"""The position readings that an identification uses: of a fast sensor, means of some neighbours each.

What moves a ball shows within tenths of a second: at some 70 Hz as well as at 1 kHz, while the work grows with the
number of readings. The mean of an odd number of neighbours, at the stamp in the middle, keeps what they tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.signals.ball_state import BallEstimate


@dataclass(frozen=True)
class UsedReadings:
    """Readings that an identification uses.

    Attributes:
        every: number of neighbouring rows in a mean, odd; 1 where the readings are used as they are.
        position: positions at all stamps, NaN where none is used, shape (n,) [m].
        noise: standard deviation of one of them, quantisation included [m].
    """

    every: int
    position: FloatArray
    noise: float

    @property
    def stamps(self) -> slice:
        """Those among all stamps at which readings are used."""
        return slice(None, None, self.every)


def used_readings(ball: BallEstimate, position: FloatArray, noise: float, every: int) -> UsedReadings:
    """Means of neighbouring readings, the first one at the first stamp.

    A mean is that of the differences from the smoothed path, added to this path at the stamp in the middle: neither a
    missing reading nor an uneven stamp shifts it. One of less than half the usual number of readings is not used.

    Args:
        ball: smoothed, at the n stamps.
        position: readings, NaN where missing or a spike, shape (n,) [m].
        noise: standard deviation of a reading, quantisation included [m].
        every: number of neighbouring rows in a mean, odd (`harness.recording.fast_sensor`).
    """
    if every == 1:
        return UsedReadings(1, position, noise)
    stamps = len(position)
    means = -(-(stamps + every // 2) // every)
    rows = np.full(means * every, np.nan)
    rows[every // 2 : every // 2 + stamps] = position - ball.position
    rows = rows.reshape(means, every)[: -(-stamps // every)]
    count = np.isfinite(rows).sum(axis=1)
    usual = float(np.median(count[count > 0]))
    mean = np.full(len(rows), np.nan)
    np.divide(np.nansum(rows, axis=1), count, out=mean, where=count >= 0.5 * usual)
    used = np.full(stamps, np.nan)
    used[::every] = ball.position[::every] + mean
    # Neighbours share coloured noise, and the rounding of a ball at rest: then a mean has more of it than of white one.
    return UsedReadings(every, used, math.sqrt(max(float(np.nanmean(mean**2)), noise**2 / usual)))
