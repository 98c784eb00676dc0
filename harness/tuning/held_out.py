"""Errors of an engine on held-out blocks: 3 s predicted from the 2 s before them, by fits without these readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.errors import EngineFailure
from harness.identify.problem.windows import AHEAD, KNOWN, Block, blocks_of, without_predicted
from harness.jobs import gathered
from harness.metrics.bootstrap import FEWEST, Margin, rms_reduction
from harness.numerics import evenly_chosen, rms
from harness.parallel import side_by_side
from harness.progress import Progress, silent
from harness.tuning.estimate.fit import fit
from harness.tuning.estimate.runs import Model, Values, known_positions
from harness.tuning.estimate.selection import Selection
from harness.tuning.estimate.windows import Stretch, fitted_stretches, stretches_of

_MOST = 12  # blocks: of many, so many are taken evenly
_NEAR = 8  # evaluations of a fit that begins at the values fitted to everything
_FEWEST = 3  # cells of the known part, for the two numbers of a start


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
        left_out: number of blocks that the engine as it was does not run through, or that have too few readings.
    """

    blocks: tuple[int, ...]
    before: FloatArray
    after: FloatArray
    predicted: tuple[Predicted, ...] = ()
    left_out: int = 0

    def untuned(self) -> HeldOutErrors:
        """The same of an engine that stays as it was."""
        predicted = tuple(replace(one, after=one.before) for one in self.predicted)
        return replace(self, after=self.before, predicted=predicted)

    @property
    def margin(self) -> Margin | None:
        """By how much tuning lowers the RMS error [m]; `None` for too few blocks."""
        return None if len(self.blocks) < FEWEST else rms_reduction(self.before, self.after)


def held_out_errors(
    model: Model, windows: Sequence[Stretch], selection: Selection, progress: Progress = silent
) -> HeldOutErrors | None:
    """Errors on held-out blocks before and after; `None` where there is none that the engine runs through.

    The tuned parameters are fitted anew for every group of blocks that is held out together.

    Args:
        windows: that they were fitted to; others, which the engine does not run through, are not fitted to here either.
    """
    every = list(enumerate(blocks_of(model.problem.recordings)))
    if not every:
        return None
    chosen = evenly_chosen(every, _MOST)
    groups = [list(group) for _, group in groupby(chosen, key=lambda one: one[1].group)]
    count = len(groups)
    jobs = [partial(_group, model.alone, windows, selection, [each for _, each in group]) for group in groups]

    def tell(done: int) -> None:
        progress(f"held-out blocks: group {done} of {count}", share=done / count)

    found = side_by_side(jobs, model.jobs, tell) if model.executor is None else gathered(model.executor, jobs, tell)
    pairs = [pair for group in found for pair in group]
    kept = [(*one, *pair) for one, pair in zip(chosen, pairs, strict=True) if pair is not None]
    if not kept:
        return None
    return HeldOutErrors(
        tuple(number for number, *_ in kept),
        np.array([before.error for *_, before, _ in kept]),
        np.array([after.error for *_, after in kept]),
        tuple(
            Predicted(block.held_out[0].recording.name, before.time, before.position, after.position)
            for _, block, before, after in kept
            if len(before.time)
        ),
        left_out=len(chosen) - len(kept),
    )


@dataclass(frozen=True)
class _OfBlock:
    """Of one block.

    Attributes:
        error: RMS over its windows [m].
        time, position: in the first of them, shape (m,) each [s], [m].
        run_through: whether the engine ran through all of them.
    """

    error: float
    time: FloatArray
    position: FloatArray
    run_through: bool


def _group(
    model: Model, windows: Sequence[Stretch], selection: Selection, blocks: Sequence[Block]
) -> list[tuple[_OfBlock, _OfBlock] | None]:
    """Each of these blocks before and after; `None` where the engine as it was does not run through it.

    Where only the tuned engine fails, its error is what tuning has done.
    """
    problem, values = without_predicted(model.problem, blocks), selection.found.values
    rest = [one for one in fitted_stretches(problem) if _is_among(one, windows)]
    if selection.pays and rest:
        fitted = fit(replace(model, problem=problem), rest, selection.found.free, values, iterations=_NEAR)
        values = fitted.values
    made: list[tuple[_OfBlock, _OfBlock] | None] = []
    for block in blocks:
        before = _as_it_was(model, block, selection)
        if before is None:
            made.append(None)
        else:
            made.append((before, _of_block(model, block, values) if selection.pays else before))
    return made


def _as_it_was(model: Model, block: Block, selection: Selection) -> _OfBlock | None:
    """A block before tuning; `None` where it has too few readings, or the engine does not run through it."""
    if not _stretches(model, block):
        return None
    try:
        before = _of_block(model, block, selection.before.values)
    except EngineFailure:
        return None
    return before if before.run_through else None


def _is_among(one: Stretch, windows: Sequence[Stretch]) -> bool:
    """Whether a window of fewer readings, which may begin and end elsewhere by a second, is one of these."""
    middle = 0.5 * (one.time[0] + one.time[-1])
    return any(
        one.recording.name == other.recording.name and other.time[0] <= middle <= other.time[-1] for other in windows
    )


def _stretches(model: Model, block: Block) -> list[Stretch]:
    """The windows of a block that hold readings enough, in both of their parts."""
    spans = [(window.begin, window.begin + KNOWN + AHEAD) for window in block.held_out]
    found = stretches_of(model.problem, block.held_out[0].recording, spans)
    return [one for one in found if (~_ahead(one)).sum() >= _FEWEST and _ahead(one).any()]


def _ahead(window: Stretch) -> NDArray[np.bool_]:
    """Cells of the predicted part, shape (m,)."""
    return window.time >= window.begin + KNOWN


def _of_block(model: Model, block: Block, values: Values) -> _OfBlock:
    """Error and positions of a block, from starts fitted to the known part of each of its windows.

    Raises:
        EngineFailure: the engine fails in a known part.
    """
    stretches = _stretches(model, block)
    known = [one.part(~_ahead(one)) for one in stretches]
    starts = fit(model, known, [], {}, fixed=values).starts
    runs = model.runs(stretches, [(values, starts)])[0]
    error = rms(np.array([rms((one.reading - run)[_ahead(one)]) for one, run in zip(stretches, runs, strict=True)]))
    # Up to where the next block begins: where windows have too few readings, the first one left may begin later.
    end = block.held_out[0].begin + KNOWN + AHEAD
    first, run = stretches[0], runs[0]
    shown = _ahead(first) & (first.time < end)
    through = all(bool(np.isfinite(known_positions(one)).all()) for one in runs)
    return _OfBlock(error, first.time[shown], known_positions(run)[shown], through)
