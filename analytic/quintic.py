"""Beam motions that are quintics between stamps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PPoly

from analytic.compiled import fixed, njit
from analytic.motion import BeamMotion, FloatArray, ScaledMotion, beam_states

_FINE_STEP = 5e-4  # of the grid on which a gap is followed [s]: at 1 rad/s a third of a count of 4096 counts


def quintic(time: FloatArray, states: FloatArray) -> PPoly:
    """The piecewise quintic through values, first and second derivatives, shape (n, 3), at `time`, shape (n,) [s].

    By hand, because `BPoly.from_derivatives` loops over the pieces in Python: 75 ms against 0.15 ms for 1600 stamps, as
    long as all of `make_drive`, and its Bernstein basis takes ten times as long to evaluate.
    """
    h = np.diff(time)
    p, v, a = states[:-1].T
    dp = states[1:, 0] - p - v * h - 0.5 * a * h**2
    dv = states[1:, 1] - v - a * h
    da = states[1:, 2] - a
    c3 = (10 * dp - 4 * dv * h + 0.5 * da * h**2) / h**3
    c4 = (-15 * dp + 7 * dv * h - da * h**2) / h**4
    c5 = (6 * dp - 3 * dv * h + 0.5 * da * h**2) / h**5
    return PPoly(np.array([c5, c4, c3, 0.5 * a, v, p]), time)


@dataclass(frozen=True)
class QuinticMotion:
    """A beam motion through given states, a quintic between them; see `analytic.motion.BeamMotion`.

    Attributes:
        time: shape (n,), strictly increasing [s].
        states: α [rad], α̇ [rad/s], α̈ [rad/s²] at `time`, shape (n, 3).
    """

    time: FloatArray
    states: FloatArray

    @property
    def exact(self) -> QuinticMotion:
        """The quintics that a beam follows which lags behind this motion: these."""
        return self

    @cached_property
    def spline(self) -> PPoly:
        """The piecewise quintic."""
        return quintic(self.time, self.states)

    @cached_property
    def fine(self) -> tuple[FloatArray, FloatArray]:
        """A grid of 0.5 ms from the first stamp to the last [s], and α on it [rad], shape (k,) each."""
        time = _fine_grid(self.time)
        return time, self.evaluate(time)

    @cached_property
    def integral(self) -> PPoly:
        """∫ α dt from the first stamp on [rad s]."""
        return self.spline.antiderivative()

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        return self.spline(time)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²] at `time` [s], same shape."""
        return self.spline(time, order)

    def states_at(self, time: FloatArray) -> FloatArray:
        """α [rad], α̇ [rad/s], α̈ [rad/s²] at `time`, shape (n,) [s]; shape (n, 3)."""
        out = np.empty((len(time), 3))
        _evaluate(fixed(self.time), self.spline.c, fixed(time), out)
        return out


@dataclass(frozen=True)
class LinearMotion(QuinticMotion):
    """A beam motion that is linear between its states' angles; their rates and angular accelerations are not used.

    What follows it late is exact to rounding however fast it turns. A quintic that turns by an angle within T has a
    fifth derivative of 720 times that angle over T⁵, which the law of a follower would add and take off again.
    """

    @cached_property
    def spline(self) -> PPoly:
        """The pieces, straight."""
        angle = self.states[:, 0]
        slope = np.diff(angle) / np.diff(self.time)
        return PPoly(np.vstack((np.zeros((4, len(slope))), slope, angle[:-1])), self.time)


@njit(cache=True)
def _evaluate(stamps: FloatArray, c: FloatArray, time: FloatArray, out: FloatArray) -> None:
    """Fill `out`, shape (n, 3), with the quintics `c`, shape (6, pieces), between `stamps`, and their derivatives.

    The first and the last piece go on beyond the stamps. Fastest where `time`, shape (n,) [s], is in order.
    """
    piece, last = 0, len(stamps) - 2
    for i in range(len(time)):
        t = time[i]
        if t < stamps[piece] or (piece < last and t >= stamps[piece + 1]):
            if t >= stamps[piece] and (piece + 1 == last or t < stamps[piece + 2]):
                piece += 1
            else:
                piece = min(max(np.searchsorted(stamps, t, side="right") - 1, 0), last)
        t -= stamps[piece]
        value = slope = bend = 0.0
        for row in range(6):
            bend = bend * t + 2.0 * slope
            slope = slope * t + value
            value = value * t + c[row, piece]
        out[i, 0], out[i, 1], out[i, 2] = value, slope, bend


def through(motion: BeamMotion, stamps: FloatArray) -> QuinticMotion:
    """`motion` as quintics between `stamps`, shape (n,) [s]: itself if it is that already, else through its states."""
    if isinstance(motion, QuinticMotion) and np.array_equal(motion.time, stamps):
        return motion.exact
    return QuinticMotion(stamps, beam_states(motion, stamps))


def finely(motion: BeamMotion, stamps: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A grid of 0.5 ms over `stamps`, shape (n,) [s], and α of a motion on it [rad], shape (k,) each.

    Kept where the motion is one of quintics between these stamps, or a multiple of it.
    """
    if isinstance(motion, ScaledMotion):
        time, angle = finely(motion.base, stamps)
        return time, motion.gain * angle
    if isinstance(motion, QuinticMotion) and np.array_equal(motion.time, stamps):
        return motion.fine
    time = _fine_grid(stamps)
    return time, motion.evaluate(time)


def _fine_grid(stamps: FloatArray) -> FloatArray:
    begin, end = float(stamps[0]), float(stamps[-1])
    return np.append(begin + _FINE_STEP * np.arange(int((end - begin) / _FINE_STEP) + 1), end)


def behind(motion: BeamMotion, stamps: FloatArray, law: Callable[[QuinticMotion], BeamMotion]) -> BeamMotion:
    """The motion of a beam that follows `motion`, taken at `stamps`, shape (n,) [s], by a linear `law`.

    Behind `gain` times a motion that is `gain` times the beam's behind the motion.
    """
    if isinstance(motion, ScaledMotion):
        return ScaledMotion(behind(motion.base, stamps, law), motion.gain)
    return law(through(motion, stamps))
