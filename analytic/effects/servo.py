"""The motion of a beam that follows a measured angle, or a command, as a servo of second order does."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.compiled import fixed, njit
from analytic.effects.following import piece_at, settled, slopes
from analytic.motion import BeamMotion, FloatArray
from analytic.quintic import QuinticMotion, behind

_LEAST = 1e-5  # of a lag [s]: at 1 rad/s below any encoder's count, and far from where rounding over its square matters
_NEAR = 1e-3  # of the exponent by which a servo differs from a critically damped one: x⁴/120 is 8e-15


@dataclass(frozen=True)
class ServoMotion:
    """(T/2ζ)² β̈ + T β̇ + β = α behind a motion of quintics, solved exactly; outside the stamps it keeps its values.

    Between two stamps β = Σ c_j α^(j) + y: what follows the quintic in the long run, c_j those of the power series of
    1/((T/2ζ)² p² + T p + 1), and a solution y of the equation without α, such that β and β̇ are continuous. At the
    first stamp β̈ = 0 and β̇ = α̇: the beam has settled behind a motion at that rate.

    Attributes:
        base: α.
        lag: T [s]; the beam is late by it behind a slow motion. The natural frequency is 2 ζ/T [rad/s].
        damping: ζ [1].
    """

    base: QuinticMotion
    lag: float
    damping: float

    @property
    def _square(self) -> float:
        """(T/2ζ)² [s²]."""
        return (0.5 * self.lag / self.damping) ** 2

    @cached_property
    def _settled(self) -> FloatArray:
        """Σ c_j α^(j) of each piece, as of `settled`."""
        series = [1.0, -self.lag]
        for _ in range(4):
            series.append(-self.lag * series[-1] - self._square * series[-2])
        return settled(self.base, series)

    @cached_property
    def _left(self) -> FloatArray:
        """y and ẏ at the start of each piece, shape (n − 1, 2) [rad, rad/s]."""
        gaps = np.diff(self.base.time)
        c, rates = self._settled, slopes(self._settled)
        angle, rate, _ = self.base.states[0]
        ends, end_rates = np.polyval(c, gaps), np.polyval(rates, gaps)
        before = np.concatenate(([angle - self.lag * rate], ends[:-1]))
        before_rate = np.concatenate(([rate], end_rates[:-1]))
        jumps = np.column_stack((before - c[-1], before_rate - rates[-1]))
        left = np.empty((len(gaps), 2))
        _carry(jumps, gaps, self.lag, self._square, left)
        return left

    def states_at(self, time: FloatArray) -> FloatArray:
        """β [rad], β̇ [rad/s], β̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        asked = fixed(np.asarray(time, np.float64))
        out = np.empty((len(asked), 3))
        _follow(fixed(self.base.time), self._settled, self._left, self.lag, self._square, asked, out)
        return out

    def _at(self, time: FloatArray, order: int) -> FloatArray:
        return self.states_at(np.ravel(time))[:, order].reshape(np.shape(time))

    def evaluate(self, time: FloatArray) -> FloatArray:
        """β [rad] at `time` [s], same shape."""
        return self._at(time, 0)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """β̇ [rad/s] or β̈ [rad/s²] at `time` [s], same shape."""
        return self._at(time, order)


@njit(cache=True)
def swung(value: float, rate: float, time: float, lag: float, square: float) -> tuple[float, float]:
    """y [rad] and ẏ [rad/s], which are `value` and `rate` at first, after `time` [s]: `square` ÿ + `lag` ẏ + y = 0."""
    decay = 0.5 * lag / square
    apart = decay * decay - 1.0 / square  # of the two exponents, its square
    turn = np.sqrt(abs(apart))
    x = turn * time
    fading = np.exp(-decay * time)
    near = math.copysign(x * x, apart)
    even, odd = fading * (1.0 + 0.5 * near), fading * time * (1.0 + near / 6.0)
    if x >= _NEAR and apart < 0.0:
        even, odd = fading * np.cos(x), fading * np.sin(x) / turn
    elif x >= _NEAR:
        slow, fast = np.exp(-time / (square * (decay + turn))), np.exp(-(decay + turn) * time)
        even, odd = 0.5 * (slow + fast), 0.5 * (slow - fast) / turn
    return value * even + (rate + decay * value) * odd, rate * even - (value / square + decay * rate) * odd


@njit(cache=True)
def _carry(jumps: FloatArray, gaps: FloatArray, lag: float, square: float, left: FloatArray) -> None:
    """Fill `left`, shape (n, 2): each is what is left of the one before after its gap, and its jump."""
    left[0] = jumps[0]
    for n in range(1, len(left)):
        value, rate = swung(left[n - 1, 0], left[n - 1, 1], gaps[n - 1], lag, square)
        left[n, 0], left[n, 1] = value + jumps[n, 0], rate + jumps[n, 1]


@njit(cache=True)
def _follow(
    stamps: FloatArray,
    settled: FloatArray,
    left: FloatArray,
    lag: float,
    square: float,
    time: FloatArray,
    out: FloatArray,
) -> None:
    """Fill `out`, shape (k, 3), with β, β̇, β̈ at `time`, shape (k,) [s]: of the polynomials `settled`, shape
    (degree + 1, n − 1), and what is left beside them, which is `left` at the start of a piece, shape (n − 1, 2)."""
    piece = 0
    for i in range(len(time)):
        t = min(max(time[i], stamps[0]), stamps[-1])
        piece = piece_at(stamps, t, piece)
        t -= stamps[piece]
        value, slope, bend = 0.0, 0.0, 0.0
        for row in range(settled.shape[0]):
            bend = bend * t + 2.0 * slope
            slope = slope * t + value
            value = value * t + settled[row, piece]
        y, rate = swung(left[piece, 0], left[piece, 1], t, lag, square)
        out[i, 0], out[i, 1], out[i, 2] = value + y, slope + rate, bend - (y + lag * rate) / square


def behind_servo(motion: BeamMotion, stamps: FloatArray, lag: float, damping: float) -> BeamMotion:
    """The motion of a beam that follows `motion`, taken at `stamps`, shape (n,) [s], as a servo with this lag [s]."""
    return motion if lag < _LEAST else behind(motion, stamps, lambda base: ServoMotion(base, lag, damping))
