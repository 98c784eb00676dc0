"""Errors of an engine on held-out blocks: 3 s predicted from the 2 s before them, by fits without these readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby

import numpy as np

from analytic.motion import FloatArray
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import AHEAD, KNOWN, Block, blocks_of
from harness.metrics.bootstrap import Margin, rms_reduction
from harness.numerics import evenly_chosen, rms
from harness.parallel import side_by_side
from harness.progress import Progress, silent
from harness.tuning.estimate.fit import fit
from harness.tuning.estimate.runs import Model, Values
from harness.tuning.estimate.selection import Selection
from harness.tuning.estimate.windows import Stretch, fitted_stretches, stretches_of

_MOST = 12  # blocks: of many, so many are taken evenly
_NEAR = 8  # evaluations of a fit that begins at the fit to everything
_FEWEST = 4  # blocks for an interval of a difference


@dataclass(frozen=True)
class HeldOutErrors:
    """RMS errors of blocks.

    Attributes:
        blocks: numbers of the blocks among those of the recordings, shape (n,).
        before, after: of the engine as it was and as it was tuned, shape (n,) [m].
    """

    blocks: tuple[int, ...]
    before: FloatArray
    after: FloatArray

    @property
    def margin(self) -> Margin | None:
        """By how much tuning lowers the RMS error [m]; `None` for too few blocks."""
        return None if len(self.blocks) < _FEWEST else rms_reduction(self.before, self.after)


def held_out_errors(model: Model, selection: Selection, progress: Progress = silent) -> HeldOutErrors | None:
    """Errors on held-out blocks before and after; `None` where the recordings are too short for any.

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
    before, after = (np.array([value for group in found for value in group[which]]) for which in (0, 1))
    return HeldOutErrors(tuple(number for number, _ in chosen), before, after)


def _group(model: Model, selection: Selection, blocks: Sequence[Block]) -> tuple[list[float], list[float]]:
    """RMS errors of these blocks before and after [m]."""
    problem = without(model.problem, blocks)
    rest = replace(model, problem=problem)
    found = selection.found
    values: Values = found.values
    if selection.pays:
        windows = fitted_stretches(problem)
        values = fit(rest, windows, found.free, values, iterations=_NEAR).values if windows else values
    before = _block_errors(model, blocks, selection.before.values)
    return before, _block_errors(model, blocks, values) if selection.pays else before


def without(problem: Problem, blocks: Sequence[Block]) -> Problem:
    """The problem without the readings of the predicted parts of these blocks."""
    readings = {id(one): one.reading.copy() for one in problem.recordings}
    for block in blocks:
        for window in block.held_out:
            readings[id(window.recording)][window.use][window.judged] = np.nan
    return replace(problem, recordings=tuple(replace(one, reading=readings[id(one)]) for one in problem.recordings))


def _block_errors(model: Model, blocks: Sequence[Block], values: Values) -> list[float]:
    """RMS error of each block [m], from starts fitted to the known part of each window."""
    errors = []
    for block in blocks:
        windows = block.held_out
        spans = [(window.begin, window.begin + KNOWN + AHEAD) for window in windows]
        stretches = stretches_of(model.problem, windows[0].recording, spans)
        known = [one.part(one.time < one.time[0] + KNOWN) for one in stretches]
        starts = fit(model, known, [], {}, fixed=values, iterations=_NEAR).starts
        runs = model.runs(stretches, [(values, starts)])[0]
        errors.append(rms(np.array([_ahead(one, run) for one, run in zip(stretches, runs, strict=True)])))
    return errors


def _ahead(window: Stretch, run: FloatArray) -> float:
    """RMS error over the predicted part [m]."""
    ahead = window.time >= window.time[0] + KNOWN
    return rms((window.reading - run)[ahead])
