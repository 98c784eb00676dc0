"""What the filter takes and returns, and what its two forms share."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.effects.sensor_law import ITERATIONS, LEAST_SLOPE, lies, measured
from analytic.law import OF_SENSOR, spline_slope, spline_term
from analytic.motion import FloatArray
from analytic.slots import SHAPE
from harness.signals.error_process import ErrorProcess

SPIKE = 4.0  # normalised innovation beyond which readings are down-weighted
VELOCITY_VARIANCE = 1e-2  # of the first state, at rest with standard deviation 0.1 m/s [m²/s²]
UNSTEADY = 0.5  # standard deviation of its acceleration, that of a ball on a beam at 4° [m/s²]
# Smallest steps of the Jacobian's finite differences, in units of state: s, ṡ, slip or Dahl friction, lagging s, e.
NUDGE = np.array([1e-6, 1e-5, 1e-5, 1e-6, 1e-6])


class Readings(NamedTuple):
    """Stamps, strictly increasing [s], and position readings, NaN where missing [m]; shape (n,) each."""

    time: FloatArray
    position: FloatArray


class BeamTable(NamedTuple):
    """Integration grid and the beam motion on it (`analytic.kernel.Grid`).

    Attributes:
        steps: step sizes, shape (m,) [s].
        marks: index of the step that begins at each stamp, shape (n,).
        table: α, α̇, α̈ at the start, middle and end of every step, and a friction of time; shape (2 m + 1, 3 or 4).
    """

    steps: FloatArray
    marks: NDArray[np.int64]
    table: FloatArray


class Sensor(NamedTuple):
    """Position sensor: gain [1], time constant of its lag or 0 [s], reading variance R [m²], curve [1/m, 1/m²].

    It measures h(s) = gain (s + square s² + cube s³), with an error besides that the kernel's vector holds, with white
    noise of variance R and coloured noise, a first-order Gauss–Markov process of variance `colour` [m²] and correlation
    time `colour_time` [s].
    """

    gain: float
    lag: float
    reading_variance: float
    square: float = 0.0
    cube: float = 0.0
    colour: float = 0.0
    colour_time: float = 1.0


class FilterOutput(NamedTuple):
    """Output of the filter at n stamps.

    Attributes:
        innovation: reading − prediction, 0 where there is no reading, shape (n,) [m].
        innovation_variance: S, 1 where there is no reading, shape (n,) [m²].
        state: filtered s [m], ṡ [m/s], internal state of slip or Dahl friction, lagging position [m], shape (n, 4).
        position_variance: variance of the (lagging) position before the sensor's gain, shape (n,) [m²].
    """

    innovation: FloatArray
    innovation_variance: FloatArray
    state: FloatArray
    position_variance: FloatArray


class Memory(NamedTuple):
    """What the filter knows after a stamp, from which it can go on at the next one; zeros before the first reading.

    Attributes:
        begun: whether there was a reading, shape (1,).
        x: state, in the order of the form of the filter, shape (m + 5,), with m numbers of the angle's error.
        root: triangular root of the covariance, in its first rows and columns, shape (m + 5, m + 5).
    """

    begun: NDArray[np.bool_]
    x: FloatArray
    root: FloatArray

    @classmethod
    def blank(cls, error: ErrorProcess) -> Memory:
        """Before the first reading, where the angle has this error."""
        size = error.transition.shape[1] + 5
        return cls(np.zeros(1, dtype=np.bool_), np.zeros(size), np.zeros((size, size)))

    def copy(self) -> Memory:
        """The same, which a run from here on leaves as it is."""
        return Memory(self.begun.copy(), self.x.copy(), self.root.copy())


@njit(cache=True, inline="always")
def weighted(e: float, S: float, reading_variance: float) -> tuple[float, float]:
    """Innovation and reading variance that down-weight an innovation e: S' = S/w and R' = R + S (1/w − 1) [m²]."""
    inverse_weight = max(1.0, abs(e) / (SPIKE * math.sqrt(S)))
    return S * inverse_weight, reading_variance + S * (inverse_weight - 1.0)


@njit(cache=True, inline="always")
def velocity_nudge(v: float, variance: float) -> float:
    """Step of the finite difference in velocity: a standard deviation in the direction of motion [m/s].

    Where dry friction stops the ball, the derivative by velocity vanishes, and so would the variance, although within
    a standard deviation the ball rolls on. Differences over a standard deviation avoid this (Schei, Automatica 33,
    1997).
    """
    return math.copysign(max(NUDGE[1], math.sqrt(variance)), v)


@njit(cache=True, inline="always")
def angle_nudge(variance: float) -> float:
    """Step of the finite difference in the angle's error: a standard deviation, for the same reason [rad]."""
    return max(NUDGE[4], math.sqrt(variance))


@njit(cache=True, inline="always")
def reading_of(s: float, sensor: Sensor, p: FloatArray) -> tuple[float, float]:
    """What the sensor reads of a (lagging) position s [m], with its error if the kernel's vector has one, and the slope
    of that [1]."""
    expected, slope = measured(s, sensor.gain, sensor.square, sensor.cube)
    if p[SHAPE] == OF_SENSOR:
        expected += spline_term(s, p)
        slope = max(slope + spline_slope(s, p), LEAST_SLOPE * sensor.gain)
    return expected, slope


@njit(cache=True)
def position_of(reading: float, sensor: Sensor, p: FloatArray) -> float:
    """The position of which the sensor reads that [m], by Newton's method."""
    s = lies(reading, sensor.gain, sensor.square, sensor.cube)
    if p[SHAPE] == OF_SENSOR:
        for _ in range(ITERATIONS):
            expected, slope = reading_of(s, sensor, p)
            s -= (expected - reading) / slope
    return s


@njit(cache=True, inline="always")
def lagging(y: float, before: float, s: float, h: float, lag: float) -> float:
    """Output of a lagging sensor after `h` [s], T ẏ + y = s, exact where the position goes linearly to s [m].

    Args:
        y, before: output and position at the beginning [m].
        lag: T [s].
    """
    slope = (s - before) / h
    follow = before - slope * lag
    return follow + slope * h + (y - follow) * math.exp(-h / lag)


@njit(cache=True)
def lagging_noise(h: float, lag: float) -> tuple[float, float, float]:
    """What white acceleration in a step of `h` [s] adds to the output y of a lagging sensor, T ẏ + y = s [m].

    An acceleration of unit density at z before the step's end moves the velocity by 1, the position by z and the output
    by g = z − T (1 − e^(−z/T)). The covariances follow from integrals of z g, g and g² over the step. Velocity and
    position have (√¾, ½) √h and (h/√3, 0) √h of two independent variables; the output has these and one of its own.

    Args:
        lag: T [s].

    Returns:
        Factors of the three variables, of root density 1 [s^1.5].
    """
    x = h / lag
    if x < 0.02:  # the closed forms cancel; leading terms, of what is small beside the position's by h/T
        with_position, with_velocity, alone = h**3 * x / 8.0, h * h * x / 6.0, h**3 * x * x / 20.0
    else:
        kept = math.exp(-x)
        first = lag * (1.0 - kept)  # ∫ e^(−z/T)
        moment = lag * (first - kept * h)  # ∫ z e^(−z/T)
        second = 0.5 * lag * (1.0 - kept * kept)  # ∫ e^(−2z/T)
        with_position = h**3 / 3.0 - lag * (0.5 * h * h - moment)
        with_velocity = 0.5 * h * h - lag * (h - first)
        alone = h**3 / 3.0 - 2.0 * lag * (0.5 * h * h - moment) + lag * lag * (h - 2.0 * first + second)
    root = math.sqrt(h)
    a = math.sqrt(3.0) * with_position / (h * root)
    b = 2.0 * (with_velocity / root - math.sqrt(0.75) * a)
    return a, b, math.sqrt(max(alone - a * a - b * b, 0.0))


@njit(cache=True, inline="always")
def rate_change(A: FloatArray, e: float, rate: float, angular: float) -> float:
    """By how much the mean of ė changes over a step with the transition A of (e, ė, ë), shape (3, 3) [rad/s].

    Args:
        e, rate, angular: e [rad], ė [rad/s], ë [rad/s²] before it.
    """
    return A[1, 0] * e + A[1, 1] * rate + A[1, 2] * angular - rate


@njit(cache=True, inline="always")
def rate_noise(B: FloatArray) -> float:
    """Standard deviation of what else changes ė over a step with the root B of its noise, shape (m, k) [rad/s]."""
    total = 0.0
    for c in range(B.shape[1]):
        total += B[1, c] ** 2
    return math.sqrt(total)


@njit(cache=True, inline="always")
def shifted(
    beam: BeamTable, step: int, since: float, e: float, rate: float, angular: float, change: float, out: FloatArray
) -> None:
    """The rows of the beam's table for one step, α and α̈ increased by their errors, into `out`, shape (3, 3 or 4).

    A ball that rolls has a velocity that is wrong by K ℓ ė, as the pivot throws it back, and forgets that when ė
    changes. One that is held until the beam starts keeps what ė was then: the error is taken as a change of ė between
    the stamps, which adds up to ė over any time; ë from stamp to stamp would not.

    Args:
        step: index of the step.
        since: time from the stamp, at which the error is e [rad], ė [rad/s], ë [rad/s²], to the step's begin [s].
        change: of ė from this stamp to the next one, over the time between them [rad/s²].
    """
    half = 0.5 * beam.steps[step]
    for i in range(3):
        u = since + half * i
        for c in range(out.shape[1]):
            out[i, c] = beam.table[2 * step + i, c]
        out[i, 0] += e + u * (rate + 0.5 * u * angular)
        out[i, 2] += change
