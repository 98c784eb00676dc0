"""The sensors read what their data sheets say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import chi2

from harness.simulator import Encoder, Laser

MANY = 20_000


def generator() -> np.random.Generator:
    """Noise with a fixed seed."""
    return np.random.default_rng(1)


def test_encoder_counts_1024_lines_in_quadrature() -> None:
    """Round to 4096 counts a turn: whole counts, never off by more than half a one."""
    angle = np.linspace(-0.06, 0.06, MANY)
    read = Encoder().measure(angle, generator())
    counts = read / (2 * math.pi / 4096)
    np.testing.assert_allclose(counts, np.rint(counts), atol=1e-12)
    # half a count, and the rounding of a comparison
    assert np.max(np.abs(read - angle)) <= math.pi / 4096 * (1 + 1e-12)
    assert len(np.unique(np.rint(counts))) == 2 * round(0.06 / Encoder().resolution) + 1


def test_encoder_noise_dithers_the_count() -> None:
    """Read the mean angle between counts when noise of half a count shakes the encoder."""
    encoder = Encoder(noise=0.5 * Encoder().resolution)
    angle = 0.3 * encoder.resolution
    read = encoder.measure(np.full(MANY, angle), generator())
    # bias of a dithered quantiser: (1/π) exp(−2 π² σ²) = 0.0023 counts at σ = 0.5; the mean's own spread is
    # √(σ² + 1/12)/√n = 0.0041 counts, of which four
    assert np.mean(read) == pytest.approx(angle, abs=(0.0023 + 4 * 0.0041) * encoder.resolution)


@pytest.mark.parametrize(("position", "deviation"), [(0.3, 0.3e-3), (0.3999, 0.3e-3), (0.4, 0.8e-3), (0.55, 0.8e-3)])
def test_laser_noise_is_the_data_sheets(position: float, deviation: float) -> None:
    """Spread by 0.3 mm below 400 mm and by 0.8 mm from there on, rounded to 0.1 mm."""
    read = Laser().measure(np.full(MANY, position), generator())
    # rounding adds resolution²/12; the variance of n Gaussian readings is χ² distributed
    expected = deviation**2 + (0.1e-3) ** 2 / 12
    low, high = chi2.ppf([1e-4, 1 - 1e-4], MANY - 1) / (MANY - 1)
    assert low < np.var(read, ddof=1) / expected < high
    np.testing.assert_allclose(read / 1e-4, np.rint(read / 1e-4), atol=1e-9)


def test_laser_reads_nothing_out_of_range() -> None:
    """Leave positions outside 200–600 mm unread instead of inventing a value."""
    read = Laser().measure(np.array([0.19, 0.2, 0.4, 0.6, 0.61]), generator())
    assert np.isnan(read).tolist() == [True, False, False, False, True]
