"""Windows of recordings that engines are fitted to, with the covariance of what an engine cannot foresee in them.

A perfect engine misses the readings by their noise, and by where the error of the recorded angle takes the ball: the
angle's posterior is drawn (`harness.signals.drive`), and each draw's deviation is integrated twice to a path of the
ball. Residuals are divided by the root of the covariance of both, so that they are white with variance 1 for a complete
model: least squares of them are generalised least squares (Aitken, 1935).

An engine begins a window with a ball that rolls. So windows are few and long, and all but a recording's first begin
where, within 1 s, the beam was least steep: the friction that rolling needs grows with the tilt. A ball may slide
there, too.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.linalg import solve_triangular

from analytic.motion import FloatArray
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.numerics import evenly_chosen

LENGTH = 10.0
"""Length of a free run; a recording of half as much again is one [s]."""
MOST = 12
"""Windows that are fitted to: of many, so many are taken evenly, since an engine runs through each of them."""
_CELL = 0.04  # readings within so long are averaged: free runs differ from readings slowly [s]
_DRAWS = 256  # of the angle's error
_FEWEST = 12  # cells of a window
_BEFORE = 0.3  # a window, over which the largest tilt counts [s]
_MOVED = 1.0  # by which a window may begin earlier or later for that [s]
_FIRST = 0.6  # over which a parabola through the readings gives the first guess of a start [s]
_ROUNDING = 1e-6


@dataclass(frozen=True)
class Stretch:
    """A window of a recording.

    Attributes:
        recording: to which it belongs.
        begin: time at which it begins, before the first cell [s].
        time: of the m cells, shape (m,) [s].
        reading: mean reading of each, shape (m,) [m].
        root: lower Cholesky factor of the covariance, shape (m, m) [m].
    """

    recording: PreparedRecording
    begin: float
    time: FloatArray
    reading: FloatArray
    root: FloatArray

    def whitened(self, values: FloatArray) -> FloatArray:
        """Residuals or their derivatives, shape (m,) or (m, c) [m], without correlation and of variance 1."""
        return np.asarray(solve_triangular(self.root, values, lower=True, check_finite=False))

    def first_start(self) -> tuple[float, float]:
        """Position [m] and velocity [m/s] at the first cell, by a parabola through the first readings.

        A line would miss the velocity by 0.1 m/s where the beam tilts by 3°: hundreds of its standard deviations.
        """
        end = max(int(np.searchsorted(self.time, self.time[0] + _FIRST)), 5)
        _, velocity, position = np.polyfit(self.time[:end] - self.time[0], self.reading[:end], 2)
        return float(position), float(velocity)

    def part(self, use: NDArray[np.bool_]) -> Stretch:
        """Its first cells alone, those where `use`, shape (m,), holds."""
        count = int(use.sum())
        return replace(self, time=self.time[:count], reading=self.reading[:count], root=self.root[:count, :count])


def fitted_stretches(problem: Problem) -> tuple[Stretch, ...]:
    """Consecutive windows of about 10 s over all recordings, of many an even choice.

    All but a recording's first begin where the beam is least steep.
    """
    found: list[Stretch] = []
    for recording in problem.recordings:
        begin, end = float(recording.time[0]), float(recording.time[-1])
        count = max(round((end - begin) / LENGTH), 1)
        first, *inner, last = np.linspace(begin, end + _ROUNDING, count + 1).tolist()
        edges = [first, *(_least_steep(recording, edge) for edge in inner), last]
        found += stretches_of(problem, recording, list(itertools.pairwise(edges)))
    return evenly_chosen(found, MOST)


def _least_steep(recording: PreparedRecording, time: float) -> float:
    """The stamp of a reading near `time` [s] before which the largest tilt was smallest, of several the nearest.

    `time` itself where there is no reading near.
    """
    drive = recording.drive
    known = recording.time[np.isfinite(recording.reading)]
    near = known[np.abs(known - time) <= _MOVED + _ROUNDING]
    if not len(near):
        return time
    tilt = np.abs(drive.states[:, 0])
    firsts = np.searchsorted(drive.time, near - _BEFORE - _ROUNDING)
    lasts = np.searchsorted(drive.time, near, side="right")
    largest = np.array([tilt[first:last].max() for first, last in zip(firsts, lasts, strict=True)])
    return float(near[np.lexsort((np.abs(near - time), largest))[0]])


def stretches_of(problem: Problem, recording: PreparedRecording, spans: Sequence[tuple[float, float]]) -> list[Stretch]:
    """The windows of a recording over these spans of time [s] that hold readings enough."""
    drive = recording.drive
    errors = np.array([path.states[:, 0] for path in drive.draw(_DRAWS, seed=0)]) - drive.states[:, 0]
    pull = problem.rig.gravity * problem.rig.rolling_ratio * np.cos(drive.states[:, 0])
    ball_time = recording.time - problem.sensor(()).delay
    inside = (ball_time >= drive.time[0]) & (ball_time <= drive.time[-1])  # elsewhere nobody knows the angle
    known = np.isfinite(recording.reading) & inside
    made = []
    for begin, end in spans:
        use = known & (recording.time >= begin - _ROUNDING) & (recording.time < end - _ROUNDING)
        if not use.any():
            continue
        # A cell ends where a multiple of its length after the window's begin is passed.
        cells = np.floor((recording.time[use] - begin) / _CELL + _ROUNDING).astype(int)
        _, place, count = np.unique(cells, return_inverse=True, return_counts=True)
        if len(count) < _FEWEST:
            continue
        time = np.bincount(place, recording.time[use]) / count
        reading = np.bincount(place, recording.reading[use]) / count
        near = slice(*np.searchsorted(drive.time, (time[0] - _CELL, time[-1] + _CELL)))
        root = _root(problem, time, count, drive.time[near], (errors * pull)[:, near])
        made.append(Stretch(recording, begin, time, reading, root))
    return made


def _root(
    problem: Problem, time: FloatArray, count: NDArray[np.int64], stamps: FloatArray, pushes: FloatArray
) -> FloatArray:
    """Root of the covariance of the mean readings, shape (m, m) [m].

    Args:
        time: of the m cells [s].
        count: readings in each, shape (m,).
        stamps: of the drive, shape (k,) [s].
        pushes: accelerations due to draws of the angle's error, shape (draws, k) [m/s²].
    """
    speeds = cumulative_trapezoid(pushes, stamps, axis=1, initial=0)
    paths = cumulative_trapezoid(speeds, stamps, axis=1, initial=0)
    at = np.array([np.interp(time, stamps, path) for path in paths])
    apart = np.abs(time[:, None] - time[None, :])
    colour = problem.colour
    white = np.diag((1.0 - colour.share) / count)
    noise = problem.reading_variance * (white + colour.share * np.exp(-apart / colour.time))
    return np.asarray(np.linalg.cholesky(noise + at.T @ at / len(at)))
