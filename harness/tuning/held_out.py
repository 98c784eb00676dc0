"""Errors of an engine on held-out blocks: 3 s predicted from the 2 s before them, by fits without these readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby

import numpy as np

from analytic.motion import FloatArray
from harness.errors import EngineFailure
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import AHEAD, KNOWN, Block, blocks_of
from harness.metrics.bootstrap import Margin, rms_reduction
from harness.numerics import evenly_chosen, rms
from harness.parallel import side_by_side
from harness.progress import Progress, silent
from harness.tuning.estimate.fit import fit, run_through
from harness.tuning.estimate.runs import Model, Values, known_positions
from harness.tuning.estimate.selection import Selection
from harness.tuning.estimate.windows import Stretch, fitted_stretches, stretches_of

_MOST = 12  # blocks: of many, so many are taken evenly
_NEAR = 8  # evaluations of a fit that begins at the values fitted to everything
_FEWEST = 4  # blocks for an interval of a difference


@dataclass(frozen=True)
class Predicted:
    """Positions predicted in one block: those of the first of its windows, over the 3 s after the known part.

    Attributes:
        recording: name of the recording.
        time: of the m readings, each the mean of a cell, shape (m,) [s].
        before, after: of the engine as it was and as it was tuned, shape (m,) [m]; NaN where it failed.
    """

    recording: str
    time: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True)
class HeldOutErrors:
    """RMS errors of blocks.

    Attributes:
        blocks: numbers of the blocks among those of the recordings, shape (n,).
        before, after: of the engine as it was and as it was tuned, shape (n,) [m].
        predicted: positions, of each block that has any, in the order of the recordings and of time.
    """

    blocks: tuple[int, ...]
    before: FloatArray
    after: FloatArray
    predicted: tuple[Predicted, ...] = ()

    def untuned(self) -> HeldOutErrors:
        """The same of an engine that stays as it was."""
        predicted = tuple(replace(one, after=one.before) for one in self.predicted)
        return replace(self, after=self.before, predicted=predicted)

    @property
    def margin(self) -> Margin | None:
        """By how much tuning lowers the RMS error [m]; `None` for too few blocks."""
        return None if len(self.blocks) < _FEWEST else rms_reduction(self.before, self.after)


def held_out_errors(model: Model, selection: Selection, progress: Progress = silent) -> HeldOutErrors | None:
    """Errors on held-out blocks before and after; `None` where there is none that the engine runs through.

    The tuned parameters are fitted anew for every group of blocks that is held out together.
    """
    every = list(enumerate(blocks_of(model.problem.recordings)))
    if not every:
        return None
    chosen = evenly_chosen(every, _MOST)
    groups = [list(group) for _, group in groupby(chosen, key=lambda one: one[1].group)]
    count = len(groups)
    found = side_by_side(
        [partial(_group, replace(model, jobs=1), selection, [block for _, block in group]) for group in groups],
        model.jobs,
        lambda done: progress(f"held-out blocks: group {done} of {count}", share=done / count),
    )
    pairs = zip(chosen, [each for group in found for each in group], strict=True)
    kept = [one for one in pairs if np.isfinite(one[1][0].error) and np.isfinite(one[1][1].error)]
    if not kept:
        return None
    chosen, both = tuple(block for block, _ in kept), [errors for _, errors in kept]
    before, after = (np.array([one[which].error for one in both]) for which in (0, 1))
    predicted = tuple(
        Predicted(block.held_out[0].recording.name, old.time, old.position, new.position)
        for (_, block), (old, new) in zip(chosen, both, strict=True)
        if len(old.time)
    )
    return HeldOutErrors(tuple(number for number, _ in chosen), before, after, predicted)


@dataclass(frozen=True)
class _OfBlock:
    """RMS error over the windows of a block [m], and positions in the first of them, shape (m,) each [s, m]."""

    error: float
    time: FloatArray
    position: FloatArray


def _group(model: Model, selection: Selection, blocks: Sequence[Block]) -> list[tuple[_OfBlock, _OfBlock]]:
    """Each of these blocks before and after."""
    problem = without(model.problem, blocks)
    rest = replace(model, problem=problem)
    found = selection.found
    values: Values = found.values
    if selection.pays:
        windows = fitted_stretches(problem)
        values = _refitted(rest, windows, selection) if windows else values
    before = _of_blocks(model, blocks, selection.before.values)
    after = _of_blocks(model, blocks, values) if selection.pays else before
    return list(zip(before, after, strict=True))


def _refitted(model: Model, windows: Sequence[Stretch], selection: Selection) -> Values:
    found = selection.found
    try:
        return fit(model, windows, found.free, found.values, iterations=_NEAR).values
    except EngineFailure:
        kept, _ = run_through(model, windows, found.values)
        return fit(model, kept, found.free, found.values, iterations=_NEAR).values


def without(problem: Problem, blocks: Sequence[Block]) -> Problem:
    """The problem without the readings of the predicted parts of these blocks."""
    readings = {id(one): one.reading.copy() for one in problem.recordings}
    for block in blocks:
        for window in block.held_out:
            readings[id(window.recording)][window.use][window.judged] = np.nan
    return replace(problem, recordings=tuple(replace(one, reading=readings[id(one)]) for one in problem.recordings))


def _of_blocks(model: Model, blocks: Sequence[Block], values: Values) -> list[_OfBlock]:
    """Error and positions of each block, from starts fitted to the known part of each window."""
    made = []
    for block in blocks:
        windows = block.held_out
        spans = [(window.begin, window.begin + KNOWN + AHEAD) for window in windows]
        stretches = stretches_of(model.problem, windows[0].recording, spans)
        known = [one.part(one.time < one.time[0] + KNOWN) for one in stretches]
        try:
            starts = fit(model, known, [], {}, fixed=values).starts
        except EngineFailure:
            made.append(_OfBlock(np.nan, np.zeros(0), np.zeros(0)))
            continue
        runs = model.runs(stretches, [(values, starts)])[0]
        error = rms(np.array([_ahead(one, run) for one, run in zip(stretches, runs, strict=True)]))
        # Up to where the next block begins: where windows have too few readings, the first one left may begin later.
        end = windows[0].begin + KNOWN + AHEAD
        first, run = stretches[0], runs[0]
        shown = (first.time >= first.time[0] + KNOWN) & (first.time < end)
        made.append(_OfBlock(error, first.time[shown], known_positions(run)[shown]))
    return made


def _ahead(window: Stretch, run: FloatArray) -> float:
    """RMS error over the predicted part [m]."""
    ahead = window.time >= window.time[0] + KNOWN
    return rms((window.reading - run)[ahead])
