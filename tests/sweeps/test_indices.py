"""Sobol' indices: those of a function whose indices are known, and none where runs failed."""

from __future__ import annotations

import numpy as np
import pytest
from SALib.sample import sobol
from SALib.test_functions import Ishigami

from analytic.motion import FloatArray
from harness.sweeps.indices import indices_of

NAMES = ["x1", "x2", "x3"]
# Ishigami and Homma, 1990, with a = 7, b = 0.1 (SALib's defaults): first order and total, analytically.
A, B = 7.0, 0.1
VARIANCE = A**2 / 8 + B * np.pi**4 / 5 + B**2 * np.pi**8 / 18 + 0.5
FIRST = np.array([0.5 * (1 + B * np.pi**4 / 5) ** 2, A**2 / 8, 0.0]) / VARIANCE
TOTAL = FIRST + np.array([1.0, 0.0, 1.0]) * B**2 * np.pi**8 * (1 / 18 - 1 / 50) / VARIANCE


def ishigami(seed: int, size: int = 512) -> FloatArray:
    """Values at SALib's sample of it."""
    problem = {"num_vars": 3, "names": NAMES, "bounds": [[-np.pi, np.pi]] * 3}
    return Ishigami.evaluate(sobol.sample(problem, size, calc_second_order=False, seed=seed))


def test_known_indices_lie_in_their_intervals() -> None:
    """Find those of Ishigami's function: of 20 seeds times 6 intervals of 95 %, hardly any misses the truth.

    Intervals by bootstrap treat Sobol' points as independent and are wide: with independent misses at 5 %, more than 14
    of 120 would have a probability below 1 in 1000.
    """
    missed = 0
    for seed in range(20):
        found = indices_of("cam", "y", {}, NAMES, ishigami(seed), seed=seed).factors
        assert [one.factor for one in found] == NAMES
        for one, first, total in zip(found, FIRST, TOTAL, strict=True):
            missed += abs(one.first - first) > one.first_half
            missed += abs(one.total - total) > one.total_half
    assert missed <= 14


def test_base_samples_with_a_failed_run_are_left_out() -> None:
    """Leave few out, and say how many; give no indices where they are many."""
    values = ishigami(0)
    values[[0, 7, 8]] = np.nan  # in the first two of 512 base samples, of five runs each
    found = indices_of("cam", "y", {}, NAMES, values, seed=0)
    assert (found.dropped, found.base_samples) == (2, 512)
    assert found.factors[0].first == pytest.approx(FIRST[0], abs=0.15)
    values[: 5 * 60] = np.nan
    assert "60 of 512 base samples have a failed run" in indices_of("cam", "y", {}, NAMES, values, seed=0).reason


def test_an_output_that_is_constant_has_no_indices() -> None:
    """Say so instead of dividing by its variance."""
    assert "the same in all runs" in indices_of("cam", "y", {}, NAMES, np.ones(5 * 8), seed=0).reason
