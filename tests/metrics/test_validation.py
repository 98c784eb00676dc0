"""Errors are compared with the validation uncertainty."""

import numpy as np
import pytest

from harness.metrics.bootstrap import rms_standard_error
from harness.metrics.errors import (
    fraction_within_uncertainty,
    rms_error_over_uncertainty,
    validation_uncertainty,
)


def test_uncertainties_add_as_squares():
    """Combine sensor noise with a propagated angle error."""
    time = np.array([0.0, 1.0, 2.0])
    total = validation_uncertainty(0.003, 0.002 * time**2)
    assert total == pytest.approx([0.003, np.sqrt(0.003**2 + 0.002**2), np.sqrt(0.003**2 + 0.008**2)])


def test_perfect_model_errs_by_its_uncertainty():
    """Give a ratio of 1 and a share of 95.4 % if the errors equal the uncertainty, however fast it grows."""
    rng = np.random.default_rng(2)
    n = 20_000
    uncertainty = validation_uncertainty(0.0005, np.linspace(0.0, 0.05, n))
    error = uncertainty * rng.normal(size=n)
    # deviations: 1/√(2n) = 0.005 of the ratio, √(0.954 · 0.046/n) = 0.0015 of the share; 4 of them
    assert rms_error_over_uncertainty(error, uncertainty) == pytest.approx(1.0, abs=0.02)
    assert fraction_within_uncertainty(error, uncertainty) == pytest.approx(0.9545, abs=0.006)


def test_wrong_model_stands_out():
    """Give a ratio of 3 for a model error of three uncertainties."""
    uncertainty = np.array([0.001, 0.002, 0.004])
    assert rms_error_over_uncertainty(3.0 * uncertainty, uncertainty) == pytest.approx(3.0)
    assert fraction_within_uncertainty(3.0 * uncertainty, uncertainty) == 0.0


def test_standard_error_of_the_pooled_rms():
    """Find by resampling what theory says for normal errors: RMS/√(2W) for W windows."""
    rng = np.random.default_rng(4)
    windows = 400
    # one draw a window, held over its 5 stamps: stamps are no independent draws, windows are
    errors = [np.full(5, value) for value in rng.normal(0.0, 0.01, windows)]
    # χ²₁ has kurtosis 15: its sample variance scatters by √(14/W) = 19 %, the standard error by half of that; the RMS
    # by 3.5 %, resampling by 1.6 %: together 10 %
    assert rms_standard_error(errors) == pytest.approx(0.01 / np.sqrt(2.0 * windows), rel=3 * 0.10)


def test_standard_error_is_repeatable_and_weighs_by_length():
    """Give the same figure for the same errors, 0 if windows agree, and none for a single window."""
    errors = [np.array([0.01, 0.02]), np.array([0.03]), np.array([0.00, 0.01, 0.05])]
    assert rms_standard_error(errors) == rms_standard_error(errors) > 0.0
    assert rms_standard_error([np.full(n, 0.01) for n in (1, 5, 9)]) == pytest.approx(0.0, abs=1e-15)
    assert np.isnan(rms_standard_error(errors[:1]))
    assert np.isnan(rms_standard_error([np.array([np.inf]), np.array([0.0])]))
