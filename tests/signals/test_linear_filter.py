"""Linear filters, against scipy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from harness.signals.linear_filter import linear_filter


@pytest.mark.parametrize("count", [1, 2, 3, 400])
def test_a_filter_is_that_of_scipy(count: int) -> None:
    """Filter as scipy does to rounding, signals shorter than the filter's memory too."""
    B, F = np.array([0.5, -0.2, 0.1]), np.poly([0.98, 0.9 + 0.2j, 0.9 - 0.2j])
    signals = np.random.default_rng(0).normal(size=(count, 2))
    np.testing.assert_allclose(linear_filter(B, F, signals), lfilter(B, F, signals, axis=0), rtol=1e-9, atol=1e-9)
