"""Parameters that are for predictions alone: fitted to forecasts, where physics is missing for certain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.identify.estimate.block_errors import block_errors, groups_of
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.forecast_fit import fit_forecasts
from harness.identify.estimate.free_run_fit import fit_free_runs
from harness.identify.estimate.predictions import as_predicted
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import fitted_windows
from harness.identify.selection.candidates import common_effects, predicts_poorly, selected_effects
from harness.identify.selection.criterion import Criterion
from harness.identify.validation.baseline_comparison import AFTER, FORECASTS, BaselineComparison
from harness.metrics.bootstrap import FEWEST
from harness.progress import Progress, silent

_BLOCKS_FOR_EACH = 2  # parameters and process noise: of fewer blocks a fit to forecasts learns the errors by heart


def fitted_to_forecasts(problem: Problem, found: Fit, progress: Progress = silent) -> Fit | None:
    """The fit to forecasts of all windows, with its errors of held-out blocks and the band of its predictions.

    It has the effects found. Where none was found it has those that are common on measured rigs, as what they have in
    common with what acts may help a prediction though no single one is surely there; with too few blocks for these,
    the quantities of the rig alone that are not known, or the process noise alone where all are.

    `None` where what was found by likelihood lacks nothing that the readings show, or predicts as well as a complete
    model would; where there are too few blocks; for curves and values that recordings have of their own, which a few
    windows tell nothing about; and where the windows do not tell how sure the parameters are.

    Each fit without blocks begins, as those to free runs do, from the values of the fit to all.

    Args:
        found: fit to all recordings, with the identified terms.
    """
    if found.hypothesis.own or found.hypothesis.spline:
        return None
    if found.estimator is Estimator.LIKELIHOOD:
        lacks = not Criterion(problem.settings).below_noise_floor(problem, found)
        if not (lacks and predicts_poorly(problem, found)):
            return None
    blocks = sum(len(each) for _, each in groups_of(problem.recordings))
    hypotheses = [found.hypothesis]
    if not selected_effects(problem, found):
        hypotheses.insert(0, Hypothesis((*problem.unknown, *common_effects(problem))))
    enough = [one for one in hypotheses if one.size(problem) <= blocks / _BLOCKS_FOR_EACH - 1.0 and not one.own]
    if blocks < FEWEST or not enough:
        return None
    progress("parameters for predictions: fits to forecasts")
    hypothesis, windows = enough[0], fitted_windows(problem.recordings)
    begin = found
    if hypothesis != found.hypothesis:
        begin = fit_free_runs(problem, hypothesis, windows, initial=found.values()).fit
    whole = fit_forecasts(problem, begin, windows)
    if not np.all(np.isfinite(whole.covariance)):
        return None
    foretold = as_predicted(problem, replace(begin, estimator=Estimator.FORECASTS))
    return replace(whole, travel=foretold.travel, band=foretold.band, forecast_errors=foretold.forecast_errors)


def for_predictions(problem: Problem, found: Fit) -> Fit:
    """The fit with which predictions are made: what was found, or the fit to forecasts if it predicts better.

    As a diagnosis has them, for who does not compare with the baselines too.
    """
    fitted = fitted_to_forecasts(problem, found)
    if fitted is None:
        return found
    compared = BaselineComparison({AFTER: block_errors(problem, found), FORECASTS: block_errors(problem, fitted)})
    return fitted if compared.predicting == FORECASTS else found
