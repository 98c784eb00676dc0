"""What a position sensor does to the position: gain, curve, first-order lag, delay."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.interpolate import CubicSpline

from analytic.compiled import njit
from analytic.motion import FloatArray

LEAST_SLOPE = 0.1  # of a sensor's curve, over its gain [1]
ITERATIONS = 8  # of Newton's method: each doubles the digits
_BEND_OVER = 1e-4  # over which the slope's derivative is a difference [m]: errors bend over centimetres
_FARTHEST = 1e2  # that a ball lies from the pivot [m]
_SETTLED = 1e-9  # least time constant of the recursion [s]


class PositionError(Protocol):
    """What a sensor adds to the position, by where the ball lies."""

    def at(self, where: FloatArray, /) -> FloatArray:
        """Error at positions, shape (n,) [m]; the same shape [m]."""
        ...

    def slope_at(self, where: FloatArray, /) -> FloatArray:
        """Its derivative at positions, shape (n,) [m]; the same shape [1]."""
        ...


@dataclass(frozen=True)
class SensorLaw:
    """Recorded is `gain` (y + `square` y² + `cube` y³) + `error` of y, y the position behind a lag T ẏ + y = s.

    All of it comes `delay` later.

    Attributes:
        gain: recorded position per position [1].
        lag: T [s].
        delay: the position at t is recorded at t + delay [s]; negative where the angle is late.
        square, cube: of the sensor's curve [1/m, 1/m²].
        error: a further one, as a function of y; `None` for none.
    """

    gain: float = 1.0
    lag: float = 0.0
    delay: float = 0.0
    square: float = 0.0
    cube: float = 0.0
    error: PositionError | None = None

    def behind(self, other: SensorLaw) -> SensorLaw:
        """Both, one behind the other; of two lags or curves the sum, which is right to first order in them."""
        return SensorLaw(
            self.gain * other.gain,
            self.lag + other.lag,
            self.delay + other.delay,
            self.square + other.square,
            self.cube + other.cube,
            self.error or other.error,
        )

    def recorded(self, time: FloatArray, position: FloatArray, behind: float = 0.0) -> FloatArray:
        """What is recorded of `position` [m] at `time` [s], both of shape (n,); NaN where it is not known.

        Args:
            behind: by how much the output of the lag is behind the position at the first stamp [m].
        """
        if self.delay:
            position = _delayed(time, position, self.delay)
        if self.lag:
            position = _lagged(time, position, self.lag, behind)
        return self.curve(position)

    def curve(self, position: FloatArray) -> FloatArray:
        """What is recorded of a ball that lies at `position`, any shape; the same shape [m]."""
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that a fit tries and rejects
            recorded = self.gain * (position + position * position * (self.square + self.cube * position))
            return recorded if self.error is None else recorded + _at(self.error.at, position)

    def slope(self, position: FloatArray) -> FloatArray:
        """Derivative of `curve`, never below a tenth of the gain, which a sensor's curve does not reach; same shape."""
        with np.errstate(over="ignore"):  # likewise; infinite is as steep as any
            slope = 1.0 + position * (2.0 * self.square + 3.0 * self.cube * position)
        slope = self.gain * np.maximum(slope, LEAST_SLOPE)
        if self.error is None:
            return slope
        return np.maximum(slope + _at(self.error.slope_at, position), self.gain * LEAST_SLOPE)

    def bend(self, position: FloatArray) -> FloatArray:
        """Second derivative of `curve`, any shape; the same shape [1/m]."""
        if self.error is None:
            return self.gain * (2.0 * self.square + 6.0 * self.cube * position)
        return (self.slope(position + _BEND_OVER) - self.slope(position - _BEND_OVER)) / (2.0 * _BEND_OVER)

    def position(self, recorded: FloatArray) -> FloatArray:
        """Where a ball lies of which `recorded` is recorded, any shape; the same shape [m]."""
        recorded = np.asarray(recorded, np.float64)
        if self.error is not None:
            near = replace(self, error=None).position(recorded)
            for _ in range(ITERATIONS):
                near = near - (self.curve(near) - recorded) / self.slope(near)
            return near
        if not self.square and not self.cube:
            return recorded / self.gain
        found = [lies(float(one), self.gain, self.square, self.cube) for one in recorded.ravel()]
        return np.reshape(found, recorded.shape)


def _at(function: Callable[[FloatArray], FloatArray], position: FloatArray) -> FloatArray:
    """A function of positions, shape (n,), at positions of any shape; the same shape."""
    position = np.asarray(position, np.float64)
    return function(position.ravel()).reshape(position.shape)


@njit(cache=True, inline="always")
def measured(s: float, gain: float, square: float, cube: float) -> tuple[float, float]:
    """What a sensor with this curve measures of a ball at s [m], and the slope of that [1]; see `SensorLaw`."""
    slope = max(1.0 + s * (2.0 * square + 3.0 * cube * s), LEAST_SLOPE)
    return gain * (s + s * s * (square + cube * s)), gain * slope


@njit(cache=True)
def lies(recorded: float, gain: float, square: float, cube: float) -> float:
    """Where a ball lies of which such a sensor measures `recorded` [m], by Newton's method.

    Where the curve turns round before it reaches that, no ball does: then where it would without the curve.
    """
    s = recorded / gain
    if square != 0.0 or cube != 0.0:
        for _ in range(ITERATIONS):
            value, slope = measured(s, gain, square, cube)
            s -= (value - recorded) / slope
        if not abs(s) < _FARTHEST:
            s = recorded / gain
    return s


def _delayed(time: FloatArray, position: FloatArray, delay: float) -> FloatArray:
    known = np.isfinite(position)
    curve = CubicSpline(time[known], position[known])
    asked = np.clip(time - delay, time[known][0], time[known][-1])
    return np.where(known, curve(asked), np.nan)


def _lagged(time: FloatArray, position: FloatArray, constant: float, behind: float) -> FloatArray:
    """T ẏ + y = s, exact for a position that is linear between stamps; after a gap it begins settled."""
    out = np.array(position, float)
    out[0] -= behind
    for n in range(1, len(time)):
        if not np.isfinite(out[n - 1]):
            continue
        h, slope = time[n] - time[n - 1], (position[n] - position[n - 1]) / (time[n] - time[n - 1])
        follow = position[n - 1] - slope * constant
        out[n] = follow + slope * h + (out[n - 1] - follow) * np.exp(-h / max(constant, _SETTLED))
    return out
