"""Windows of recordings, each with a known part and a predicted part, and the folds of cross-validation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.identify.problem.problem import PreparedRecording, Problem

KNOWN = 2.0  # length of the known part of a window [s]
AHEAD = 3.0  # length of the predicted part of a window [s]
HORIZONS = (1.0, 2.0, 3.0, 5.0)  # lengths of predicted spans [s]
_FEWEST = 5  # readings that each part of a window needs
_ROUNDING = 1e-6  # [s]: stamps are not exact multiples of the sampling interval


@dataclass(frozen=True)
class Window:
    """A window of a recording.

    Attributes:
        recording: the whole recording, of n stamps.
        begin: time at which the known part begins [s].
        use: slice of the m stamps of the window among the n.
    """

    recording: PreparedRecording
    begin: float
    use: slice

    @property
    def time(self) -> FloatArray:
        """Stamps, counted from `begin`, shape (m,) [s]."""
        return self.recording.time[self.use] - self.begin

    @property
    def reading(self) -> FloatArray:
        """Position readings, NaN where missing or an outlier, shape (m,) [m]."""
        return self.recording.reading[self.use]

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Readings of the known part, shape (m,)."""
        return np.isfinite(self.reading) & (self.time < KNOWN - _ROUNDING)

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Readings of the predicted part, with which a prediction is compared, shape (m,)."""
        return np.isfinite(self.reading) & (self.time >= KNOWN - _ROUNDING)

    @cached_property
    def step(self) -> float:
        """Median sampling interval [s]."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def grid(self) -> FloatArray:
        """Equidistant times that cover the window, shape (k,) [s]; equal to the stamps where these are equidistant."""
        return self.step * np.arange(math.ceil(self.time[-1] / self.step - _ROUNDING) + 1)

    @cached_property
    def angle(self) -> FloatArray:
        """α on the grid, shape (k,) [rad]."""
        return self.recording.drive.evaluate(np.minimum(self.begin + self.grid, self.recording.time[-1]))

    def at_stamps(self, columns: Sequence[FloatArray]) -> FloatArray:
        """Signals on the grid, shape (k,) each, interpolated at the stamps: shape (m, number of signals)."""
        return np.column_stack([np.interp(self.time, self.grid, column) for column in columns])

    def rms_error(self, predicted: FloatArray) -> float:
        """RMS error of predicted positions, shape (m,), over the predicted part [m]."""
        return float(np.sqrt(np.mean((predicted - self.reading)[self.judged] ** 2)))


def windows_of(recordings: Sequence[PreparedRecording]) -> tuple[Window, ...]:
    """Consecutive windows, 2 s known and 3 s predicted; the predicted parts do not overlap."""
    windows = []
    for recording in recordings:
        time = recording.time - recording.time[0]
        for i in range(int((time[-1] - KNOWN) / AHEAD + _ROUNDING)):
            first, last = np.searchsorted(time, np.array([i * AHEAD, i * AHEAD + KNOWN + AHEAD]) - _ROUNDING)
            window = Window(recording, float(recording.time[0]) + i * AHEAD, slice(int(first), int(last)))
            if window.known.sum() >= _FEWEST and window.judged.sum() >= _FEWEST:
                windows.append(window)
    return tuple(windows)


def horizon_spans(time: FloatArray) -> list[tuple[str, float, float]]:
    """Name, begin and end [s] of every predicted span, for stamps that begin at 0, shape (n,).

    "3 s" names consecutive spans of 3 s after the first two seconds; "whole" the span of everything after these.
    """
    end = float(time[-1])
    spans = []
    for horizon in HORIZONS:
        count = int((end - KNOWN) / horizon + 1e-6)
        spans += [(f"{horizon:g} s", KNOWN + i * horizon, KNOWN + (i + 1) * horizon) for i in range(count)]
    return [*spans, ("whole", KNOWN, end + 1.0)]


@dataclass(frozen=True)
class Fold:
    """A fold of a cross-validation.

    Attributes:
        problem: the recordings to fit to.
        left: the held-out recordings.
    """

    problem: Problem
    left: tuple[PreparedRecording, ...]

    @property
    def title(self) -> str:
        """Names of the held-out recordings."""
        return ", ".join(recording.name for recording in self.left)


def folds(problem: Problem) -> list[Fold]:
    """Folds that hold out each recording in turn; of a single recording, each half of its readings."""
    recordings = problem.recordings
    if len(recordings) > 1:
        parts = [(tuple(r for r in recordings if r is not left), left) for left in recordings]
    else:
        (whole,) = recordings
        known = np.flatnonzero(np.isfinite(whole.reading))
        middle = int(known[len(known) // 2])  # of the known readings: all of them may lie in the first seconds
        first, second = _part(whole, "first half", slice(0, middle)), _part(whole, "second half", slice(middle, None))
        parts = [((first,), second), ((second,), first)]
    return [Fold(replace(problem, recordings=rest), (left,)) for rest, left in parts]


def _part(whole: PreparedRecording, name: str, stamps: slice) -> PreparedRecording:
    """The recording at some of its stamps."""
    return PreparedRecording(f"{whole.name}, {name}", whole.time[stamps], whole.reading[stamps], whole.drive)
