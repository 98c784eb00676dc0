"""The step of a sensor follows from the values it gave."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.recording import inferred_resolution

RNG = np.random.default_rng(6)
TIME = np.arange(1600) * 0.01
MOTION = 0.05 * np.sin(0.9 * TIME) + 0.02 * np.sin(2.3 * TIME)


def counted(values: np.ndarray, step: float, offset: float = 0.0) -> np.ndarray:
    """Values of a sensor of resolution `step`."""
    return np.round((values - offset) / step) * step + offset


@given(step=st.floats(1e-4, 4e-3), offset=st.floats(-1.0, 1.0))
@settings(max_examples=60, deadline=None)
def test_counts_with_any_offset(step: float, offset: float) -> None:
    """Find the step of an encoder wherever its zero lies."""
    # The offset costs digits: an ulp of 1 over the smallest step, 2e-12, bounds the relative error.
    assert inferred_resolution(counted(MOTION, step, offset)) == pytest.approx(step, rel=1e-9)


@pytest.mark.parametrize("decimals", [4, 5, 7])
def test_print_rounding(decimals: int) -> None:
    """Find the paper's encoder count through printed decimals."""
    step = 2 * np.pi / 4096
    printed = np.round(counted(MOTION, step), decimals)
    # Each of some 90 levels is off by up to half a digit; a line through them has its slope within digit / span.
    tolerance = 10.0**-decimals / np.ptp(MOTION)
    assert inferred_resolution(printed) == pytest.approx(step, abs=tolerance)


def test_unit_conversion() -> None:
    """Find the step of degrees printed to four decimals and converted to radians."""
    degrees = np.round(np.degrees(MOTION) + RNG.normal(0, 0.01, len(MOTION)), 2)
    assert inferred_resolution(np.radians(degrees)) == pytest.approx(np.radians(0.01), rel=1e-9)


def test_levels_that_never_occurred() -> None:
    """Find the step although most levels never occur."""
    values = np.cumsum(RNG.integers(2, 9, size=300)) * 1.22e-4
    assert inferred_resolution(values) == pytest.approx(1.22e-4, rel=1e-9)


def test_noise_printed_to_decimals() -> None:
    """Return the last printed digit if noise hides any coarser step."""
    values = np.round(MOTION + RNG.normal(0, 3e-4, len(MOTION)), 4)
    assert inferred_resolution(values) == pytest.approx(1e-4, rel=1e-9)


@pytest.mark.parametrize(
    "values",
    [MOTION, RNG.normal(size=1600), np.full(100, 0.3), np.full(100, np.nan), np.array([]), np.array([0.0, 0.1, 0.2])],
    ids=("smooth", "noise", "constant", "unknown", "empty", "few"),
)
def test_no_step(values: np.ndarray) -> None:
    """Return None for unquantised or too few values."""
    assert inferred_resolution(values) is None
