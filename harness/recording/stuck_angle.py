"""Stretches in which the recorded angle rests although the ball shows that the beam turned.

A beam may rest. That its sensor was stuck takes two things at once: where the stretch ends, or begins, the angle steps
farther than it does between any other two readings; and the ball's acceleration in the stretch departs from what the
recorded angle makes of it by more than in any other stretch of this length in the recording. Both are compared with
the recording itself, so that friction, an uneven track and a commanded angle, which moves in steps, count in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.tilt_response import modulating

SHORTEST = 0.8  # of a stretch [s]
FEWEST = 10  # readings of a stretch
STEP_ABOVE_OTHERS = 2.0  # times the largest step between other readings
DEPARTURE_ABOVE_OTHERS = 1.5  # times the largest departure elsewhere
WINDOWS_ELSEWHERE = 4  # that do not overlap; with fewer, nothing is concluded


def stuck_angles(
    time: FloatArray, angle: FloatArray, position: FloatArray, usable: NDArray[np.bool_]
) -> Iterator[tuple[int, int]]:
    """First and last reading, both included, of every stretch in which the angle's sensor was stuck.

    Args:
        time: strictly increasing, shape (n,) [s].
        angle: shape (n,) [rad].
        position: shape (n,) [m].
        usable: positions that are known, no spikes and not set aside, shape (n,).
    """
    runs = [run for run in _resting(time, angle) if usable[run[0] : run[1] + 1].mean() > 0.5]
    if not runs:
        return
    steps = np.abs(np.diff(angle))
    at_ends = {i for first, last in runs for i in (first - 1, last) if 0 <= i < len(steps)}
    others = np.delete(steps, sorted(at_ends))
    usual = float(others.max()) if len(others) else np.inf
    for first, last in runs:
        ends = [float(steps[i]) for i in (first - 1, last) if 0 <= i < len(steps)]
        if max(ends, default=0.0) <= STEP_ABOVE_OTHERS * usual:
            continue
        if _departs(time, angle, np.interp(time, time[usable], position[usable]), (first, last), runs):
            yield first, last


def _resting(time: FloatArray, angle: FloatArray) -> Iterator[tuple[int, int]]:
    edges = np.concatenate(([0], np.flatnonzero(np.diff(angle) != 0.0) + 1, [len(angle)]))
    for first, end in pairwise(edges.tolist()):
        if end - first >= FEWEST and time[end - 1] - time[first] >= SHORTEST:
            yield first, end - 1


def _departs(
    time: FloatArray, angle: FloatArray, position: FloatArray, run: tuple[int, int], runs: list[tuple[int, int]]
) -> bool:
    """Whether ∫ s φ̈ departs from its regression on ∫ α φ and ∫ α φ̈ more in the run than anywhere else.

    φ is a smooth test function over the run's length, as of `tilt_response`.
    """
    step = float(np.median(np.diff(time)))
    grid = np.arange(time[0], time[-1] + 0.5 * step, step)
    tilt, path = np.interp(grid, time, angle), np.interp(grid, time, position)
    half = int((time[run[1]] - time[run[0]]) / step) // 2
    if half < FEWEST // 2 or len(grid) < 2 * half * (WINDOWS_ELSEWHERE + 1):
        return False
    test, curvature = modulating(half, step)
    columns = [
        np.convolve(tilt, test, "valid"),
        np.convolve(tilt, curvature, "valid"),
        np.convolve(path, curvature, "valid"),
    ]
    centre = grid[half : half + len(columns[0])]
    apart = np.ones(len(centre), dtype=np.bool_)
    for first, last in runs:
        apart &= (centre + half * step <= time[first]) | (centre - half * step >= time[last])
    if apart.sum() < 2 * half * (WINDOWS_ELSEWHERE - 1):
        return False
    regressors = np.column_stack((np.ones(len(centre)), *columns[:2]))
    fitted = np.linalg.lstsq(regressors[apart], columns[2][apart], rcond=None)[0]
    departure = np.abs(columns[2] - regressors @ fitted)
    inside = int(np.argmin(np.abs(centre - 0.5 * (time[run[0]] + time[run[1]]))))
    return bool(departure[inside] > DEPARTURE_ABOVE_OTHERS * departure[apart].max())
