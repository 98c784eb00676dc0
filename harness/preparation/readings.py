"""The position readings that an identification uses: of a fast sensor, means of some neighbours each.

What moves a ball shows within tenths of a second: at some 70 Hz as well as at 1 kHz, while the work grows with the
number of readings. The mean of an odd number of neighbours, at the stamp in the middle, keeps what they tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.recording import Recording
from harness.signals.ball_state import BallEstimate

# Rate above which readings are averaged [Hz]. A mean over 15 ms of a ball that accelerates by 2 m/s² is off by
# 2·0.015²/24 = 0.02 mm from the position in the middle, of which the smoothed path knows the greater part.
_ENOUGH = 66.0
_FEWEST = 2  # positions that have a rate


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


def neighbours_in_mean(recording: Recording) -> int:
    """How many neighbouring rows make one reading that is used: odd, mostly 1.

    What counts is the rate of the positions that can be used, from the first to the last of them: where the ball is to
    be predicted, only those of the first seconds are known.
    """
    known = recording.time[recording.usable]
    if len(known) < _FEWEST:
        return 1
    rate = (len(known) - 1) / float(known[-1] - known[0])
    return max(2 * ((int(rate / _ENOUGH) + 1) // 2) - 1, 1)


def used_readings(ball: BallEstimate, position: FloatArray, noise: float, every: int) -> UsedReadings:
    """Means of neighbouring readings, the first one at the first stamp.

    A mean is that of the differences from the smoothed path, added to this path at the stamp in the middle: neither a
    missing reading nor an uneven stamp shifts it. One of less than half the usual number of readings is not used.

    Args:
        ball: smoothed, at the n stamps.
        position: readings, NaN where missing or a spike, shape (n,) [m].
        noise: standard deviation of a reading, quantisation included [m].
        every: number of neighbouring rows in a mean, odd (`neighbours_in_mean`).
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
