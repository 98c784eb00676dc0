"""Fits to forecasts: the truth where physics is complete, and what predicts better where it is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from harness.identify.estimate.fit import Estimator, Fit, fit
from harness.identify.estimate.forecast_fit import fit_forecasts
from harness.identify.estimate.window_errors import window_errors
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.windows import fitted_windows
from harness.numerics import TWO_SIDED, rms
from tests.posed import Posed, pose

ROLLING, TRUE = "rolling_resistance", 0.004


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> tuple[Posed, Fit]:
    """A rig whose ball rolls with a resistance that is not declared, and the fit by likelihood."""
    posed = pose(tmp_path_factory.mktemp("rolling") / "case", 3, {ROLLING: {"coefficient": TRUE}})
    return posed, fit(posed.problem, Hypothesis((ROLLING,)))


def moved(posed: Posed, found: Fit, factor: float) -> Fit:
    """The fit with its friction `factor` times as large."""
    theta = factor * found.theta
    return replace(found, theta=theta, terms=found.hypothesis.terms(theta, posed.problem))


@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_complete_physics_is_found_again(rolling: tuple[Posed, Fit], factor: float) -> None:
    """End at the friction of the plant, within its interval, from half and from one and a half of it.

    A forecast weighs the readings less well than the likelihood: its standard error is larger, but not ten times.
    """
    posed, found = rolling
    made = fit_forecasts(posed.problem, moved(posed, found, factor), fitted_windows(posed.problem.recordings))
    key = (ROLLING, "coefficient")
    error = made.deviations()[key]
    assert abs(made.values()[key] - TRUE) < TWO_SIDED * error
    assert found.deviations()[key] < error < 0.1 * TRUE
    assert made.estimator is Estimator.FORECASTS


def test_windows_are_predicted_better_than_before(rolling: tuple[Posed, Fit]) -> None:
    """Predict the windows that it is fitted to with a smaller error than the values that it began with."""
    posed, found = rolling
    windows = fitted_windows(posed.problem.recordings)
    begun = moved(posed, found, 1.5)
    made = fit_forecasts(posed.problem, begun, windows)
    before, after = (rms(np.array(window_errors(posed.problem, one, windows))) for one in (begun, made))
    assert after < 0.5 * before
