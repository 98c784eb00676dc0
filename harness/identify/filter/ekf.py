"""Innovations of a model with effects: an extended Kalman filter on the ball's state, compiled.

The state is (s, ṡ), joined by what slipping or Dahl friction remember and by a lagging sensor's reading where they act.
White process noise on ṡ stands for the beam angle's error: a free run of a double integrator would blame the model for
it. Innovations of a right model are white (Kailath, IEEE Trans. Automatic Control 13, 1968); readings that lie more
than four standard deviations off lose weight (Masreliez and Martin, IEEE TAC 22, 1977).

An innovation e of variance S = H P Hᵀ + R beyond four standard deviations moves the state by the share
w = 4 √S/|e| of what it otherwise would, and takes the same share off the covariance: P − w P Hᵀ H P/S. That is the
ordinary update by a reading of the larger variance R' = S/w − H P Hᵀ = R + S (1/w − 1) >= R, hence never indefinite.
Computed as a difference it may still round to less than nothing, so the covariance is never stored: both forms of the
filter propagate factors of it, from which every variance is a sum of squares (Bierman, "Factorization Methods for
Discrete Sequential Estimation", 1977).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.motion import FloatArray
from analytic.slots import DAHL, TRACTION
from analytic.step import advance

SPIKE = 4.0
# Prior of the first state: position as read, velocity within 0.1 m/s; least steps of the Jacobian's differences.
_VELOCITY_VARIANCE = 1e-2
_NUDGE = np.array([1e-6, 1e-5, 1e-5, 1e-6])


class Readings(NamedTuple):
    """Stamps, strictly increasing [s], and positions as read, NaN where there is none [m]; shape (n,) each."""

    time: FloatArray
    position: FloatArray


class BeamTable(NamedTuple):
    """Integration steps and the beam's motion over them (`analytic.kernel.Grid`).

    Attributes:
        steps: step sizes, shape (m,) [s].
        marks: index of the step that begins at each stamp, shape (n,).
        table: α, α̇, α̈ at the start, middle and end of every step, and what a spline term adds; shape (2 m + 1, 3 or 4).
    """

    steps: FloatArray
    marks: NDArray[np.int64]
    table: FloatArray


class Sensor(NamedTuple):
    """Recorded over true position [1], time constant, 0 for none [s], and variance of a reading [m²]."""

    gain: float
    lag: float
    reading_variance: float


class FilterOutput(NamedTuple):
    """What the filter makes of n readings.

    Attributes:
        innovation: reading − prediction, 0 where there is no reading, shape (n,) [m].
        innovation_variance: its variance, 1 where there is no reading, shape (n,) [m²].
        state: filtered s [m], ṡ [m/s], what effects remember, and the lagging position [m], shape (n, 4).
        position_variance: variance of the position that the sensor sees, shape (n,) [m²].
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
        p: kernel vector with effects.
        sensor: of the position.
        process_noise: density of the white noise on ṡ [m²/s³].
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
    """The filter where the state is (s, ṡ).

    Its covariance is a (1, m)ᵀ(1, m) + d (0, 1)ᵀ(0, 1): variance of s, regression of ṡ on s, and what then remains of
    the variance of ṡ. A reading of s says nothing of m and d, and with R' and S' as above it takes a to a R'/S'.
    Over a step of the Jacobian (f g; h i), process noise q and length Δt the covariance becomes a sum of three dyads,

        a (f + g m, h + i m), d (g, i), q Δt³/3 (1, κ), κ = 3/(2 Δt), and q Δt/4 in the variance of ṡ,

    and what remains of a sum of dyads w_j (x_j, y_j) beside its regression is Σ w_i w_j (x_i y_j − x_j y_i)²/Σ w_j x_j²
    over the pairs: nothing is subtracted but within squares.
    """
    time, position = readings.time, readings.position
    steps, marks, table = beam.steps, beam.marks, beam.table
    gain, reading_variance = sensor.gain, sensor.reading_variance
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
                e, S = position[k] - gain * s, gain * gain * a + reading_variance
                out.innovation[k], out.innovation_variance[k] = e, S
                S_weighted, R_weighted = _weighted(e, S, reading_variance)
                correction = gain * a / S_weighted * e
                s += correction
                v += m * correction
                a *= R_weighted / S_weighted
            else:
                s, v, a, m, d = position[k] / gain, 0.0, reading_variance / gain**2, 0.0, _VELOCITY_VARIANCE
                begun = True
        out.state[k, 0], out.state[k, 1], out.state[k, 2], out.state[k, 3] = s, v, 0.0, s
        out.position_variance[k] = a


@njit(cache=True, nogil=True)
def _any_state(
    readings: Readings, beam: BeamTable, p: FloatArray, sensor: Sensor, process_noise: float, out: FilterOutput
) -> None:
    """The filter for any state; the slow twin of `_two_states`.

    Its covariance is L Lᵀ with a triangular L, whose first row is the position that the sensor sees: a reading then
    takes the first column of L to √(R'/S') of itself and leaves the others as they are.
    """
    time, position = readings.time, readings.position
    gain, lag, reading_variance = sensor.gain, sensor.lag, sensor.reading_variance
    slips = p[TRACTION] != 0.0
    states = np.array([3, 0, 1, 2])[0 if lag > 0.0 else 1 : 4 if slips or p[DAHL] != 0.0 else 3]  # as L has them
    seen, size = states[0], len(states)
    x, moved, nudged = np.zeros(4), np.zeros(4), np.zeros(4)
    F, L, M = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size + 2))
    begun = False
    for k in range(len(time)):
        if begun:
            dt = time[k] - time[k - 1]
            moved[:] = x
            _over(moved, beam.marks[k - 1], beam.marks[k], beam, p, lag)
            for j in range(size):
                one = states[j]
                by_velocity = one == 1 or (one == 2 and slips)
                nudge = _velocity_nudge(x[one], _square(L, j)) if by_velocity else _NUDGE[one]
                nudged[:] = x
                nudged[one] += nudge
                _over(nudged, beam.marks[k - 1], beam.marks[k], beam, p, lag)
                for i in range(size):
                    F[i, j] = (nudged[states[i]] - moved[states[i]]) / nudge
            x[:] = moved
            for i in range(size):
                # What pulls at a ball that slides changes its slip as it does its velocity.
                driven = states[i] == 1 or (states[i] == 2 and slips and moved[2] != 0.0)
                root = math.sqrt(process_noise * dt)
                M[i, size] = root * (dt / math.sqrt(3.0) if states[i] == 0 else math.sqrt(0.75) * driven)
                M[i, size + 1] = 0.5 * root * driven
            _propagate(F, L, M)
        if not math.isnan(position[k]):
            if begun:
                e, S = position[k] - gain * x[seen], gain * gain * L[0, 0] ** 2 + reading_variance
                out.innovation[k], out.innovation_variance[k] = e, S
                S_weighted, R_weighted = _weighted(e, S, reading_variance)
                correction, shrink = gain * L[0, 0] / S_weighted * e, math.sqrt(R_weighted / S_weighted)
                for i in range(size):
                    x[states[i]] += L[i, 0] * correction
                    L[i, 0] *= shrink
            else:
                x[0] = x[3] = position[k] / gain
                for i in range(size):
                    if states[i] == 1:
                        L[i, i] = math.sqrt(_VELOCITY_VARIANCE)
                    elif states[i] != 2:
                        L[i, 0] = math.sqrt(reading_variance) / gain
                begun = True
        out.state[k], out.position_variance[k] = x, L[0, 0] ** 2


@njit(cache=True, inline="always")
def _weighted(e: float, S: float, reading_variance: float) -> tuple[float, float]:
    """Variances of innovation and reading, S' = S/w and R' = R + S (1/w − 1), by which an innovation e counts [m²]."""
    looser = max(1.0, abs(e) / (SPIKE * math.sqrt(S)))
    return S * looser, reading_variance + S * (looser - 1.0)


@njit(cache=True, inline="always")
def _velocity_nudge(v: float, variance: float) -> float:
    """Step of the slope by velocity: a standard deviation in the direction of motion [m/s].

    Dry friction stops the ball of the filter, and an infinitesimal slope would then be certain that the true one rests
    there as well, although within its standard deviation it rolls on. Differences over the standard deviation know that
    (Schei, Automatica 33, 1997).
    """
    return math.copysign(max(_NUDGE[1], math.sqrt(variance)), v)


@njit(cache=True, inline="always")
def _over(x: FloatArray, first: int, last: int, beam: BeamTable, p: FloatArray, lag: float) -> None:
    """Take the state over the integration steps from `first` to `last`, in place."""
    s, v, w, y = x[0], x[1], x[2], x[3]
    for j in range(first, last):
        before, h = s, beam.steps[j]
        s, v, w = advance(s, v, w, h, beam.table, 2 * j, p)
        if lag > 0.0:  # T ẏ + y = s, exact for an s that moves evenly within the step
            slope = (s - before) / h
            follow = before - slope * lag
            y = follow + slope * h + (y - follow) * math.exp(-h / lag)
    x[0], x[1], x[2], x[3] = s, v, w, y


@njit(cache=True, inline="always")
def _square(L: FloatArray, i: int) -> float:
    """(L Lᵀ)_ii."""
    total = 0.0
    for j in range(i + 1):
        total += L[i, j] ** 2
    return total


@njit(cache=True)
def _propagate(F: FloatArray, L: FloatArray, M: FloatArray) -> None:
    """L, shape (m, m), becomes the triangular root of F L (F L)ᵀ and the process noise.

    By modified Gram–Schmidt on the rows of (F L, N), where N, shape (m, 2), is a root of the process noise.

    Args:
        F: Jacobian of the step, shape (m, m).
        M: N in its last two columns, shape (m, m + 2); room for the rows, which are lost.
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
    """ρ of innovations over their standard deviations: squares up to 4, then linear (Huber), same shape."""
    far = np.abs(ratio)
    return np.where(far < SPIKE, far**2, 2.0 * SPIKE * far - SPIKE**2)


def negative_two_log_likelihood(innovation: FloatArray, innovation_variance: FloatArray | float) -> float:
    """−2 log likelihood of innovations, shape (n,) [m], of these variances [m²], but for a constant; by `penalty`."""
    ratio = innovation / np.sqrt(innovation_variance)
    return float(np.sum(np.log(innovation_variance) + penalty(ratio)))
