"""Free runs over windows, each from a start (s, ṡ) of its own, beside the readings: what a fit to them compares."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.identify.estimate.window_errors import bounded
from harness.identify.filter.dynamics import Dynamics
from harness.identify.filter.free_run import free_runs, start_derivatives
from harness.identify.filter.run import beam_over
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import AHEAD, KNOWN, Window

_FIRST = 0.6  # over which a line through the readings gives the first guess of a start [s]
_RIDGE = 1e-9  # keeps starts on which nothing depends where they are


class _Group(NamedTuple):
    """Windows of one recording: the thinned recording, and the stamps at which each window begins and ends."""

    recording: PreparedRecording
    first: NDArray[np.int64]
    last: NDArray[np.int64]


class FreeRuns:
    """The readings in windows, thinned, and free runs to compare with them."""

    def __init__(self, problem: Problem, windows: Sequence[Window]) -> None:
        self.problem = problem
        by_recording: dict[int, list[Window]] = {}
        for window in windows:
            by_recording.setdefault(id(window.recording), []).append(window)
        self._groups = []
        for group in by_recording.values():
            thin = group[0].recording.thinned
            begin = np.array([window.begin for window in group])
            first, last = np.searchsorted(thin.time, np.array([begin, begin + KNOWN + AHEAD]))
            self._groups.append(_Group(thin, first, last))
        self.reading = np.concatenate(
            [group.recording.reading[a:b] for group in self._groups for a, b in zip(*group[1:], strict=True)]
        )
        sizes = np.concatenate([group.last - group.first for group in self._groups])
        self.windows = len(sizes)
        self._window = np.repeat(np.arange(len(sizes)), sizes)
        self._begin = np.concatenate(([0], np.cumsum(sizes)[:-1]))

    def first_starts(self) -> FloatArray:
        """Starts by a line through the first readings of each window, shape (windows, 2)."""
        starts = []
        for group in self._groups:
            time, reading = group.recording.time, group.recording.reading
            for first, last in zip(group.first, group.last, strict=True):
                end = min(max(int(np.searchsorted(time, time[first] + _FIRST)), first + 4), last)
                velocity, position = np.polyfit(time[first:end] - time[first], reading[first:end], 1)
                starts.append((position, velocity))
        return np.array(starts)

    def runs(self, terms: Terms, starts: FloatArray) -> FloatArray:
        """Recorded positions of the runs, shape (readings,) [m]."""
        return self._runs(terms, starts, self._groups, slopes=False)[0]

    def moved_of(self, recording: PreparedRecording, terms: Terms, starts: FloatArray, here: FloatArray) -> FloatArray:
        """`runs` where the terms differ from those of the runs `here` in what one recording has of its own alone."""
        moved, readings, windows = here.copy(), 0, 0
        for group in self._groups:
            rows = slice(readings, readings + int(np.sum(group.last - group.first)))
            if group.recording is recording.thinned:
                begin = starts[windows : windows + len(group.first)]
                moved[rows] = self._runs(terms, begin, [group], slopes=False)[0]
            readings, windows = rows.stop, windows + len(group.first)
        return moved

    def runs_and_slopes(self, terms: Terms, starts: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same, and their derivatives by the starts, shape (readings, 2) [1], [s]."""
        return self._runs(terms, starts, self._groups, slopes=True)

    def _runs(
        self, terms: Terms, starts: FloatArray, groups: Sequence[_Group], *, slopes: bool
    ) -> tuple[FloatArray, FloatArray]:
        model = Dynamics(self.problem, terms)
        sensor = model.law
        runs, derivatives, at = [], [], 0
        position = sensor.position(starts[:, 0])
        begins = np.column_stack((position, starts[:, 1] / sensor.slope(position)))
        for recording, first, last in groups:
            p, table = model.of(recording)
            begin = begins[at : at + len(first)]
            windows = first, last, beam_over(recording, table), p, sensor.lag, begin
            runs.append(free_runs(*windows))
            if slopes:
                derivatives.append(start_derivatives(*windows, runs[-1]))
            at += len(first)
        positions = bounded(np.concatenate(runs))
        if not slopes:
            return sensor.curve(positions), np.zeros((0, 2))
        return sensor.curve(positions), bounded(np.concatenate(derivatives))

    def sums(self, values: FloatArray) -> FloatArray:
        """Sums over the readings of each window, shape (windows, …)."""
        return np.asarray(np.add.reduceat(values, self._begin, axis=0))

    def project(self, slopes: FloatArray, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """`columns`, shape (readings, c), without what starts explain, and the changes of starts, (windows, 2, c)."""
        gram = self.sums(slopes[:, :, None] * slopes[:, None, :]) + _RIDGE * np.eye(2)
        moves = np.linalg.solve(gram, self.sums(slopes[:, :, None] * columns[:, None, :]))
        rest: FloatArray = columns - np.einsum("ij,ijc->ic", slopes, moves[self._window])
        return rest, np.asarray(moves)
