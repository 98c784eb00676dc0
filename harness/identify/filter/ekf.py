"""Innovations of a model with effects: an extended Kalman filter on the ball's state, compiled.

The state is (s, ṡ), extended by the internal state of slip or Dahl friction and by the output of a lagging sensor.
White process noise on ṡ represents the error of the beam angle, which a free run would attribute to the model.
Innovations of a complete model are white (Kailath, IEEE Trans. Automatic Control 13, 1968); those beyond four standard
deviations are down-weighted (Masreliez and Martin, IEEE TAC 22, 1977).

An innovation e with innovation variance S = H P Hᵀ + R and |e| > 4 √S has the weight w = 4 √S/|e|: the correction of
the state and the reduction of the covariance, P − w P Hᵀ H P/S, are w times the usual ones. This is the usual update
with the larger reading variance R' = S/w − H P Hᵀ = R + S (1/w − 1) >= R, so P stays positive semidefinite. To keep
this in floating point, both forms of the filter propagate factors of P, in which every variance is a sum of squares
(Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.effects.sensor_law import lies, measured
from analytic.motion import FloatArray
from analytic.slots import DAHL, TRACTION
from analytic.step import advance

SPIKE = 4.0  # normalised innovation beyond which readings are down-weighted
_VELOCITY_VARIANCE = 1e-2  # of the first state, at rest with standard deviation 0.1 m/s [m²/s²]
_NUDGE = np.array([1e-6, 1e-5, 1e-5, 1e-6])  # smallest steps of the Jacobian's finite differences, in units of state


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

    It measures h(s) = gain (s + square s² + cube s³).
    """

    gain: float
    lag: float
    reading_variance: float
    square: float = 0.0
    cube: float = 0.0


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


@njit(cache=True, nogil=True)
def extended_kalman_filter(
    readings: Readings, beam: BeamTable, p: FloatArray, sensor: Sensor, process_noise: float
) -> FilterOutput:
    """Innovations, states and their variances of one recording.

    Args:
        readings: of the position.
        beam: its motion on the integration grid.
        p: kernel's vector with effects, shape (SLOTS,) or longer where force laws follow.
        sensor: of the position.
        process_noise: density of the process noise [m²/s³].
    """
    n = len(readings.time)
    out = FilterOutput(np.zeros(n), np.ones(n), np.empty((n, 4)), np.empty(n))
    if p[TRACTION] == 0.0 and p[DAHL] == 0.0 and sensor.lag <= 0.0:
        _two_states(readings, beam, p, sensor, process_noise, out)
    else:
        _any_state(readings, beam, p, sensor, process_noise, out)
    return out


@njit(cache=True, nogil=True)
def _two_states(
    readings: Readings, beam: BeamTable, p: FloatArray, sensor: Sensor, process_noise: float, out: FilterOutput
) -> None:
    """The filter with the state (s, ṡ).

    The covariance is factored as a (1, m)ᵀ(1, m) + d (0, 1)ᵀ(0, 1): variance a of s, regression m of ṡ on s, residual
    variance d of ṡ. A reading of s leaves m and d unchanged and, with R' and S' = S/w, changes a to a R'/S'.
    A step of length Δt with Jacobian (f g; h i) and process noise q turns the covariance into a sum of three dyads,

        a (f + g m, h + i m), d (g, i), q Δt³/3 (1, κ), κ = 3/(2 Δt), and q Δt/4 in the variance of ṡ.

    The residual variance of a sum of dyads w_j (x_j, y_j) is Σ w_i w_j (x_i y_j − x_j y_i)²/Σ w_j x_j² over the pairs:
    differences occur only within squares.
    """
    time, position = readings.time, readings.position
    steps, marks, table = beam.steps, beam.marks, beam.table
    reading_variance = sensor.reading_variance
    s = v = a = m = d = 0.0
    begun = False
    for k in range(len(time)):
        if begun:
            dt = time[k] - time[k - 1]
            nudge = _velocity_nudge(v, m * m * a + d)
            s1, v1, s2, v2 = s + _NUDGE[0], v, s, v + nudge
            for j in range(marks[k - 1], marks[k]):
                s1, v1, _ = advance(s1, v1, 0.0, steps[j], table, 2 * j, p)
                s2, v2, _ = advance(s2, v2, 0.0, steps[j], table, 2 * j, p)
                s, v, _ = advance(s, v, 0.0, steps[j], table, 2 * j, p)
            f, g = (s1 - s) / _NUDGE[0], (s2 - s) / nudge
            h, i = (v1 - v) / _NUDGE[0], (v2 - v) / nudge
            x, y, q, kappa = f + g * m, h + i * m, process_noise * dt**3 / 3.0, 1.5 / dt
            before, a = a, a * x * x + d * g * g + q
            pairs = before * (d * (f * i - h * g) ** 2 + q * (x * kappa - y) ** 2) + d * q * (g * kappa - i) ** 2
            m = (before * x * y + d * g * i + q * kappa) / a
            d = pairs / a + 0.25 * process_noise * dt
        if not math.isnan(position[k]):
            if begun:
                expected, slope = measured(s, sensor.gain, sensor.square, sensor.cube)
                e, S = position[k] - expected, slope * slope * a + reading_variance
                out.innovation[k], out.innovation_variance[k] = e, S
                S_weighted, R_weighted = _weighted(e, S, reading_variance)
                correction = slope * a / S_weighted * e
                s += correction
                v += m * correction
                a *= R_weighted / S_weighted
            else:
                s = lies(position[k], sensor.gain, sensor.square, sensor.cube)
                _, slope = measured(s, sensor.gain, sensor.square, sensor.cube)
                v, a, m, d = 0.0, reading_variance / slope**2, 0.0, _VELOCITY_VARIANCE
                begun = True
        out.state[k, 0], out.state[k, 1], out.state[k, 2], out.state[k, 3] = s, v, 0.0, s
        out.position_variance[k] = a


@njit(cache=True, nogil=True)
def _any_state(
    readings: Readings, beam: BeamTable, p: FloatArray, sensor: Sensor, process_noise: float, out: FilterOutput
) -> None:
    """The filter for any state; slower than `_two_states`.

    The covariance is L Lᵀ with L lower triangular, its first row the (lagging) position that is read: a reading
    multiplies the first column of L by √(R'/S') and leaves the others unchanged.
    """
    time, position = readings.time, readings.position
    lag, reading_variance = sensor.lag, sensor.reading_variance
    slips = p[TRACTION] != 0.0
    states = np.array([3, 0, 1, 2])[0 if lag > 0.0 else 1 : 4 if slips or p[DAHL] != 0.0 else 3]  # in the order of L
    sensed, size = states[0], len(states)
    x, moved, nudged = np.zeros(4), np.zeros(4), np.zeros(4)
    F, L, M = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size + 2))
    begun = False
    for k in range(len(time)):
        if begun:
            dt = time[k] - time[k - 1]
            moved[:] = x
            _over(moved, beam.marks[k - 1], beam.marks[k], beam, p, lag)
            for j in range(size):
                index = states[j]
                is_velocity = index == 1 or (index == 2 and slips)
                nudge = _velocity_nudge(x[index], _square(L, j)) if is_velocity else _NUDGE[index]
                nudged[:] = x
                nudged[index] += nudge
                _over(nudged, beam.marks[k - 1], beam.marks[k], beam, p, lag)
                for i in range(size):
                    F[i, j] = (nudged[states[i]] - moved[states[i]]) / nudge
            x[:] = moved
            for i in range(size):
                # A force on a sliding ball changes its slip as much as its velocity.
                driven = states[i] == 1 or (states[i] == 2 and slips and moved[2] != 0.0)
                root = math.sqrt(process_noise * dt)
                M[i, size] = root * (dt / math.sqrt(3.0) if states[i] == 0 else math.sqrt(0.75) * driven)
                M[i, size + 1] = 0.5 * root * driven
            _propagate(F, L, M)
        if not math.isnan(position[k]):
            if begun:
                expected, slope = measured(x[sensed], sensor.gain, sensor.square, sensor.cube)
                e, S = position[k] - expected, slope * slope * L[0, 0] ** 2 + reading_variance
                out.innovation[k], out.innovation_variance[k] = e, S
                S_weighted, R_weighted = _weighted(e, S, reading_variance)
                correction, shrink = slope * L[0, 0] / S_weighted * e, math.sqrt(R_weighted / S_weighted)
                for i in range(size):
                    x[states[i]] += L[i, 0] * correction
                    L[i, 0] *= shrink
            else:
                x[0] = x[3] = lies(position[k], sensor.gain, sensor.square, sensor.cube)
                _, slope = measured(x[0], sensor.gain, sensor.square, sensor.cube)
                for i in range(size):
                    if states[i] == 1:
                        L[i, i] = math.sqrt(_VELOCITY_VARIANCE)
                    elif states[i] != 2:
                        L[i, 0] = math.sqrt(reading_variance) / slope
                begun = True
        out.state[k], out.position_variance[k] = x, L[0, 0] ** 2


@njit(cache=True, inline="always")
def _weighted(e: float, S: float, reading_variance: float) -> tuple[float, float]:
    """Innovation and reading variance that down-weight an innovation e: S' = S/w and R' = R + S (1/w − 1) [m²]."""
    inverse_weight = max(1.0, abs(e) / (SPIKE * math.sqrt(S)))
    return S * inverse_weight, reading_variance + S * (inverse_weight - 1.0)


@njit(cache=True, inline="always")
def _velocity_nudge(v: float, variance: float) -> float:
    """Step of the finite difference in velocity: a standard deviation in the direction of motion [m/s].

    Where dry friction stops the ball, the derivative by velocity vanishes, and so would the variance, although within
    a standard deviation the ball rolls on. Differences over a standard deviation avoid this (Schei, Automatica 33,
    1997).
    """
    return math.copysign(max(_NUDGE[1], math.sqrt(variance)), v)


@njit(cache=True, inline="always")
def _over(x: FloatArray, first: int, last: int, beam: BeamTable, p: FloatArray, lag: float) -> None:
    """Integrate the state x, shape (4,), over the steps from `first` to `last`, in place."""
    s, v, w, y = x[0], x[1], x[2], x[3]
    for j in range(first, last):
        before, h = s, beam.steps[j]
        s, v, w = advance(s, v, w, h, beam.table, 2 * j, p)
        if lag > 0.0:
            y = lagging(y, before, s, h, lag)
    x[0], x[1], x[2], x[3] = s, v, w, y


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


@njit(cache=True, inline="always")
def _square(L: FloatArray, i: int) -> float:
    """(L Lᵀ)_ii."""
    total = 0.0
    for j in range(i + 1):
        total += L[i, j] ** 2
    return total


@njit(cache=True)
def _propagate(F: FloatArray, L: FloatArray, M: FloatArray) -> None:
    """Replace L, shape (m, m), by the triangular root of F L (F L)ᵀ + N Nᵀ.

    By modified Gram–Schmidt on the rows of (F L, N), where N, shape (m, 2), is a root of the process noise covariance.

    Args:
        F: Jacobian of the step, shape (m, m).
        M: N in its last two columns, shape (m, m + 2); overwritten.
    """
    size = len(L)
    for i in range(size):
        for j in range(size):
            M[i, j] = 0.0
            for c in range(j, size):
                M[i, j] += F[i, c] * L[c, j]
    for i in range(size):
        for j in range(i):
            L[i, j] = 0.0
            for c in range(size + 2):
                L[i, j] += M[i, c] * M[j, c]
            for c in range(size + 2):
                M[i, c] -= L[i, j] * M[j, c]
        square = 0.0
        for c in range(size + 2):
            square += M[i, c] ** 2
        L[i, i] = math.sqrt(square)
        inverse = 1.0 / L[i, i] if square > 0.0 else 0.0
        for c in range(size + 2):
            M[i, c] *= inverse


def penalty(ratio: FloatArray) -> FloatArray:
    """Robust penalty ρ of normalised innovations: squares up to 4, then linear (Huber), same shape."""
    size = np.abs(ratio)
    return np.where(size < SPIKE, size**2, 2.0 * SPIKE * size - SPIKE**2)


def negative_two_log_likelihood(innovation: FloatArray, innovation_variance: FloatArray | float) -> float:
    """Deviance Σ [log S + ρ(e/√S)] of innovations e, shape (n,) [m], with variances S [m²]."""
    ratio = innovation / np.sqrt(innovation_variance)
    return float(np.sum(np.log(innovation_variance) + penalty(ratio)))
