"""Prediction errors of a model with effects: an extended Kalman filter on the ball's state, compiled.

The state is (s, ṡ), joined by what slipping or Dahl friction remember and by a lagging sensor's reading where they act.
White process noise on ṡ stands for the beam angle's error: a free run of a double integrator would blame the model for
it. Innovations of a right model are white (Kailath, IEEE Trans. Automatic Control 13, 1968); steps that miss by more
than four standard deviations lose weight (Masreliez and Martin, IEEE TAC 22, 1977).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.models import DAHL, TRACTION
from analytic.motion import FloatArray
from analytic.step import advance

SPIKE = 4.0
# Prior of the first state: position as read, velocity within 0.1 m/s; least steps of the Jacobian's differences.
_VELOCITY_VARIANCE = 1e-2
_NUDGE = np.array([1e-6, 1e-5, 1e-5, 1e-6])


@njit(cache=True, nogil=True)
def _plain(
    time: FloatArray,
    reading: FloatArray,
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    p: FloatArray,
    gain: float,
    density: float,
    noise: float,
    miss: FloatArray,
    spread: FloatArray,
    state: FloatArray,
    doubt: FloatArray,
) -> None:
    """`innovations` where the state is (s, ṡ): its covariance is (a b; b c)."""
    s = v = a = b = c = 0.0
    begun = False
    for k in range(len(time)):
        if begun:
            dt = time[k] - time[k - 1]
            nudge = _faster(v, c)
            s1, v1, s2, v2 = s + _NUDGE[0], v, s, v + nudge
            for j in range(marks[k - 1], marks[k]):
                s1, v1, _ = advance(s1, v1, 0.0, steps[j], table, 2 * j, p)
                s2, v2, _ = advance(s2, v2, 0.0, steps[j], table, 2 * j, p)
                s, v, _ = advance(s, v, 0.0, steps[j], table, 2 * j, p)
            f, g = (s1 - s) / _NUDGE[0], (s2 - s) / nudge
            h, i = (v1 - v) / _NUDGE[0], (v2 - v) / nudge
            fa, fb, ha, hb = f * a + g * b, f * b + g * c, h * a + i * b, h * b + i * c
            a = f * fa + g * fb + density * dt**3 / 3.0
            b = h * fa + i * fb + density * dt**2 / 2.0
            c = h * ha + i * hb + density * dt
        miss[k], spread[k] = 0.0, 1.0
        state[k, 0], state[k, 1], state[k, 2], state[k, 3], doubt[k] = s, v, 0.0, s, a
        if math.isnan(reading[k]):
            continue
        if not begun:
            s, v, a, b, c = reading[k] / gain, 0.0, noise / gain**2, 0.0, _VELOCITY_VARIANCE
            begun = True
            state[k, 0], state[k, 1], state[k, 3], doubt[k] = s, v, s, a
            continue
        S = gain * gain * a + noise
        e = reading[k] - gain * s
        miss[k], spread[k] = e, S
        weight = min(1.0, SPIKE * math.sqrt(S) / max(abs(e), 1e-300))
        x, y = weight * gain * a / S, weight * gain * b / S
        s += x * e
        v += y * e
        c -= y * gain * b
        b -= x * gain * b
        a -= x * gain * a
        state[k, 0], state[k, 1], state[k, 3], doubt[k] = s, v, s, a


@njit(cache=True, nogil=True)
def _general(
    time: FloatArray,
    reading: FloatArray,
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    p: FloatArray,
    gain: float,
    lag: float,
    density: float,
    noise: float,
    miss: FloatArray,
    spread: FloatArray,
    state: FloatArray,
    doubt: FloatArray,
) -> None:
    """`innovations` for any state; the slow twin of `_plain`."""
    remembers = p[TRACTION] != 0.0 or p[DAHL] != 0.0
    active = np.array([True, True, remembers, lag > 0.0])
    x, P, F, Q = np.zeros(4), np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4))
    moved, nudged, column, half = np.zeros(4), np.zeros(4), np.zeros(4), np.zeros((4, 4))
    begun = False
    for k in range(len(time)):
        if begun:
            dt = time[k] - time[k - 1]
            moved[:] = x
            _over(moved, marks[k - 1], marks[k], steps, table, p, lag)
            for j in range(4):
                if active[j]:
                    nudge = _faster(x[j], P[j, j]) if j == 1 or (j == 2 and p[TRACTION] != 0.0) else _NUDGE[j]
                    nudged[:] = x
                    nudged[j] += nudge
                    _over(nudged, marks[k - 1], marks[k], steps, table, p, lag)
                    for i in range(4):
                        F[i, j] = (nudged[i] - moved[i]) / nudge if active[i] else 0.0
            Q[0, 0], Q[1, 1] = density * dt**3 / 3.0, density * dt
            Q[0, 1] = Q[1, 0] = density * dt**2 / 2.0
            # What pulls at a ball that slides changes its slip as it does its velocity.
            slides = 1.0 if p[TRACTION] != 0.0 and moved[2] != 0.0 else 0.0
            Q[2, 2] = Q[1, 2] = Q[2, 1] = slides * Q[1, 1]
            Q[0, 2] = Q[2, 0] = slides * Q[0, 1]
            x[:] = moved
            _sandwich(F, P, Q, active, half)
        miss[k], spread[k] = 0.0, 1.0
        seen = 3 if lag > 0.0 else 0
        state[k], doubt[k] = x, P[seen, seen]
        if math.isnan(reading[k]):
            continue
        if not begun:
            x[0] = x[3] = reading[k] / gain
            P[0, 0] = noise / gain**2
            P[1, 1] = _VELOCITY_VARIANCE
            if lag > 0.0:
                P[3, 3] = P[0, 3] = P[3, 0] = P[0, 0]
            begun = True
            state[k], doubt[k] = x, P[seen, seen]
            continue
        S = gain * gain * P[seen, seen] + noise
        e = reading[k] - gain * x[seen]
        miss[k], spread[k] = e, S
        weight = min(1.0, SPIKE * math.sqrt(S) / max(abs(e), 1e-300))
        for i in range(4):
            column[i] = gain * P[i, seen]
        for i in range(4):
            if active[i]:
                x[i] += weight * column[i] / S * e
                for j in range(4):
                    P[i, j] -= weight * column[i] * column[j] / S
        state[k], doubt[k] = x, P[seen, seen]


@njit(cache=True, inline="always")
def _faster(v: float, variance: float) -> float:
    """Step of the slope by velocity: a standard deviation in the direction of motion [m/s].

    Dry friction stops the ball of the filter, and an infinitesimal slope would then be certain that the true one rests
    there as well, although within its standard deviation it rolls on. Differences over the standard deviation know that
    (Schei, Automatica 33, 1997).
    """
    return math.copysign(max(_NUDGE[1], math.sqrt(max(variance, 0.0))), v)


@njit(cache=True, inline="always")
def _over(
    x: FloatArray, first: int, last: int, steps: FloatArray, table: FloatArray, p: FloatArray, lag: float
) -> None:
    """Take the state over the integration steps from `first` to `last`, in place."""
    s, v, w, y = x[0], x[1], x[2], x[3]
    for j in range(first, last):
        before = s
        s, v, w = advance(s, v, w, steps[j], table, 2 * j, p)
        if lag > 0.0:  # T ẏ + y = s, exact for an s that moves evenly within the step
            slope = (s - before) / steps[j]
            follow = before - slope * lag
            y = follow + slope * steps[j] + (y - follow) * math.exp(-steps[j] / lag)
    x[0], x[1], x[2], x[3] = s, v, w, y


@njit(cache=True)
def _sandwich(F: FloatArray, P: FloatArray, Q: FloatArray, active: NDArray[np.bool_], half: FloatArray) -> None:
    """P becomes F P Fᵀ + Q, over the active states; `half` is room for F P."""
    for i in range(4):
        for j in range(4):
            half[i, j] = 0.0
            if active[i] and active[j]:
                for a in range(4):
                    half[i, j] += F[i, a] * P[a, j]
    for i in range(4):
        for j in range(4):
            total = 0.0
            if active[i] and active[j]:
                for a in range(4):
                    total += half[i, a] * F[j, a]
            P[i, j] = total + Q[i, j]


@njit(cache=True, nogil=True)
def innovations(
    time: FloatArray,
    reading: FloatArray,
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    p: FloatArray,
    gain: float,
    lag: float,
    density: float,
    noise: float,
    miss: FloatArray,
    spread: FloatArray,
    state: FloatArray,
    doubt: FloatArray,
) -> None:
    """Fill `miss`, reading − prediction [m], and `spread`, its variance [m²], both of shape (n,); and the filtered
    `state` (s, ṡ, w, y), shape (n, 4), and `doubt`, the variance of the position it would be read at [m²], shape (n,).

    Args:
        time: stamps, shape (n,) [s].
        reading: of the position, NaN where there is none, shape (n,) [m].
        steps, marks, table: integration grid and beam motion (`analytic.kernel.Grid`).
        p: kernel vector with effects.
        gain: recorded over true position [1].
        lag: time constant of the sensor [s]; 0 for none.
        density: of the process noise on ṡ [m²/s³].
        noise: variance of a reading [m²].
    """
    if p[TRACTION] == 0.0 and p[DAHL] == 0.0 and lag <= 0.0:
        _plain(time, reading, steps, marks, table, p, gain, density, noise, miss, spread, state, doubt)
    else:
        _general(time, reading, steps, marks, table, p, gain, lag, density, noise, miss, spread, state, doubt)


def penalty(ratio: FloatArray) -> FloatArray:
    """ρ of innovations over their standard deviations: squares up to 4, then linear (Huber), same shape."""
    far = np.abs(ratio)
    return np.where(far < SPIKE, far**2, 2.0 * SPIKE * far - SPIKE**2)
