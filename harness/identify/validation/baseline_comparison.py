"""Comparison of the model with the baselines on held-out blocks: all predict 3 s from the 2 s before them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.block_errors import block_errors, groups_of
from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import fitted_windows
from harness.identify.validation.baselines import BLACK_BOXES, FITS
from harness.metrics.bootstrap import FEWEST, Margin, rms_reduction
from harness.numerics import rms
from harness.progress import Progress, silent

BEFORE, AFTER = "before", "after"
BASELINES = tuple(FITS)


@dataclass(frozen=True)
class BaselineComparison:
    """RMS error of every held-out block by source (before, after, and the baselines), shape (blocks,) each [m]."""

    errors: Mapping[str, FloatArray]

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return len(self.errors[AFTER])

    @property
    def best_simple_baseline(self) -> str:
        """The baseline of least RMS error that is no black box."""
        return min((name for name in BASELINES if name not in BLACK_BOXES), key=self.rms)

    def rms(self, source: str) -> float:
        """RMS error of a source over all blocks, equally weighted [m]."""
        return rms(self.errors[source])

    def margin(self, baseline: str) -> Margin | None:
        """Reduction of the RMS error from a baseline to the model after [m]; `None` for too few blocks."""
        return None if self.blocks < FEWEST else rms_reduction(self.errors[baseline], self.errors[AFTER])

    def won(self, baseline: str) -> int:
        """Number of blocks that the model after predicts better than a baseline."""
        return int(np.sum(self.errors[AFTER] < self.errors[baseline]))


def compare_with_baselines(
    problem: Problem, base: Fit, found: Fit, progress: Progress = silent
) -> BaselineComparison | None:
    """Errors of the model, before and after, and of the baselines on held-out blocks; `None` without any block.

    For each group of blocks that are held out together, every source is fitted to the same windows, from a fit to all.

    Args:
        base, found: fits to all recordings, without and with the identified terms.
    """
    groups = groups_of(problem.recordings)
    if not groups:
        return None
    progress("baselines: the model without held-out blocks")
    errors = {BEFORE: block_errors(problem, base)}
    same = found.hypothesis == base.hypothesis and found.estimator is base.estimator
    errors[AFTER] = errors[BEFORE] if same else block_errors(problem, found)
    for name, fit in FITS.items():
        progress(f"baselines: {name.replace('_', ' ')}")
        of_blocks = []
        whole = fit(fitted_windows(problem.recordings))
        for fitted, blocks in groups:
            baseline = fit(fitted, near=whole)
            for block in blocks:
                predicted = [window.rms_error(baseline.predict(window)) for window in block.held_out]
                of_blocks.append(rms(np.array(predicted)))
        errors[name] = np.array(of_blocks)
    return BaselineComparison(errors)
