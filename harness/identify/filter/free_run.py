"""Free runs over windows of a recording: from a start at each window, with no readings on the way, compiled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.lean_step import path_of
from analytic.motion import FloatArray
from analytic.shared_step import ball_step, beam_step
from harness.identify.filter.arguments import BeamTable, lagging

# Changes of a start for derivatives by it [m], [m/s]: wide enough to average over the jumps that arise where dry
# friction stops the ball.
_OFF = np.array([[1e-3, 0.0], [0.0, 1e-2]])


@njit(cache=True)
def free_runs(
    first: NDArray[np.int64], last: NDArray[np.int64], beam: BeamTable, p: FloatArray, lag: float, starts: FloatArray
) -> FloatArray:
    """Positions behind the sensor's lag at the stamps of one window after the other, shape (Σ stamps,) [m].

    Args:
        first, last: stamps at which each window begins, and one after its last, shape (windows,).
        beam: motion of the beam on the grid of the whole recording.
        p: the kernel's vector, shape (SLOTS,) or longer where force laws follow.
        lag: T of the position sensor [s]; at first it is T ṡ behind, as after a motion at that velocity.
        starts: s [m] and ṡ [m/s] at the first stamp of each window, shape (windows, 2).
    """
    beam, p = borrowed(beam), borrowed(p)
    out, path = np.empty(np.sum(last - first)), path_of(p)
    at = 0
    for i in range(len(first)):
        s, v, w = starts[i, 0], starts[i, 1], 0.0
        y = s - lag * v
        out[at] = y
        for stamp in range(first[i] + 1, last[i]):
            for j in range(beam.marks[stamp - 1], beam.marks[stamp]):
                before, h = s, beam.steps[j]
                on = beam_step(path, beam.table, 2 * j, p)
                s, v, w = ball_step(path, on, s, v, w, h, beam.table, 2 * j, p)
                y = lagging(y, before, s, h, lag) if lag > 0.0 else s
            out[at + stamp - first[i]] = y
        at += last[i] - first[i]
    return out


def start_derivatives(
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    beam: BeamTable,
    p: FloatArray,
    lag: float,
    starts: FloatArray,
    here: FloatArray,
) -> FloatArray:
    """Derivatives of `free_runs` by s and ṡ at the start of each window, shape (Σ stamps, 2) [1], [s].

    Args:
        here: the runs from `starts`, shape (Σ stamps,) [m].
    """
    moved = (free_runs(first, last, beam, p, lag, starts + off) for off in _OFF)
    return np.column_stack([(run - here) / off.sum() for run, off in zip(moved, _OFF, strict=True)])
