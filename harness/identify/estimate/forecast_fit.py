"""Fit of a hypothesis to forecasts: to the predicted part of windows, whose known part the filter has read.

Parameters by likelihood, or by free runs with starts of their own, tell about forces. What predicts seconds best may be
others: a forecast also has the error of the state that it begins with, and where a controller moves the beam, what the
model lacks is seen in the angle. Least squares over the horizon of the prediction (multi-step prediction errors: Shook,
Mohtadi and Shah, IEE Proc. D 138, 1991) weigh all of it. Their parameters are for predictions alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from analytic.motion import FloatArray
from harness.identify.estimate.band import AS_FORESEEN
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.screening import INSIDE
from harness.identify.estimate.soft_l1 import sandwich_covariance, scale_of, weights
from harness.identify.estimate.travel import ANYWHERE
from harness.identify.estimate.window_errors import DENSITIES, forecast_errors, tuned_to_windows
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Window

_WIDTH, _WIDTH_OF_DENSITY = 0.05, 0.2  # of the Jacobian's differences: scaled parameters; log₁₀ of the process noise
_CONVERGED = 1e-3  # relative decrease of the loss, and change of the parameters
_MOST_STEPS = 30


def fit_forecasts(problem: Problem, begin: Fit, windows: Sequence[Window]) -> Fit:
    """The hypothesis of `begin`, its parameters and process noise fitted to forecasts of `windows`.

    The loss is the soft L1, with c of the errors that `begin` makes. A hypothesis without parameters gets the process
    noise alone, which begins at the best of a grid: where a sensor's steps are followed closely is a local minimum.

    Args:
        begin: a fit without a spline term, and without values that recordings have of their own.
    """
    begin = replace(begin, travel=ANYWHERE, forecast_errors=())  # predictions that are kept at an end tell no slope
    if not len(begin.theta):
        begin = tuned_to_windows(problem, begin, windows)
    hypothesis = begin.hypothesis
    lowest, highest = np.log10(DENSITIES[[0, -1]])
    low, high = hypothesis.bounds(problem)
    low, high = np.append(low, lowest), np.append(high, highest)
    widths = np.append(np.full(len(begin.theta), _WIDTH), _WIDTH_OF_DENSITY)

    def at(x: FloatArray) -> Fit:
        terms = hypothesis.terms(x[:-1], problem)
        return replace(begin, theta=x[:-1], terms=terms, process_noise=float(10.0 ** x[-1]))

    def errors(x: FloatArray) -> FloatArray:
        return np.concatenate(forecast_errors(problem, at(x), windows))

    def jacobian(x: FloatArray) -> FloatArray:
        here, columns = errors(x), []
        for i, width in enumerate(widths):
            step = np.zeros(len(x))
            step[i] = width if x[i] + width <= high[i] else -width
            columns.append((errors(x + step) - here) / step[i])
        return np.column_stack(columns)

    start = np.append(begin.theta, np.log10(begin.process_noise))
    start = np.clip(start, low + INSIDE, high - INSIDE)
    scale = scale_of(errors(start))
    done = least_squares(
        errors, start, jacobian, (low, high), x_scale="jac", loss="soft_l1", f_scale=scale,
        ftol=_CONVERGED, xtol=_CONVERGED, max_nfev=_MOST_STEPS,
    )  # fmt: skip
    weight = weights(done.fun, scale)
    slopes = jacobian(done.x)[:, :-1] * weight[:, None]  # at this process noise
    begins = np.cumsum([0, *(int(window.judged.sum()) for window in windows[:-1])])
    scores = np.add.reduceat(slopes * (weight * done.fun)[:, None], begins, axis=0)
    return replace(
        at(done.x),
        covariance=sandwich_covariance(slopes, scores, hypothesis.scale(problem)),
        deviance=np.nan,
        quiet_deviance=np.inf,
        estimator=Estimator.FORECASTS,
        held_out=(),
        band=AS_FORESEEN,
    )
