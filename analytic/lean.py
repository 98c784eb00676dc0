"""Runs with few effects: the steps of `analytic.lean_step` from stamp to stamp, sin(α + α₀) computed once for many."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic import slots
from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.lean_step import damped_step, friction_at, lost_to, push, resisted, smooth_step, tilted
from analytic.motion import FloatArray


@njit(cache=True)
def tilts(table: FloatArray, begin: int, end: int, p: FloatArray, out: FloatArray) -> None:
    """Fill rows `begin` … `end` of `out`, shape (2 m + 1,), with sin(α + α₀), or α + α₀ in a linear model [1]."""
    for row in range(begin, end + 1):
        out[row] = tilted(table[row, 0], p)


@njit(cache=True, error_model="numpy")
def smooth_run(
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    sines: FloatArray,
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
        sines: from `tilts`, filled where the run goes, shape (2 m + 1,) [1].
        p: from `models.coefficients`, for which `path_of` is `SMOOTH`.
        first, last: stamps.
        out: s [m] and ṡ [m/s] at these stamps, shape (last − first + 1, 2); row 0 holds the start, the rest is filled.
    """
    table, p = borrowed(table), borrowed(p)
    s, v, centrifugal = out[0, 0], out[0, 1], p[slots.CENTRIFUGAL]
    for stamp in range(first + 1, last + 1):
        for j in range(marks[stamp - 1], marks[stamp]):
            begin = push(sines[2 * j], table[2 * j, 1], table[2 * j, 2], p)
            middle = push(sines[2 * j + 1], table[2 * j + 1, 1], table[2 * j + 1, 2], p)
            end = push(sines[2 * j + 2], table[2 * j + 2, 1], table[2 * j + 2, 2], p)
            s, v = smooth_step(s, v, steps[j], begin, middle, end, centrifugal)
        out[stamp - first, 0], out[stamp - first, 1] = s, v


@njit(cache=True, error_model="numpy")
def dry_run(
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    sines: FloatArray,
    p: FloatArray,
    first: int,
    last: int,
    out: FloatArray,
) -> None:
    """As `smooth_run`, on the path `DRY`: a friction that can hold the ball."""
    table, p = borrowed(table), borrowed(p)
    s, v, centrifugal = out[0, 0], out[0, 1], p[slots.CENTRIFUGAL]
    for stamp in range(first + 1, last + 1):
        for j in range(marks[stamp - 1], marks[stamp]):
            begin = push(sines[2 * j], table[2 * j, 1], table[2 * j, 2], p)
            middle = push(sines[2 * j + 1], table[2 * j + 1, 1], table[2 * j + 1, 2], p)
            end = push(sines[2 * j + 2], table[2 * j + 2, 1], table[2 * j + 2, 2], p)
            s_end, v_end = smooth_step(s, v, steps[j], begin, middle, end, centrifugal)
            s, v = resisted(s, v, steps[j], s_end, v_end, friction_at(table, 2 * j + 1, p), p)
        out[stamp - first, 0], out[stamp - first, 1] = s, v


@njit(cache=True, error_model="numpy")
def damped_run(
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    sines: FloatArray,
    p: FloatArray,
    first: int,
    last: int,
    out: FloatArray,
    dry: bool,
) -> None:
    """As `smooth_run`, on the paths `DAMPED` and, where `dry`, `DAMPED_DRY`: friction that grows with the velocity."""
    table, p = borrowed(table), borrowed(p)
    s, v = out[0, 0], out[0, 1]
    for stamp in range(first + 1, last + 1):
        for j in range(marks[stamp - 1], marks[stamp]):
            begin = push(sines[2 * j], table[2 * j, 1], table[2 * j, 2], p)
            middle = push(sines[2 * j + 1], table[2 * j + 1, 1], table[2 * j + 1, 2], p)
            end = push(sines[2 * j + 2], table[2 * j + 2, 1], table[2 * j + 2, 2], p)
            if dry:
                friction = friction_at(table, 2 * j + 1, p)
                lost = lost_to(friction, s, v, steps[j], p)
                s_end, v_end = damped_step(s, v, steps[j], begin, middle, end, lost, p)
                s, v = resisted(s, v, steps[j], s_end, v_end, friction, p)
            else:
                s, v = damped_step(s, v, steps[j], begin, middle, end, 0.0, p)
        out[stamp - first, 0], out[stamp - first, 1] = s, v
