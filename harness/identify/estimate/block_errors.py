"""Errors of the model on blocks of recordings that it is not fitted to, and the band of predictions by them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.band import Foreseen, fitted_band
from harness.identify.estimate.cross_validation import fit_without
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.forecast_fit import fit_forecasts
from harness.identify.estimate.refit import refit
from harness.identify.estimate.travel import ANYWHERE, travel_of
from harness.identify.estimate.window_errors import foreseen_errors, tuned_to_windows, window_errors
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import Block, Window, block_groups, fitted_windows, of_windows, without_predicted
from harness.numerics import rms
from harness.parallel import side_by_side
from harness.threads import in_threads

Groups = list[tuple[tuple[Window, ...], list[Block]]]
"""Windows to fit to, and the blocks that are held out together."""


def groups_of(recordings: Sequence[PreparedRecording]) -> Groups:
    """Blocks by the windows to fit to while they are held out."""
    return [(blocks[0].fitted, blocks) for blocks in block_groups(recordings)]


def group_fits(problem: Problem, whole: Fit) -> list[tuple[Fit, list[Block]]]:
    """The fit repeated without each group of blocks, and these blocks.

    One to free runs is repeated on the windows to fit to, with the process noise of the whole fit. One by likelihood is
    repeated without the readings that are to be predicted, and gets the process noise that predicts these windows best.
    One to forecasts is made on the windows to fit to, from the values of the whole fit.

    Args:
        whole: the fit to all recordings.
    """

    def without(group: tuple[tuple[Window, ...], list[Block]]) -> tuple[Fit, list[Block]]:
        fitted, blocks = group
        return _fit_without(problem, whole, fitted, blocks), blocks

    return in_threads(without, groups_of(problem.recordings))


def block_errors(problem: Problem, whole: Fit) -> FloatArray:
    """RMS error of every block by a fit without the blocks of its group, shape (blocks,) [m].

    Args:
        whole: the fit to all recordings; if it was cross-validated, it brings its errors along.
    """
    if kept := whole.forecast_errors or whole.held_out:
        return np.array(kept)
    return np.array(
        [
            rms(np.array(window_errors(problem, part, block.held_out)))
            for part, blocks in group_fits(problem, whole)
            for block in blocks
        ]
    )


def as_predicted(problem: Problem, found: Fit, *, jobs: int = 1) -> Fit:
    """A fit that lacks physics, with travel, band and errors of its predictions, by fits without what is held out.

    It takes as long as a cross-validation, and is asked of one fit alone. Where nothing can be held out, it has the
    travel alone.

    Args:
        jobs: processes for the fits without a group of blocks.
    """
    groups = groups_of(problem.recordings)
    kept = replace(found, travel=travel_of(fitted_windows(problem.recordings)))
    if not groups:
        return kept
    blocks = list(chain.from_iterable(side_by_side([partial(_foreseen, problem, kept, *one) for one in groups], jobs)))
    return foretold(kept, blocks, problem.reading_variance)


def foretold(found: Fit, blocks: Sequence[Foreseen], reading_variance: float) -> Fit:
    """A fit with the band and the errors of its predictions.

    Args:
        blocks: of each held-out block, by a fit without it.
        reading_variance: of a reading's noise [m²].
    """
    errors = tuple(rms(block.error) for block in blocks)
    return replace(found, band=fitted_band(blocks, reading_variance), forecast_errors=errors)


def _foreseen(problem: Problem, whole: Fit, fitted: Sequence[Window], blocks: Sequence[Block]) -> list[Foreseen]:
    """Errors of each of the blocks that are held out together, and what a fit without them foresees."""
    part = _fit_without(problem, whole, fitted, blocks)
    if whole.estimator is Estimator.LIKELIHOOD:
        part = replace(part, process_noise=whole.process_noise)
    return [foreseen_errors(problem, part, block.held_out) for block in blocks]


def _fit_without(problem: Problem, whole: Fit, fitted: Sequence[Window], blocks: Sequence[Block]) -> Fit:
    """A fit without these blocks; its travel, where the whole fit has one, is that of what it is fitted to."""
    part = _refitted_without(problem, whole, fitted, blocks)
    return part if whole.travel == ANYWHERE else replace(part, travel=travel_of(fitted))


def _refitted_without(problem: Problem, whole: Fit, fitted: Sequence[Window], blocks: Sequence[Block]) -> Fit:
    if whole.estimator is Estimator.FREE_RUNS:
        return replace(fit_without(problem, whole, fitted), process_noise=whole.process_noise)
    if whole.estimator is Estimator.FORECASTS:
        return fit_forecasts(of_windows(problem, fitted), whole, fitted)
    rest = without_predicted(problem, blocks)
    return tuned_to_windows(problem, refit(rest, whole), fitted)
