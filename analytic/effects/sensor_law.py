"""What a position sensor does to the position: gain, first-order lag, delay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.motion import FloatArray

_SETTLED = 1e-9  # least time constant of the recursion [s]


@dataclass(frozen=True)
class SensorLaw:
    """Recorded is `gain` [1] times the position behind a first-order lag T ẏ + y = s, `delay` [s] later.

    Attributes:
        gain: recorded position per position [1].
        lag: T [s].
        delay: the position at t is recorded at t + delay [s]; negative where the angle is late.
    """

    gain: float = 1.0
    lag: float = 0.0
    delay: float = 0.0

    def behind(self, other: SensorLaw) -> SensorLaw:
        """Both, one behind the other; of two lags the sum, which is right to first order in them."""
        return SensorLaw(self.gain * other.gain, self.lag + other.lag, self.delay + other.delay)

    def recorded(self, time: FloatArray, position: FloatArray) -> FloatArray:
        """What is recorded of `position` [m] at `time` [s], both of shape (n,); NaN where it is not known."""
        if self.delay:
            position = _delayed(time, position, self.delay)
        if self.lag:
            position = _lagged(time, position, self.lag)
        return self.gain * position


def _delayed(time: FloatArray, position: FloatArray, delay: float) -> FloatArray:
    known = np.isfinite(position)
    curve = CubicSpline(time[known], position[known])
    asked = np.clip(time - delay, time[known][0], time[known][-1])
    return np.where(known, curve(asked), np.nan)


def _lagged(time: FloatArray, position: FloatArray, constant: float) -> FloatArray:
    """T ẏ + y = s, exact for a position that is linear between stamps; it begins settled."""
    out = np.array(position, float)
    for n in range(1, len(time)):
        if not np.isfinite(out[n - 1]):
            continue
        h, slope = time[n] - time[n - 1], (position[n] - position[n - 1]) / (time[n] - time[n - 1])
        follow = position[n - 1] - slope * constant
        out[n] = follow + slope * h + (out[n - 1] - follow) * np.exp(-h / max(constant, _SETTLED))
    return out
