"""Runs with nothing but the model's own terms, and with a plain dry friction, on paths of their own.

`analytic.step.advance` asks at every step which of all effects act, and computes sin(α + α₀) at every stage. Which of
them act does not change during a run, and the tilt depends on time alone unless the track bends: both are done here
once, with the same operations in the same order. Results are the same bit for bit (tests/analytic/test_lean.py).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic import slots
from analytic.compiled import njit
from analytic.motion import FloatArray

GENERAL, SMOOTH, DRY = 0, 1, 2
_LEAN = (  # slots that either path reads
    slots.GRAVITY,
    slots.CENTRIFUGAL,
    slots.ECCENTRIC,
    slots.LEVEL,
    slots.LINEAR,
    slots.FRICTION_GAIN,  # nothing without READING
    slots.TRANSITION,
    slots.RESPONSE,
    slots.HEIGHT,
    slots.WEIGHT,
    slots.PHASE,  # nothing without IMBALANCE or SHAPE
    slots.ORIGIN,
    slots.ROLL,
    slots.TURN,  # nothing without TRACTION
    slots.DRY_PLUS,
    slots.DRY_MINUS,
)
_ZERO = tuple(slot for slot in range(slots.SHAPE + 1) if slot not in _LEAN)


@njit(cache=True, nogil=True)
def path_of(p: FloatArray) -> int:
    """Which path takes a run with this parameter vector: `GENERAL`, `SMOOTH` or `DRY`."""
    if len(p) > slots.SLOTS:
        return GENERAL
    for slot in _ZERO:
        if p[slot] != 0.0:
            return GENERAL
    return SMOOTH if p[slots.DRY_PLUS] == 0.0 and p[slots.DRY_MINUS] == 0.0 else DRY


@njit(cache=True, nogil=True)
def tilts(table: FloatArray, begin: int, end: int, p: FloatArray, out: FloatArray) -> None:
    """Fill rows `begin` … `end` of `out`, shape (2 m + 1,), with sin(α + α₀), or α + α₀ in a linear model [1]."""
    level, linear = p[slots.LEVEL], p[slots.LINEAR] != 0.0
    for row in range(begin, end + 1):
        tilt = table[row, 0] + level
        out[row] = tilt if linear else np.sin(tilt)


@njit(cache=True, nogil=True, error_model="numpy")
def smooth_run(
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    tilted: FloatArray,
    p: FloatArray,
    first: int,
    last: int,
    out: FloatArray,
) -> None:
    """Integrate from stamp `first` to `last` on the path `SMOOTH`.

    Args:
        steps: shape (m,) [s].
        marks: index of the step that begins at each stamp, shape (n,).
        table: from `kernel.Grid.tabulate`, shape (2 m + 1, 3).
        tilted: from `tilts`, filled where the run goes, shape (2 m + 1,) [1].
        p: from `models.coefficients`, for which `path_of` is `SMOOTH`.
        first, last: stamps.
        out: s [m] and ṡ [m/s] at these stamps, shape (last − first + 1, 2); row 0 holds the start, the rest is filled.
    """
    gravity, centrifugal, eccentric = p[slots.GRAVITY], p[slots.CENTRIFUGAL], p[slots.ECCENTRIC]
    s, v = out[0, 0], out[0, 1]
    for stamp in range(first + 1, last + 1):
        for j in range(marks[stamp - 1], marks[stamp]):
            h, begin, middle, end = steps[j], 2 * j, 2 * j + 1, 2 * j + 2
            rate, angular = table[begin, 1], table[begin, 2]
            k1 = gravity * tilted[begin] + centrifugal * s * rate * rate - eccentric * angular
            rate, angular = table[middle, 1], table[middle, 2]
            v2 = v + 0.5 * h * k1
            k2 = gravity * tilted[middle] + centrifugal * (s + 0.5 * h * v) * rate * rate - eccentric * angular
            v3 = v + 0.5 * h * k2
            k3 = gravity * tilted[middle] + centrifugal * (s + 0.5 * h * v2) * rate * rate - eccentric * angular
            rate, angular = table[end, 1], table[end, 2]
            v4 = v + h * k3
            k4 = gravity * tilted[end] + centrifugal * (s + h * v3) * rate * rate - eccentric * angular
            s += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
            v += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
        out[stamp - first, 0], out[stamp - first, 1] = s, v


@njit(cache=True, nogil=True, error_model="numpy")
def dry_run(
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    tilted: FloatArray,
    p: FloatArray,
    first: int,
    last: int,
    out: FloatArray,
) -> None:
    """As `smooth_run`, on the path `DRY`: a friction against rolling that differs between directions at most."""
    gravity, centrifugal, eccentric = p[slots.GRAVITY], p[slots.CENTRIFUGAL], p[slots.ECCENTRIC]
    plus, minus = p[slots.RESPONSE] * max(p[slots.DRY_PLUS], 0.0), p[slots.RESPONSE] * max(p[slots.DRY_MINUS], 0.0)
    weight, height = p[slots.WEIGHT], p[slots.HEIGHT]
    s, v = out[0, 0], out[0, 1]
    for stamp in range(first + 1, last + 1):
        for j in range(marks[stamp - 1], marks[stamp]):
            h, begin, middle, end = steps[j], 2 * j, 2 * j + 1, 2 * j + 2
            rate, angular = table[begin, 1], table[begin, 2]
            k1 = gravity * tilted[begin] + centrifugal * s * rate * rate - eccentric * angular
            rate, angular = table[end, 1], table[end, 2]
            drive_end, rate_end = gravity * tilted[end], rate
            push_end = eccentric * angular
            rate, angular = table[middle, 1], table[middle, 2]
            v2 = v + 0.5 * h * k1
            k2 = gravity * tilted[middle] + centrifugal * (s + 0.5 * h * v) * rate * rate - eccentric * angular
            v3 = v + 0.5 * h * k2
            k3 = gravity * tilted[middle] + centrifugal * (s + 0.5 * h * v2) * rate * rate - eccentric * angular
            v4 = v + h * k3
            k4 = drive_end + centrifugal * (s + h * v3) * rate_end * rate_end - push_end
            s_end = s + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
            v_end = v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
            # From here on as `analytic.step._resist`; the normal force at rest differs by −2 ṡ α̇ alone.
            drive, rest = (v_end - v) / h, h
            pressed, turn = weight * np.cos(table[middle, 0]), height * rate * rate
            if v != 0.0:
                sign = 1.0 if v > 0.0 else -1.0
                limit = (plus if v > 0.0 else minus) * max(pressed - 2.0 * v * rate - s * angular - turn, 0.0)
                v_end -= sign * limit * h
                if sign * v_end >= 0.0:
                    s, v = s_end - 0.5 * sign * limit * h * h, v_end
                    continue
                stop = v / (sign * limit - drive)
                s, rest = s + 0.5 * v * stop, h - stop
            limit = (plus if drive > 0.0 else minus) * max(pressed - s * angular - turn, 0.0)
            if abs(drive) <= limit:
                v = 0.0
                continue
            sign = 1.0 if drive > 0.0 else -1.0
            if v == 0.0:
                s, v = s_end - 0.5 * sign * limit * h * h, (drive - sign * limit) * h
            else:
                v = (drive - sign * limit) * rest
                s += 0.5 * v * rest
        out[stamp - first, 0], out[stamp - first, 1] = s, v
