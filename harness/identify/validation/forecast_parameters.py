"""Parameters that are for predictions alone: fitted to forecasts, where what was found predicts poorly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.identify.estimate.block_errors import group_fits, groups_of
from harness.identify.estimate.cross_validation import widened
from harness.identify.estimate.fit import TWO_SIDED, Estimator, Fit
from harness.identify.estimate.forecast_fit import fit_forecasts
from harness.identify.estimate.window_errors import normalised_errors, window_errors
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import fitted_windows
from harness.identify.selection.candidates import predicts_poorly
from harness.metrics.bootstrap import FEWEST
from harness.numerics import rms
from harness.progress import Progress, silent

_BLOCKS_FOR_EACH = 2  # parameters and process noise: of fewer blocks a fit to forecasts learns the errors by heart


def fitted_to_forecasts(problem: Problem, found: Fit, progress: Progress = silent) -> Fit | None:
    """The fit to forecasts of all windows, with its errors of held-out blocks and the band of its predictions.

    `None` where what was found predicts as well as a complete model would, where there are too few blocks, and for
    curves and values that recordings have of their own, which a few windows tell nothing about.

    Args:
        found: fit to all recordings, with the identified terms.
    """
    groups = groups_of(problem.recordings)
    count = sum(len(blocks) for _, blocks in groups)
    hypothesis = found.hypothesis
    if count < max(FEWEST, _BLOCKS_FOR_EACH * (len(found.theta) + 1)) or hypothesis.own or hypothesis.spline:
        return None
    if not len(found.theta) or not predicts_poorly(problem, found):
        return None
    progress("parameters for predictions: fits to forecasts")
    whole = fit_forecasts(problem, found, fitted_windows(problem.recordings))
    parts = group_fits(problem, replace(found, estimator=Estimator.FORECASTS))
    held = [(part, block) for part, blocks in parts for block in blocks]
    errors = [rms(np.array(window_errors(problem, part, block.held_out))) for part, block in held]
    ratios = [np.abs(normalised_errors(problem, part, block.held_out)) for part, block in held]
    return replace(whole, held_out=tuple(errors), band=widened(ratios) / TWO_SIDED)
