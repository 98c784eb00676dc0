"""Intervals of a fit: those of generalised least squares, wider where the model is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from harness.tuning.estimate.fit import Fitted
from harness.tuning.estimate.free import Free
from harness.tuning.estimate.selection import attempt

SLOPE = Free("slope", "1", 0.0, -10.0, 10.0, False, (1.0,))
COUNT = 400


def fitted(residual: np.ndarray, windows: int = 2) -> Fitted:
    """A fit of one parameter whose runs grow with the square root of the reading's number."""
    jacobian = np.sqrt(np.arange(COUNT, dtype=float))[:, None]
    window = np.repeat(np.arange(windows), COUNT // windows)
    starts = np.zeros((windows, 2))
    return Fitted(("slope",), (SLOPE,), {"slope": 1.0}, starts, residual, float(residual @ residual), jacobian, window)


def test_a_complete_model_has_the_interval_of_least_squares() -> None:
    """Give 1/√(JᵀJ) as the standard deviation where residuals are white with variance 1."""
    residual = np.random.default_rng(1).standard_normal(COUNT)
    residual /= 1.05 * np.sqrt(np.mean(residual**2))  # no inflation
    one = fitted(residual)
    assert one.complete
    assert one.deviations[0] == pytest.approx(1.0 / np.sqrt(np.sum(np.arange(COUNT))), rel=1e-12)


def test_residuals_beyond_the_noise_widen_the_interval() -> None:
    """Widen the interval by the ratio of the residuals to what was expected, here ten times."""
    residual = np.random.default_rng(2).standard_normal(COUNT)
    quiet, loud = fitted(residual), fitted(10.0 * residual)
    assert not loud.complete
    # the median of 400 normal residuals has a standard error of 6 %
    assert loud.deviations[0] / quiet.deviations[0] == pytest.approx(10.0, rel=0.2)


def test_windows_that_contradict_each_other_widen_the_interval() -> None:
    """Take the scatter between windows where residuals are alike within each, as missing physics makes them."""
    signs = np.repeat(np.where(np.arange(10) % 2, 1.0, -1.0), COUNT // 10)
    alike, white = fitted(signs, 10), fitted(np.random.default_rng(3).permutation(signs), 10)
    assert alike.deviations[0] > 3.0 * white.deviations[0]


def test_a_parameter_enters_only_if_it_pays_by_more_than_the_criterion() -> None:
    """Ask for a decrease of the deviance by log n + 6, over the factor that widens intervals."""
    residual = np.random.default_rng(4).standard_normal(COUNT)
    with_ = fitted(residual / np.sqrt(np.mean(residual**2)))
    asked = (np.log(COUNT) + 6.0) * with_.inflation
    for more, kept in ((1.01, True), (0.99, False)):
        without = fitted(residual)
        without = Fitted(**{**vars(without), "deviance": with_.deviance + more * asked})
        assert attempt("slope", without, with_, kept=True).kept == kept
