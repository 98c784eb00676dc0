"""Comparison of the model with the baselines on held-out blocks: all predict 3 s from the 2 s before them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.block_errors import block_errors, groups_of
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.travel import ANYWHERE, travel_of
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import fitted_windows
from harness.identify.validation.baselines import BLACK_BOXES, FITS
from harness.metrics.bootstrap import FEWEST, Margin, rms_reduction
from harness.numerics import rms
from harness.progress import Progress, silent

BEFORE, AFTER, FORECASTS = "before", "after", "fitted_to_forecasts"
BASELINES = tuple(FITS)


@dataclass(frozen=True)
class BaselineComparison:
    """RMS error of every held-out block by source, shape (blocks,) each [m].

    Sources are the model before and after, the model fitted to forecasts where there is such a fit, and the baselines.
    """

    errors: Mapping[str, FloatArray]

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return len(self.errors[AFTER])

    @cached_property
    def predicting(self) -> str:
        """The source with which predictions are made: after, or fitted to forecasts if that predicts better.

        Whether it surely does is not asked: nothing is claimed of the rig by either, held-out errors count parameters
        by themselves, and whichever has the lower one is expected to predict better.
        """
        if FORECASTS not in self.errors or self.blocks < FEWEST:
            return AFTER
        return FORECASTS if self.rms(FORECASTS) < self.rms(AFTER) else AFTER

    @property
    def best_simple_baseline(self) -> str:
        """The baseline of least RMS error that is no black box."""
        return min((name for name in BASELINES if name not in BLACK_BOXES), key=self.rms)

    def rms(self, source: str) -> float:
        """RMS error of a source over all blocks, equally weighted [m]."""
        return rms(self.errors[source])

    def margin(self, baseline: str) -> Margin | None:
        """Reduction of the RMS error from a baseline to the model that predicts [m]; `None` for too few blocks."""
        return None if self.blocks < FEWEST else rms_reduction(self.errors[baseline], self.errors[self.predicting])

    def won(self, baseline: str) -> int:
        """Number of blocks that the model predicts better than a baseline."""
        return int(np.sum(self.errors[self.predicting] < self.errors[baseline]))


def compare_with_baselines(
    problem: Problem, base: Fit, found: Fit, forecasting: Fit | None = None, progress: Progress = silent
) -> BaselineComparison | None:
    """Errors of the model, before and after, and of the baselines on held-out blocks; `None` without any block.

    For each group of blocks that are held out together, every source is fitted to the same windows, from a fit to all.
    Where predictions of the model are kept within a travel, so are those of every source.

    Args:
        base, found: fits to all recordings, without and with the identified terms.
        forecasting: fit to forecasts with its held-out errors, where there is one.
    """
    groups = groups_of(problem.recordings)
    if not groups:
        return None
    progress("baselines: the model without held-out blocks")
    after = block_errors(problem, found)
    if found.hypothesis == base.hypothesis and found.estimator is base.estimator:
        before = after
    else:
        as_found = base if found.travel == ANYWHERE else replace(base, travel=found.travel, held_out=())
        before = block_errors(problem, as_found)
    errors = {BEFORE: before, AFTER: after}
    if forecasting is not None:
        errors[FORECASTS] = block_errors(problem, forecasting)
    for name, fit in FITS.items():
        progress(f"baselines: {name.replace('_', ' ')}")
        of_blocks = []
        whole = fit(fitted_windows(problem.recordings))
        for fitted, blocks in groups:
            baseline = fit(fitted, near=whole)
            travel = ANYWHERE if found.travel == ANYWHERE else travel_of(fitted)
            for block in blocks:
                predicted = [travel.kept(baseline.predict(one), one.reading[one.known]) for one in block.held_out]
                each = [window.rms_error(one) for window, one in zip(block.held_out, predicted, strict=True)]
                of_blocks.append(rms(np.array(each)))
        errors[name] = np.array(of_blocks)
    return BaselineComparison(errors)
