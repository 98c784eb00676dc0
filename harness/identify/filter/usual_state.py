"""The filter for the usual state: the ball's (s, ṡ) and the error (e, ė, ë) of the beam's angle."""

from __future__ import annotations

import math

import numpy as np

from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.law import acceleration, has_dry_friction
from analytic.lean_step import path_of
from analytic.motion import FloatArray
from analytic.shared_step import ball_step, beam_step
from analytic.slots import ECCENTRIC
from harness.identify.filter.arguments import (
    NUDGE,
    VELOCITY_VARIANCE,
    BeamTable,
    FilterOutput,
    Memory,
    Readings,
    Sensor,
    position_of,
    rate_change,
    reading_of,
    shifted,
    velocity_nudge,
    weighted,
)
from harness.identify.filter.points import may_stop, step_at_points
from harness.signals.error_process import ErrorProcess
from harness.signals.triangular_roots import root_of

_WIDTH = 10  # of the compound root: five states, two numbers of process noise, three of the error's


@njit(cache=True)
def usual_state(
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
    """As `any_state`, written out for this state; it takes a third of the time."""
    p, beam, error, here, out = borrowed(p), borrowed(beam), borrowed(error), borrowed(local), borrowed(out)
    time, position = readings.time, readings.position
    steps, marks = beam.steps, beam.marks
    reading_variance = sensor.reading_variance
    L, M, x = np.zeros((5, 5)), np.zeros((5, _WIDTH)), np.empty(5)
    path = path_of(p)
    dry = points and has_dry_friction(p)
    L[:] = memory.root[:5, :5]
    s, v, e0, e1, e2 = memory.x[0], memory.x[1], memory.x[2], memory.x[3], memory.x[4]
    begun = memory.begun[0]
    for k in range(first, first + len(out.innovation)):
        if begun:
            dt = time[k] - time[k - 1]
            A, B = error.transition[k - 1], error.root[k - 1]
            along = velocity_nudge(v, L[1, 0] ** 2 + L[1, 1] ** 2)
            s0, v0, s1, v1, s2, v2 = s, v, s + NUDGE[0], v, s, v + along
            change = rate_change(A, e0, e1, e2) / dt
            since = 0.0
            for j in range(marks[k - 1], marks[k]):
                shifted(beam, j, since, e0, e1, e2, change, here)
                h = steps[j]
                since += h
                on = beam_step(path, here, 0, p)
                s1, v1, _ = ball_step(path, on, s1, v1, 0.0, h, here, 0, p)
                s2, v2, _ = ball_step(path, on, s2, v2, 0.0, h, here, 0, p)
                s, v, _ = ball_step(path, on, s, v, 0.0, h, here, 0, p)
            root = math.sqrt(process_noise * dt)
            M[:, 5:] = 0.0
            M[0, 5], M[1, 5], M[1, 6] = root * dt / math.sqrt(3.0), root * math.sqrt(0.75), 0.5 * root
            for i in range(3):
                for c in range(5):
                    M[2 + i, c] = A[i, 0] * L[2, c] + A[i, 1] * L[3, c] + A[i, 2] * L[4, c]
                for c in range(3):
                    M[2 + i, 7 + c] = B[i, c]
            if dry and not math.isnan(position[k]) and may_stop(v0, v, L[1, 0] ** 2 + L[1, 1] ** 2):
                x[0], x[1], x[2], x[3], x[4] = s0, v0, e0, e1, e2
                s, v = step_at_points(x, s, v, L, M, A, B, dt, beam, marks[k - 1], marks[k], p, here)
            else:
                response = _response(s0, v0, beam.table[2 * marks[k - 1]], p)  # which hardly changes within the step
                by_s, by_v, by_e = (s1 - s) / NUDGE[0], (s2 - s) / along, 0.5 * response * dt * dt
                _compound(M, 0, L, by_s, by_v, by_e, dt / 3.0, dt * dt / 12.0)
                by_s, by_v, by_e = (v1 - v) / NUDGE[0], (v2 - v) / along, response * dt
                _compound(M, 1, L, by_s, by_v, by_e, dt / 2.0, dt * dt / 6.0)
                for c in range(_WIDTH):  # as a ball that rolls is thrown back, and as it responds to the angle
                    thrown = -p[ECCENTRIC] * (M[3, c] - (L[3, c] if c < 5 else 0.0))
                    M[0, c] += 0.5 * dt * thrown
                    M[1, c] += thrown
            _triangular(M, L)
            e0, e1, e2 = (
                A[0, 0] * e0 + A[0, 1] * e1 + A[0, 2] * e2,
                A[1, 0] * e0 + A[1, 1] * e1 + A[1, 2] * e2,
                A[2, 0] * e0 + A[2, 1] * e1 + A[2, 2] * e2,
            )
        if not math.isnan(position[k]):
            if begun:
                expected, slope = reading_of(s, sensor, p)
                e, S = position[k] - expected, slope * slope * L[0, 0] ** 2 + reading_variance
                out.innovation[k - first], out.innovation_variance[k - first] = e, S
                S_weighted, R_weighted = weighted(e, S, reading_variance)
                correction, shrink = slope * L[0, 0] / S_weighted * e, math.sqrt(R_weighted / S_weighted)
                s += L[0, 0] * correction
                v += L[1, 0] * correction
                e0 += L[2, 0] * correction
                e1 += L[3, 0] * correction
                e2 += L[4, 0] * correction
                for i in range(5):
                    L[i, 0] *= shrink
            else:
                s = position_of(position[k], sensor, p)
                _, slope = reading_of(s, sensor, p)
                L[0, 0], L[1, 1] = math.sqrt(reading_variance) / slope, math.sqrt(VELOCITY_VARIANCE)
                root_of(error.covariance[k], L, 2)
                begun = True
        known = out.state[k - first]
        known[0], known[1], known[2], known[3] = s, v, 0.0, s
        out.position_variance[k - first] = L[0, 0] ** 2
    memory.root[:5, :5] = L
    memory.x[0], memory.x[1], memory.x[2], memory.x[3], memory.x[4] = s, v, e0, e1, e2
    memory.begun[0] = begun


@njit(cache=True, inline="always")
def _response(s: float, v: float, row: FloatArray, p: FloatArray) -> float:
    """Derivative of the smooth acceleration by the angle [m/s² per rad]; `row` of the beam's table."""
    more = acceleration(s, v, row[0] + NUDGE[4], row[1], row[2], p)
    return (more - acceleration(s, v, row[0], row[1], row[2], p)) / NUDGE[4]


@njit(cache=True, inline="always")
def _compound(
    M: FloatArray, row: int, L: FloatArray, by_s: float, by_v: float, by_e: float, t: float, u: float
) -> None:
    """A row of F L for s or ṡ, from its derivatives by s, ṡ and e; those by ė and ë are t and u times that by e."""
    by_rate, by_angular = by_e * t, by_e * u
    M[row, 0] = by_s * L[0, 0] + by_v * L[1, 0] + by_e * L[2, 0] + by_rate * L[3, 0] + by_angular * L[4, 0]
    M[row, 1] = by_v * L[1, 1] + by_e * L[2, 1] + by_rate * L[3, 1] + by_angular * L[4, 1]
    M[row, 2] = by_e * L[2, 2] + by_rate * L[3, 2] + by_angular * L[4, 2]
    M[row, 3] = by_rate * L[3, 3] + by_angular * L[4, 3]
    M[row, 4] = by_angular * L[4, 4]


@njit(cache=True, inline="always")
def _product(M: FloatArray, i: int, j: int) -> float:
    """Product of two rows; summed in pairs, which a processor does side by side."""
    return (
        ((M[i, 0] * M[j, 0] + M[i, 1] * M[j, 1]) + (M[i, 2] * M[j, 2] + M[i, 3] * M[j, 3]))
        + ((M[i, 4] * M[j, 4] + M[i, 5] * M[j, 5]) + (M[i, 6] * M[j, 6] + M[i, 7] * M[j, 7]))
        + (M[i, 8] * M[j, 8] + M[i, 9] * M[j, 9])
    )


@njit(cache=True, inline="always")
def _triangular(M: FloatArray, L: FloatArray) -> None:
    """L ← triangular root of M Mᵀ, shape (5, 5), by modified Gram–Schmidt; M, shape (5, 10), is overwritten."""
    for j in range(5):
        square = _product(M, j, j)
        L[j, j] = math.sqrt(square)
        inverse = 1.0 / square if square > 0.0 else 0.0
        for i in range(j + 1, 5):
            share = _product(M, i, j) * inverse
            L[i, j] = share * L[j, j]
            for c in range(_WIDTH):
                M[i, c] -= share * M[j, c]
