"""The filter for any state: extended by slip or Dahl friction, a lagging beam or position, coloured sensor noise."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.law import has_dry_friction
from analytic.lean_step import path_of
from analytic.motion import FloatArray
from analytic.shared_step import ball_step, beam_step
from analytic.slots import DAHL, ECCENTRIC, TRACTION
from harness.identify.filter.arguments import (
    NUDGE,
    UNSTEADY,
    VELOCITY_VARIANCE,
    BeamTable,
    FilterOutput,
    Memory,
    Readings,
    Sensor,
    angle_nudge,
    lagging,
    lagging_noise,
    position_of,
    rate_noise,
    reading_of,
    shifted,
    velocity_nudge,
    weighted,
)
from harness.identify.filter.points import FIRST, REACH, SECOND, SHIFT, may_stop
from harness.signals.error_process import ErrorProcess
from harness.signals.triangular_roots import root_of, triangular

_ERROR = 4  # index of e in the state (s, ṡ, slip or Dahl friction, lagging s, e, ė, ë, what else e goes on from, c)


@njit(cache=True)
def any_state(
    readings: Readings,
    beam: BeamTable,
    p: FloatArray,
    sensor: Sensor,
    process_noise: float,
    error: ErrorProcess,
    points: bool,
    memory: Memory,
    first: int,
    local: FloatArray,
    out: FilterOutput,
) -> None:
    """Fill `out`; `local` is a workspace, shape (3, columns of the table), the rest as for `extended_kalman_filter`.

    The covariance is L Lᵀ with L lower triangular, its first row the (lagging) position that is read: a reading
    multiplies the first column of L by √(R'/S') and leaves the others unchanged. With coloured noise c, which is in the
    last row, a reading is h L x + noise with two entries in h, and L (I − β f fᵀ) with f = Lᵀ hᵀ and
    β = 1/(S' + √(R' S')) replaces L (Potter), made triangular again.

    The derivatives by ė and ë follow from that by e: over a step Δt, an error e + ė u + ½ ë u² adds to the velocity
    what e + ė Δt/2 + ë Δt²/6 does, to the position what e + ė Δt/3 + ë Δt²/12 does. The change of ė over the step adds
    −K ℓ times itself to the velocity.
    """
    p, beam, error, local, out = borrowed(p), borrowed(beam), borrowed(error), borrowed(local), borrowed(out)
    time, position = readings.time, readings.position
    lag, reading_variance = sensor.lag, sensor.reading_variance
    slips = p[TRACTION] != 0.0
    ball = np.array([3, 0, 1, 2])[0 if lag > 0.0 else 1 : 4 if slips or p[DAHL] != 0.0 else 3]  # in the order of L
    coloured = sensor.colour > 0.0
    few, wide, sources = len(ball), error.transition.shape[1], error.root.shape[2]
    colour = _ERROR + wide  # index of c
    size = few + wide + (1 if coloured else 0)
    states = np.append(ball, np.arange(_ERROR, _ERROR + size - few))
    sensed, last = states[0], size - 1
    x, mean, nudges, f = np.zeros(colour + 1), np.zeros(colour + 1), np.zeros(few + 1), np.zeros(size)
    # Where the ball is, and where it would be from a state that is a little off, one by one.
    balls = np.zeros((few + 2, colour + 1))
    moved, off = balls[0], balls[1:]
    beyond = np.zeros((2, 1, colour + 1))
    ahead, behind = beyond[0], beyond[1]
    path = path_of(p)
    bends = points and (slips or p[DAHL] != 0.0 or has_dry_friction(p))
    # Columns of the compound root: F L, process noise, then that of the error, of c and of a lagging sensor, bends.
    of_error = size + 2
    of_colour = of_error + sources
    of_lag = of_colour + (1 if coloured else 0)
    of_bend = of_lag + (1 if lag > 0.0 else 0)
    M = np.zeros((size, of_bend + (size + 1 if bends else 0)))
    F, L = np.zeros((size, size)), np.zeros((size, size))
    row_of_v = 2 if lag > 0.0 else 1
    L[:] = memory.root[:size, :size]
    x[:] = memory.x
    begun = memory.begun[0]
    for k in range(first, first + len(out.innovation)):
        if begun:
            dt = time[k] - time[k - 1]
            moved[:] = x
            for j in range(few + 1):
                index = states[j]
                if index == _ERROR:
                    nudges[j] = angle_nudge(_square(L, j))
                elif index == 1 or (index == 2 and slips):
                    nudges[j] = velocity_nudge(x[index], _square(L, j))
                else:
                    nudges[j] = NUDGE[index]
                off[j] = x
                off[j, index] += nudges[j]
            A, B = error.transition[k - 1], error.root[k - 1]
            change = _rate_change(A, x) / dt
            _over(balls[:-1], beam.marks[k - 1], beam.marks[k], beam, p, path, lag, change, local)
            _over(balls[few + 1 :], beam.marks[k - 1], beam.marks[k], beam, p, path, lag, change, local)  # other angle
            for j in range(few + 1):
                for i in range(few):
                    F[i, j] = (off[j, states[i]] - moved[states[i]]) / nudges[j]
            M[:, size:] = 0.0
            for i in range(few):
                of_position = states[i] == 0 or states[i] == 3
                F[i, few + 1] = F[i, few] * dt / (3.0 if of_position else 2.0)
                F[i, few + 2] = F[i, few] * dt * dt / (12.0 if of_position else 6.0)
                # A force on a sliding ball changes its slip as much as its velocity.
                driven = states[i] == 1 or (states[i] == 2 and slips and moved[2] != 0.0)
                root = math.sqrt(process_noise * dt)
                M[i, size] = root * (dt / math.sqrt(3.0) if states[i] == 0 else math.sqrt(0.75) * driven)
                M[i, size + 1] = 0.5 * root * driven
            if lag > 0.0:
                a, b, c = lagging_noise(dt, lag)
                root = math.sqrt(process_noise)
                M[0, size], M[0, size + 1], M[0, of_lag] = root * a, root * b, root * c
            for i in range(wide):
                moved[_ERROR + i] = 0.0
                for j in range(wide):
                    F[few + i, few + j] = A[i, j]
                    moved[_ERROR + i] += F[few + i, few + j] * x[_ERROR + j]
                for j in range(sources):
                    M[few + i, of_error + j] = B[i, j]
            if coloured:
                kept = math.exp(-dt / sensor.colour_time)
                F[last, last], moved[colour] = kept, kept * x[colour]
                M[last, of_colour] = math.sqrt(sensor.colour * (1.0 - kept * kept))
            _product(F, L, M)
            for i in range(few):
                # A ball that is held is not thrown, as it does not respond to the angle in F.
                if moved[1] != 0.0 and (states[i] <= 1 or (states[i] == 2 and slips and moved[2] != 0.0)):
                    back = -p[ECCENTRIC] * (0.5 * dt if states[i] == 0 else 1.0)
                    for j in range(size):
                        M[i, j] += back * (M[few + 1, j] - L[few + 1, j])
                    for j in range(sources):
                        M[i, of_error + j] += back * B[1, j]
            # slip begins and ends at any velocity
            if bends and not math.isnan(position[k]) and (slips or may_stop(x[1], moved[1], _square(L, row_of_v))):
                mean[:] = moved  # to be increased by second differences
                spread = rate_noise(B)
                for j in range(size + 1):
                    ahead[0] = x
                    behind[0] = x
                    noise = 0.0
                    if j < size:
                        for i in range(size):
                            ahead[0, states[i]] += REACH * L[i, j]
                            behind[0, states[i]] -= REACH * L[i, j]
                    else:
                        noise = REACH * spread
                    for side in range(2):
                        one = beyond[side]
                        change = (_rate_change(A, one[0]) + (noise if side == 0 else -noise)) / dt
                        _over(one, beam.marks[k - 1], beam.marks[k], beam, p, path, lag, change, local)
                    for i in range(few):
                        bend = ahead[0, states[i]] + behind[0, states[i]] - 2.0 * moved[states[i]]
                        by = FIRST * (ahead[0, states[i]] - behind[0, states[i]])
                        if j < size:
                            M[i, j] = by
                        else:
                            for c in range(sources):
                                M[i, of_error + c] = by * (B[1, c] / spread if spread > 0.0 else 0.0)
                        M[i, of_bend + j] = SECOND * bend
                        mean[states[i]] += SHIFT * bend
                moved[:] = mean
            x[:] = moved
            triangular(M, L)
        if not math.isnan(position[k]):
            if begun:
                expected, slope = reading_of(x[sensed], sensor, p)
                e, S = position[k] - expected - x[colour], reading_variance
                for j in range(size if coloured else 1):
                    f[j] = slope * L[0, j] + (L[last, j] if coloured else 0.0)
                    S += f[j] * f[j]
                out.innovation[k - first], out.innovation_variance[k - first] = e, S
                S_weighted, R_weighted = weighted(e, S, reading_variance)
                if coloured:
                    _read(x, states, L, M, f, e, S_weighted, R_weighted)
                else:
                    correction, shrink = f[0] / S_weighted * e, math.sqrt(R_weighted / S_weighted)
                    for i in range(size):
                        x[states[i]] += L[i, 0] * correction
                        L[i, 0] *= shrink
            else:
                x[0] = x[3] = position_of(position[k], sensor, p)
                _, slope = reading_of(x[0], sensor, p)
                L[row_of_v, row_of_v] = math.sqrt(VELOCITY_VARIANCE)
                for i in range(row_of_v):
                    L[i, 0] = math.sqrt(reading_variance + sensor.colour) / slope
                if lag > 0.0:  # after a motion at velocity v the sensor is T v behind
                    change = lag * UNSTEADY  # of v meanwhile
                    spread = math.sqrt(VELOCITY_VARIANCE + change**2)
                    L[1, 1] = lag * spread
                    L[2, 1] = VELOCITY_VARIANCE / spread
                    L[2, 2] = change * math.sqrt(VELOCITY_VARIANCE) / spread
                if coloured:  # what the first reading says of the ball is wrong by both kinds of noise
                    L[last, 0] = -sensor.colour / math.sqrt(reading_variance + sensor.colour)
                    L[last, last] = math.sqrt(sensor.colour * reading_variance / (reading_variance + sensor.colour))
                root_of(error.covariance[k], L, few)
                begun = True
        for i in range(4):
            out.state[k - first, i] = x[i]
        out.position_variance[k - first] = L[0, 0] ** 2
    memory.root[:size, :size] = L
    memory.x[:] = x
    memory.begun[0] = begun


@njit(cache=True, inline="always")
def _over(
    balls: FloatArray,
    first: int,
    last: int,
    beam: BeamTable,
    p: FloatArray,
    path: int,
    lag: float,
    change: float,
    local: FloatArray,
) -> None:
    """Integrate states over the steps from `first` to `last`, in place; all but the errors.

    Args:
        balls: states with the same errors, shape (m, any).
        change: of their ė until the next stamp, over the time to it [rad/s²].
        local: workspace, shape (3, 3 or 4).
    """
    since = 0.0
    for j in range(first, last):
        h = beam.steps[j]
        shifted(beam, j, since, balls[0, 4], balls[0, 5], balls[0, 6], change, local)
        since += h
        on = beam_step(path, local, 0, p)
        for i in range(len(balls)):
            before = balls[i, 0]
            s, v, w = ball_step(path, on, before, balls[i, 1], balls[i, 2], h, local, 0, p)
            if lag > 0.0:
                balls[i, 3] = lagging(balls[i, 3], before, s, h, lag)
            balls[i, 0], balls[i, 1], balls[i, 2] = s, v, w


@njit(cache=True, inline="always")
def _rate_change(A: FloatArray, x: FloatArray) -> float:
    """By how much the mean of ė changes over a step with the transition A of the error in the state x [rad/s]."""
    after = 0.0
    for i in range(len(A)):
        after += A[1, i] * x[_ERROR + i]
    return after - x[_ERROR + 1]


@njit(cache=True, inline="always")
def _square(L: FloatArray, i: int) -> float:
    """(L Lᵀ)_ii."""
    total = 0.0
    for j in range(i + 1):
        total += L[i, j] ** 2
    return total


@njit(cache=True)
def _read(
    x: FloatArray,
    states: NDArray[np.int64],
    L: FloatArray,
    M: FloatArray,
    f: FloatArray,
    e: float,
    S: float,
    R: float,
) -> None:
    """Correct the state x and L by an innovation e of variance S, with the reading variance R, in place.

    Args:
        states: indices of the rows of L in x, shape (m,).
        M: workspace, shape (m, n).
        f: Lᵀ hᵀ with the gradient h of the reading by the state, shape (m,).
    """
    size = len(L)
    shrink = 1.0 / (S + math.sqrt(R * S))
    M[:] = 0.0
    for i in range(size):
        gain = 0.0
        for j in range(i + 1):
            gain += L[i, j] * f[j]
        x[states[i]] += gain / S * e
        for j in range(size):
            M[i, j] = (L[i, j] if j <= i else 0.0) - shrink * gain * f[j]
    triangular(M, L)


@njit(cache=True)
def _product(F: FloatArray, L: FloatArray, M: FloatArray) -> None:
    """F L, shape (m, m), into the first columns of M; F has zeros, as the error does not depend on the ball."""
    size = len(L)
    M[:, :size] = 0.0
    for i in range(size):
        for c in range(size):
            factor = F[i, c]
            if factor != 0.0:
                for j in range(c + 1):
                    M[i, j] += factor * L[c, j]
