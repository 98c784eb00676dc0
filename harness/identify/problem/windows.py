"""Windows of recordings: the part that a prediction may use, and the part that it is held against."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.identify.problem.problem import PreparedRecording, Problem

KNOWN = 2.0  # of each window [s]: what comes before is known to the prediction
AHEAD = 3.0  # of each window [s]: what is predicted
HORIZONS = (1.0, 2.0, 3.0, 5.0)  # [s]
_FEWEST = 5  # readings of a window that must be known, and as many to be judged
_ROUNDING = 1e-6  # [s]: stamps are not exact multiples of the sampling interval


@dataclass(frozen=True)
class Window:
    """A stretch of a recording.

    Attributes:
        recording: the recording.
        begin: of the known part, a time of the recording [s].
        use: its stamps, a slice of the recording's n.
    """

    recording: PreparedRecording
    begin: float
    use: slice

    @property
    def time(self) -> FloatArray:
        """Stamps since its begin, shape (m,) [s]."""
        return self.recording.time[self.use] - self.begin

    @property
    def reading(self) -> FloatArray:
        """Positions, NaN where there is none that counts, shape (m,) [m]."""
        return self.recording.reading[self.use]

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Readings that a prediction may use, shape (m,)."""
        return np.isfinite(self.reading) & (self.time < KNOWN - _ROUNDING)

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """Readings that a prediction is held against, shape (m,)."""
        return np.isfinite(self.reading) & (self.time >= KNOWN - _ROUNDING)

    @cached_property
    def step(self) -> float:
        """Median sampling interval [s]."""
        return float(np.median(np.diff(self.time)))

    @cached_property
    def grid(self) -> FloatArray:
        """Even times that cover the window, shape (k,) [s]; the recording's own stamps where these are even."""
        return self.step * np.arange(math.ceil(self.time[-1] / self.step - _ROUNDING) + 1)

    @cached_property
    def angle(self) -> FloatArray:
        """α at the grid, shape (k,) [rad]."""
        return self.recording.drive.evaluate(np.minimum(self.begin + self.grid, self.recording.time[-1]))

    def at_stamps(self, columns: Sequence[FloatArray]) -> FloatArray:
        """Signals on the grid, each of shape (k,), at the stamps: shape (m, number of signals)."""
        return np.column_stack([np.interp(self.time, self.grid, column) for column in columns])

    def rms_error(self, predicted: FloatArray) -> float:
        """RMS error of predicted positions, shape (m,), over the judged readings [m]."""
        return float(np.sqrt(np.mean((predicted - self.reading)[self.judged] ** 2)))


def windows_of(recordings: Sequence[PreparedRecording]) -> tuple[Window, ...]:
    """All windows with 2 s known and 3 s to be predicted, one after the other; the predicted parts do not overlap."""
    found = []
    for recording in recordings:
        time = recording.time - recording.time[0]
        for i in range(int((time[-1] - KNOWN) / AHEAD + _ROUNDING)):
            first, last = np.searchsorted(time, np.array([i * AHEAD, i * AHEAD + KNOWN + AHEAD]) - _ROUNDING)
            window = Window(recording, float(recording.time[0]) + i * AHEAD, slice(int(first), int(last)))
            if window.known.sum() >= _FEWEST and window.judged.sum() >= _FEWEST:
                found.append(window)
    return tuple(found)


def horizon_spans(time: FloatArray) -> list[tuple[str, float, float]]:
    """Name, begin and end [s] of every predicted span, for stamps that begin at 0, shape (n,).

    "3 s" are consecutive spans of 3 s after the first two seconds; "whole" is everything after these.
    """
    end = float(time[-1])
    found = []
    for horizon in HORIZONS:
        count = int((end - KNOWN) / horizon + 1e-6)
        found += [(f"{horizon:g} s", KNOWN + i * horizon, KNOWN + (i + 1) * horizon) for i in range(count)]
    return [*found, ("whole", KNOWN, end + 1.0)]


@dataclass(frozen=True)
class Fold:
    """A fold of a cross-validation.

    Attributes:
        problem: the recordings to fit to.
        left: the recordings held out.
    """

    problem: Problem
    left: tuple[PreparedRecording, ...]

    @property
    def title(self) -> str:
        """Names of what is held out."""
        return ", ".join(recording.name for recording in self.left)


def folds(problem: Problem) -> list[Fold]:
    """Each recording held out in turn; of a single one, either half of its positions."""
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
