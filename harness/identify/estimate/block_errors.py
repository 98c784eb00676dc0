"""Errors of the model on blocks of recordings that it is not fitted to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.cross_validation import fit_without
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.forecast_fit import fit_forecasts
from harness.identify.estimate.refit import refit
from harness.identify.estimate.travel import ANYWHERE, travel_of
from harness.identify.estimate.window_errors import tuned_to_windows, window_errors
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import Block, Window, block_groups, of_windows, without_predicted
from harness.numerics import rms
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
        part = fit_without_blocks(problem, whole, fitted, blocks)
        return tuned_to_windows(problem, part, fitted) if whole.estimator is Estimator.LIKELIHOOD else part, blocks

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


def fit_without_blocks(problem: Problem, whole: Fit, fitted: Sequence[Window], blocks: Sequence[Block]) -> Fit:
    """A fit without these blocks; its travel, where the whole fit has one, is that of the windows it is fitted to.

    Args:
        whole: the fit to all recordings.
        fitted: windows to fit to.
        blocks: that are held out together.
    """
    part = _refitted_without(problem, whole, fitted, blocks)
    return part if whole.travel == ANYWHERE else replace(part, travel=travel_of(fitted))


def _refitted_without(problem: Problem, whole: Fit, fitted: Sequence[Window], blocks: Sequence[Block]) -> Fit:
    if whole.estimator is Estimator.FREE_RUNS:
        return replace(fit_without(problem, whole, fitted), process_noise=whole.process_noise)
    if whole.estimator is Estimator.FORECASTS:
        return fit_forecasts(of_windows(problem, fitted), whole, fitted)
    return refit(without_predicted(problem, blocks), whole)
