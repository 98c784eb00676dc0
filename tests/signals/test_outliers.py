from __future__ import annotations

import math

import numpy as np
import pytest

from harness.signals.outliers import smooth_spiky
from tests.signals.known_angles import rms

TIME = np.arange(0.0, 10.0, 0.01)
TRUTH = 0.3 + 0.1 * np.sin(1.5 * TIME) + 0.02 * np.sin(4.0 * TIME)
NOISE = 5e-4


def readings(seed: int, spikes: float, low: float, high: float):
    """TRUTH with noise, and a share of spikes between `low` and `high` [m]; which ones they are."""
    generator = np.random.default_rng(seed)
    value = TRUTH + NOISE * generator.standard_normal(len(TIME))
    hit = generator.random(len(TIME)) < spikes
    value[hit] += generator.uniform(low, high, int(hit.sum()))
    return value, hit


@pytest.mark.parametrize(("low", "high"), [(-0.05, -0.01), (-0.05, 0.05)])
@pytest.mark.parametrize("spikes", [0.02, 0.2])
def test_core_is_followed_and_not_the_mean(spikes, low, high):
    """Keep to the core, within its error bars, though up to a fifth of the readings drop out, to one side or both."""
    for seed in range(3):
        value, hit = readings(seed, spikes, low, high)
        found = smooth_spiky(TIME, value)
        error = found.smoothed.mean[:, 0] - TRUTH
        deviation = np.sqrt(found.smoothed.covariance[:, 0, 0])
        # About 60 independent errors in a record: their RMS scatters by 1/√120 = 9 % about 1; spikes within the core
        # (a uniform draw on ±50 mm puts 4 % of them within 2 mm) add a little.
        assert rms(error / deviation) < 1.5
        assert math.sqrt(found.noise.core) == pytest.approx(NOISE, rel=0.15)
        distinct = np.abs(value - TRUTH) > 8.0 * NOISE
        assert np.all(found.core[hit & distinct] < 0.5)
        assert np.mean(found.core[~hit] > 0.5) > 0.98


def test_offset_of_one_sided_spikes_is_found():
    """Report where the spikes lie and how many there are."""
    value, hit = readings(0, 0.2, -0.05, -0.03)
    found = smooth_spiky(TIME, value)
    # 200 spikes of deviation 20 mm/√12: their mean is known to 0.4 mm; 2 readings' worth of prior pull it by 1 %.
    assert found.noise.offset == pytest.approx(-0.04, abs=2e-3)
    assert found.noise.share == pytest.approx(hit.mean(), rel=0.05)


def test_no_spikes_are_found_where_there_are_none():
    """Leave a clean record alone: noise right, nothing distrusted, error bars that cover."""
    scores = []
    for seed in range(6):
        value, _ = readings(seed, 0.0, 0.0, 0.0)
        found = smooth_spiky(TIME, value)
        assert math.sqrt(found.noise.core) == pytest.approx(NOISE, rel=0.08)  # 1/√(2n) = 2.2 %, times 3.5
        assert np.mean(found.core > 0.5) > 0.995
        scores.append(rms((found.smoothed.mean[:, 0] - TRUTH) / np.sqrt(found.smoothed.covariance[:, 0, 0])))
    assert 0.7 < np.mean(scores) < 1.3


def test_long_record_corrects_a_declared_noise_and_a_short_one_does_not():
    """Trust 1000 readings over a declaration that is 20 times too high, and the declaration over 8 readings."""
    value, _ = readings(0, 0.0, 0.0, 0.0)
    corrected = smooth_spiky(TIME, value, declared=20 * NOISE)
    # 20 readings' worth of (20 σ)² among 1000 of σ²: √(1 + 0.02 · 400) σ = 3 σ, where 20 σ was declared.
    assert math.sqrt(corrected.noise.core) < 3.2 * NOISE
    few = np.where(np.arange(len(TIME)) < 8, value, np.nan)
    assert math.sqrt(smooth_spiky(TIME, few, declared=NOISE).noise.core) == pytest.approx(NOISE, rel=0.2)


def test_rounding_is_the_least_noise():
    """Assume no less noise than the rounding makes, in a record that rests on one count."""
    found = smooth_spiky(TIME, np.full(len(TIME), 0.3), least=1e-3)
    assert math.sqrt(found.noise.core) == pytest.approx(1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_noise_that_varies_over_the_range_is_no_spike(seed):
    """Take a sensor of 0.3 mm here and 0.8 mm there for what it is: noise, of which nothing is dropped."""
    generator = np.random.default_rng(seed)
    deviation = np.where(TRUTH < 0.3, 3e-4, 8e-4)
    found = smooth_spiky(TIME, TRUTH + deviation * generator.standard_normal(len(TIME)), declared=6e-4)
    assert not found.noise.stands_apart
    # A thousand readings: their mean square is known to √(2/1000) = 4.5 %, its root to 2.3 %; four of these.
    assert math.sqrt(found.noise.total) == pytest.approx(rms(deviation), rel=0.1)


def test_drop_outs_to_one_side_stand_apart():
    """Keep drop-outs apart from noise, so that readings which say nothing of the ball are not held against a model."""
    value, _ = readings(0, 0.1, -0.05, -0.03)
    assert smooth_spiky(TIME, value).noise.stands_apart
