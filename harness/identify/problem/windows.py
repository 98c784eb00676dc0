"""Windows of recordings, each with a known part and a predicted part, and the folds of cross-validation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.metrics.score import WHOLE

KNOWN = 2.0  # length of the known part of a window [s]
AHEAD = 3.0  # length of the predicted part of a window [s]
HORIZONS = (1.0, 2.0, 3.0, 5.0)  # lengths of predicted spans [s]
_FEWEST = 5  # readings that each part of a window needs
_FEWEST_FITTED = 2  # windows
GROUPS = 6  # of blocks, or of recordings, that are held out together
_STRIDE_FITTED, _STRIDE_PREDICTED = 2.0, 1.0  # of overlapping windows [s]
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

    @cached_property
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
    def _equidistant(self) -> bool:
        return len(self.grid) == len(self.time) and bool(np.all(np.abs(self.grid - self.time) < _ROUNDING))

    @property
    def stamps(self) -> FloatArray:
        """Times at which signals on the grid are read off, shape (m,) [s]: those of the grid where it is the stamps."""
        return self.grid if self._equidistant else self.time

    @cached_property
    def angle(self) -> FloatArray:
        """α on the grid, shape (k,) [rad]."""
        return self.recording.drive.evaluate(np.minimum(self.begin + self.grid, self.recording.time[-1]))

    def at_stamps(self, columns: Sequence[FloatArray]) -> FloatArray:
        """Signals on the grid, shape (k,) each, interpolated at the stamps: shape (m, number of signals)."""
        if self._equidistant:
            return np.column_stack(columns)
        return np.column_stack([np.interp(self.stamps, self.grid, column) for column in columns])

    def rms_error(self, predicted: FloatArray) -> float:
        """RMS error of predicted positions, shape (m,), over the predicted part [m]."""
        return float(np.sqrt(np.mean((predicted - self.reading)[self.judged] ** 2)))


def windows_of(recordings: Sequence[PreparedRecording], stride: float = AHEAD) -> tuple[Window, ...]:
    """Windows, 2 s known and 3 s predicted, that begin every `stride` [s].

    By default they are consecutive: the predicted parts do not overlap. A shorter recording may give one that ends
    with it.
    """
    windows = []
    for recording in recordings:
        time = recording.time - recording.time[0]
        for i in range(int((time[-1] - KNOWN - AHEAD) / stride + _ROUNDING) + 1):
            begin = i * stride
            first, last = np.searchsorted(time, np.array([begin, begin + KNOWN + AHEAD]) - _ROUNDING)
            window = Window(recording, float(recording.time[0]) + begin, slice(int(first), int(last)))
            if window.known.sum() >= _FEWEST and window.judged.sum() >= _FEWEST:
                windows.append(window)
    return tuple(windows)


def known_first(length: float) -> float:
    """How much of a recording of this length is known where the rest is predicted: 2 s, or half of a short one [s]."""
    return min(KNOWN, 0.5 * length)


def horizon_spans(time: FloatArray) -> list[tuple[str, float, float]]:
    """Name, begin and end [s] of every predicted span, for stamps that begin at 0, shape (n,).

    "3 s" names consecutive spans of 3 s after the known part (`known_first`); "whole" the span of all after this.
    """
    end = float(time[-1])
    begin = known_first(end)
    spans = []
    for horizon in HORIZONS:
        count = int((end - begin) / horizon + 1e-6)
        spans += [(f"{horizon:g} s", begin + i * horizon, begin + (i + 1) * horizon) for i in range(count)]
    return [*spans, (WHOLE, begin, end + 1.0)]


def predicted_spans(time: FloatArray, known: NDArray[np.bool_], fewest: int = 1) -> list[tuple[str, slice]]:
    """Name and stamps of each of `horizon_spans` that has `fewest` known readings, and more than five before it.

    Args:
        time: stamps that begin at 0, shape (n,) [s].
        known: mask of the stamps with a reading, shape (n,).
    """
    count = np.concatenate(([0], np.cumsum(known)))
    spans = []
    for name, first, last in horizon_spans(time):
        begin, end = (int(stamp) for stamp in np.searchsorted(time, (first, last)))
        if count[begin] > _FEWEST and count[end] - count[begin] >= fewest:
            spans.append((name, slice(begin, end)))
    return spans


@dataclass(frozen=True)
class Block:
    """Consecutive windows of one recording to predict, and the windows to fit to while they are held out.

    Attributes:
        held_out: windows that overlap; together they are one sample of the prediction error.
        fitted: windows without any reading of the predicted parts of `held_out` and of the blocks held out with it.
        group: number of the group of blocks that are held out together.
    """

    held_out: tuple[Window, ...]
    fitted: tuple[Window, ...]
    group: int


def fitted_windows(recordings: Sequence[PreparedRecording]) -> tuple[Window, ...]:
    """Windows that models are fitted to."""
    return windows_of(recordings, _STRIDE_FITTED)


def blocks_of(recordings: Sequence[PreparedRecording]) -> tuple[Block, ...]:
    """Blocks of 3 s, in six groups of neighbours that are held out together; empty if there is too little to fit.

    Windows to predict begin every second and windows to fit every two, so that short recordings tell what they can.
    """
    held: list[list[Window]] = []
    for window in windows_of(recordings, _STRIDE_PREDICTED):
        same = held and held[-1][0].recording is window.recording and window.begin - held[-1][0].begin < AHEAD
        if same:
            held[-1].append(window)
        else:
            held.append([window])
    fitted = fitted_windows(recordings)
    blocks = []
    for number, group in enumerate(np.array_split(np.arange(len(held)), min(GROUPS, len(held)) or 1)):
        out = [window for i in group for window in held[i]]
        kept = _apart(fitted, out)
        if len(kept) < _FEWEST_FITTED:
            return ()
        blocks += [Block(tuple(held[i]), kept, number) for i in group]
    return tuple(blocks)


def block_groups(recordings: Sequence[PreparedRecording]) -> list[list[Block]]:
    """Blocks that are held out together, in the order of all blocks."""
    return [list(group) for _, group in groupby(blocks_of(recordings), key=lambda block: block.group)]


def without_predicted(problem: Problem, blocks: Sequence[Block]) -> Problem:
    """The problem without the readings of the predicted parts of these blocks."""
    readings = {id(one): one.reading.copy() for one in problem.recordings}
    for block in blocks:
        for window in block.held_out:
            readings[id(window.recording)][window.use][window.judged] = np.nan
    return replace(problem, recordings=tuple(replace(one, reading=readings[id(one)]) for one in problem.recordings))


def of_windows(problem: Problem, windows: Sequence[Window]) -> Problem:
    """The problem with those recordings alone that the windows are of."""
    within = {id(window.recording) for window in windows}
    return replace(problem, recordings=tuple(one for one in problem.recordings if id(one) in within))


def _apart(windows: Sequence[Window], held_out: Sequence[Window]) -> tuple[Window, ...]:
    """The windows without any reading of the predicted parts of those held out."""
    begins: dict[int, list[float]] = {}
    for window in held_out:
        begins.setdefault(id(window.recording), []).append(window.begin)
    predicted = {recording: np.array(each) + KNOWN for recording, each in begins.items()}
    nowhere = np.zeros(0)

    def apart(window: Window) -> bool:
        begin = predicted.get(id(window.recording), nowhere)
        return bool(np.all((window.begin >= begin + AHEAD) | (window.begin + KNOWN + AHEAD <= begin)))

    return tuple(filter(apart, windows))


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
    """Folds that hold out each recording in turn, or each of six groups of many; of a single one, each half."""
    recordings = problem.recordings
    if len(recordings) > 1:
        groups = [recordings[first::GROUPS] for first in range(min(GROUPS, len(recordings)))]
        parts = [(tuple(r for r in recordings if not any(r is one for one in left)), left) for left in groups]
    else:
        (whole,) = recordings
        known = np.flatnonzero(np.isfinite(whole.reading))
        middle = int(known[len(known) // 2])  # of the known readings: all of them may lie in the first seconds
        first, second = _part(whole, "first half", slice(0, middle)), _part(whole, "second half", slice(middle, None))
        parts = [((first,), (second,)), ((second,), (first,))]
    return [Fold(replace(problem, recordings=rest), left) for rest, left in parts]


def _part(whole: PreparedRecording, name: str, stamps: slice) -> PreparedRecording:
    """The recording at some of its stamps."""
    return PreparedRecording(f"{whole.name}, {name}", whole.time[stamps], whole.reading[stamps], whole.drive)
