"""Beam motions that follow a measured one: with a first-order lag, on the mean of steps, along a curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.compiled import fixed, njit
from analytic.motion import BeamMotion, FloatArray, beam_states
from analytic.quintic import QuinticMotion, behind

_LEAST = 1e-6  # of a lag [s]: at 1 rad/s below any encoder's count, and far from where rounding matters
_ROUNDED = 1e-3  # of a lag [s], below which rounding is felt in differences over it
_DEGREE = 5  # of the motion between stamps


def settled(base: QuinticMotion, series: Sequence[float]) -> FloatArray:
    """Σ c_j α^(j) of each piece of a motion, `series` c_0 … c_5 [s^j]: what follows it in the long run [rad].

    Returns:
        Coefficients of (t − t_k)⁵ … (t − t_k)⁰, shape (6, n − 1) [rad, s].
    """
    total = np.empty_like(base.spline.c)
    _settle(base.spline.c, np.array(series), total)
    return total


@njit(cache=True)
def _settle(c: FloatArray, series: FloatArray, total: FloatArray) -> None:
    """Fill `total`, shape (6, pieces), with the polynomials of `settled` of those in `c`, same shape."""
    for power in range(_DEGREE + 1):  # of t − t_k in the term to which derivatives of higher powers contribute
        at = _DEGREE - power
        total[at] = series[0] * c[at]
        factor = 1.0
        for order in range(1, at + 1):
            factor *= power + order
            for piece in range(c.shape[1]):
                total[at, piece] += factor * series[order] * c[at - order, piece]


def slopes(c: FloatArray, order: int = 1) -> FloatArray:
    """Derivatives of polynomials by time.

    Args:
        c: coefficients of each piece as of `settled`, highest power first, shape (k, n − 1) [rad, s].

    Returns:
        Those of the derivative of this order, shape (k − `order`, n − 1) [rad, s].
    """
    for _ in range(order):
        c = c[:-1] * np.arange(len(c) - 1, 0, -1.0)[:, None]
    return c


@dataclass(frozen=True)
class LaggedMotion:
    """T β̇ + β = α behind a motion of quintics, solved exactly; outside the stamps it keeps its values at their ends.

    Between two stamps β = Σ (−T)^j α^(j) + C exp(−(t − t_k)/T): what follows the quintic in the long run, and what is
    left of the pieces before. At the first stamp β̈ = 0 and β̇ = α̇: the beam has settled behind a motion at that rate.

    Attributes:
        base: α.
        constant: T [s].
    """

    base: QuinticMotion
    constant: float

    @cached_property
    def _settled(self) -> FloatArray:
        """Σ (−T)^j α^(j) of each piece, as of `settled`."""
        return settled(self.base, [(-self.constant) ** order for order in range(_DEGREE + 1)])

    @cached_property
    def _left(self) -> FloatArray:
        """C of each piece, shape (n − 1,) [rad]."""
        gaps = np.diff(self.base.time)
        c, T = self._settled, self.constant
        # β, β̇ and β̈ are continuous: what the settled motions of two pieces differ by at their stamp is left over.
        ends = np.polyval(c, gaps)
        jumps = np.concatenate(([-2.0 * T**2 * c[_DEGREE - 2, 0]], ends[:-1] - c[_DEGREE, 1:]))
        left = np.empty(len(gaps))
        _fade(jumps, np.exp(-gaps / T), left)
        return left

    def _at(self, time: FloatArray, order: int) -> FloatArray:
        asked = np.atleast_1d(np.asarray(time, np.float64))
        out = np.empty(asked.size)
        scale = (-1.0 / self.constant) ** order
        _follow(
            fixed(self.base.time),
            slopes(self._settled, order),
            self._left,
            self.constant,
            scale,
            fixed(asked.ravel()),
            out,
        )
        return out.reshape(np.shape(time))

    def evaluate(self, time: FloatArray) -> FloatArray:
        """β [rad] at `time` [s], same shape."""
        return self._at(time, 0)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """β̇ [rad/s] or β̈ [rad/s²] at `time` [s], same shape."""
        return self._at(time, order)

    def states_at(self, time: FloatArray) -> FloatArray:
        """β [rad], β̇ [rad/s], β̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        if self.constant < _ROUNDED:
            return np.column_stack([self._at(time, order) for order in range(3)])
        angle, rate, _ = self.base.states_at(np.clip(time, self.base.time[0], self.base.time[-1])).T
        behind = self._at(time, 0)
        slope = (angle - behind) / self.constant
        return np.column_stack((behind, slope, (rate - slope) / self.constant))


@njit(cache=True)
def piece_at(stamps: FloatArray, time: float, piece: int) -> int:
    """Number of the piece between stamps, shape (n,) [s], that `time` [s] is in; `piece` is that of the time before."""
    last = len(stamps) - 2
    if time < stamps[piece] or time >= stamps[min(piece + 2, last + 1)]:
        return min(max(int(np.searchsorted(stamps, time, side="right")) - 1, 0), last)
    return piece + 1 if piece < last and time >= stamps[piece + 1] else piece


@njit(cache=True)
def _follow(
    stamps: FloatArray,
    settled: FloatArray,
    left: FloatArray,
    constant: float,
    scale: float,
    time: FloatArray,
    out: FloatArray,
) -> None:
    """Fill `out`, shape (k,), with what the polynomials `settled`, shape (degree + 1, n − 1), have at `time`, shape
    (k,) [s], and `scale` times the rest of `left`, shape (n − 1,), that has not faded yet."""
    piece = 0
    for i in range(len(time)):
        t = min(max(time[i], stamps[0]), stamps[-1])
        piece = piece_at(stamps, t, piece)
        t -= stamps[piece]
        value = 0.0
        for row in range(settled.shape[0]):
            value = value * t + settled[row, piece]
        out[i] = value + scale * left[piece] * np.exp(-t / constant)


@njit(cache=True)
def _fade(jumps: FloatArray, rests: FloatArray, left: FloatArray) -> None:
    """Fill `left`, shape (n,): each is what is left of the one before, by the factor `rests`, and its jump."""
    left[0] = jumps[0]
    for n in range(1, len(left)):
        left[n] = left[n - 1] * rests[n - 1] + jumps[n]


def lagged(motion: BeamMotion, stamps: FloatArray, constant: float) -> BeamMotion:
    """The motion of a beam that follows `motion`, taken at `stamps`, shape (n,) [s], with the lag `constant` [s]."""
    return motion if constant < _LEAST else behind(motion, stamps, lambda base: LaggedMotion(base, constant))


@dataclass(frozen=True)
class HeldMotion:
    """The mean of a motion of quintics over the last `interval`: β(t) = (1/T) ∫ α dτ from t − T to t.

    Before the first stamp α went on at that stamp's rate; outside the stamps β keeps its values at their ends.

    Attributes:
        base: α.
        interval: T [s].
    """

    base: QuinticMotion
    interval: float

    def _primitive(self, time: FloatArray, order: int) -> FloatArray:
        """∫ α dt from the first stamp on and its derivatives, also before it."""
        begin, (angle, rate, _) = self.base.time[0], self.base.states[0]
        early = np.minimum(time - begin, 0.0)
        known = np.maximum(time, begin)
        if order == 0:
            return self.base.integral(known) + early * (angle + 0.5 * rate * early)
        inside = self.base.spline(known, order - 1)
        return inside + rate * early if order == 1 else inside

    def _at(self, time: FloatArray, order: int) -> FloatArray:
        now = np.clip(time, self.base.time[0], self.base.time[-1])
        return (self._primitive(now, order) - self._primitive(now - self.interval, order)) / self.interval

    def evaluate(self, time: FloatArray) -> FloatArray:
        """β [rad] at `time` [s], same shape."""
        return self._at(time, 0)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """β̇ [rad/s] or β̈ [rad/s²] at `time` [s], same shape."""
        return self._at(time, order)

    def states_at(self, time: FloatArray) -> FloatArray:
        """β [rad], β̇ [rad/s], β̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        begin, (_, rate, _) = self.base.time[0], self.base.states[0]
        now = np.clip(time, begin, self.base.time[-1])
        before = now - self.interval
        ahead, behind = self.base.states_at(now), self.base.states_at(np.maximum(before, begin))
        behind[:, 0] += rate * np.minimum(before - begin, 0.0)
        slopes = (ahead[:, :2] - behind[:, :2]) / self.interval
        return np.column_stack((self._at(time, 0), slopes))


def held(motion: BeamMotion, stamps: FloatArray, interval: float) -> BeamMotion:
    """The mean motion of a beam that takes `motion`, at `stamps`, shape (n,) [s], in steps of `interval` [s]."""
    return motion if interval < _LEAST else behind(motion, stamps, lambda base: HeldMotion(base, interval))


@dataclass(frozen=True)
class CurvedMotion:
    """β = α + `square` α² + `cube` α³ of another beam motion α [rad]."""

    base: BeamMotion
    square: float
    cube: float

    def evaluate(self, time: FloatArray) -> FloatArray:
        """β [rad] at `time` [s], same shape."""
        angle = self.base.evaluate(time)
        return angle * (1.0 + angle * (self.square + angle * self.cube))

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """β̇ [rad/s] or β̈ [rad/s²] at `time` [s], same shape."""
        angle = self.base.evaluate(time)
        slope = 1.0 + angle * (2.0 * self.square + 3.0 * self.cube * angle)
        if order == 1:
            return slope * self.base.derivative(time)
        bend = 2.0 * self.square + 6.0 * self.cube * angle
        return slope * self.base.derivative(time, 2) + bend * self.base.derivative(time) ** 2

    def states_at(self, time: FloatArray) -> FloatArray:
        """β [rad], β̇ [rad/s], β̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        angle, rate, angular = beam_states(self.base, time).T
        slope = 1.0 + angle * (2.0 * self.square + 3.0 * self.cube * angle)
        bend = 2.0 * self.square + 6.0 * self.cube * angle
        value = angle * (1.0 + angle * (self.square + angle * self.cube))
        return np.column_stack((value, slope * rate, slope * angular + bend * rate**2))
