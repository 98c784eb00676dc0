from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import truncnorm

from harness.signals import smooth_rounded
from harness.signals.quantised import _let_turn, _runs, _truncated_normal, rough_noise
from tests.signals.known_angles import encoder, rms, servo_angle

TIME = np.arange(0.0, 16.0, 0.01)


@pytest.mark.parametrize("mean", [0.0, 0.3, -0.9, 2.5, -6.0])
def test_moments_in_the_box_are_those_of_the_truncated_normal(mean):
    """Match scipy's truncated normal in the middle, near the thresholds and deep in either tail."""
    low, high, width = -0.5, 0.5, 0.4
    found = _truncated_normal(mean, width, low, high)
    a, b = (low - mean) / width, (high - mean) / width
    expected = truncnorm.stats(a, b, loc=mean, scale=width, moments="mv")
    assert found[0] == pytest.approx(expected[0], abs=1e-6)
    # In the far tail the variance is a difference of numbers a² times larger: of twelve digits some eight remain.
    assert found[1] == pytest.approx(expected[1], rel=1e-4)


def test_value_beyond_reach_is_put_at_the_nearer_threshold():
    """Stay finite where a count is hundreds of deviations off: the value is taken for just inside the box."""
    mean, variance = _truncated_normal(100.0, 0.1, -0.5, 0.5)
    assert 0.49 < mean < 0.5
    assert 0.0 < variance < 1e-6


def test_runs_are_found_with_their_length():
    """Tell how many equal counts in a row each belongs to and how long they last."""
    many, long = _runs(np.arange(6.0), np.array([1.0, 1.0, 2.0, 2.0, 2.0, 1.0]), 0.5)
    assert many.tolist() == [2, 2, 3, 3, 3, 1]
    assert long.tolist() == [1, 1, 2, 2, 2, 0]


def test_constant_count_says_one_thing_once():
    """Leave a hold as uncertain as a uniform distribution over its count, however often the count is repeated."""
    step = 1e-3
    deviation = []
    for seconds in (1.0, 4.0):
        time = np.arange(0.0, seconds, 0.01)
        smoothed, _, _ = smooth_rounded(time, np.full(len(time), 5 * step), step)
        inner = slice(len(time) // 4, -len(time) // 4)
        assert np.all(np.abs(smoothed.mean[inner, 0] - 5 * step) < 0.02 * step)
        deviation.append(float(np.sqrt(smoothed.covariance[inner, 0, 0].mean())) / step)
    # q/√12 = 0.289 q for a box. A Gaussian that must keep its mass within the box is narrower (a truncated one that
    # loses a tenth of its variance at the edges: 0.23); independent readings would give 0.289/√n < 0.03.
    assert min(deviation) > 0.20
    assert max(deviation) < 0.32


def test_well_dithered_counts_are_white_noise():
    """Come to what white noise of σ² + q²/12 gives, where the noise is as large as the count."""
    truth = servo_angle(2).states(TIME)[:, 0]
    reading, step = encoder(truth, 12800, 1.0)
    counts, _, _ = smooth_rounded(TIME, reading, step, step, density=1.0)
    white, _, _ = smooth_rounded(TIME, reading, 0.0, math.sqrt(1.0 + 1.0 / 12.0) * step, density=1.0)
    # At σ = q the rounding error depends on the value by 2 exp(−2π²) / 2π < 1e-8 of a count: only the settling of the
    # propagation (3e-3 of half a count) and the shape of a single likelihood remain.
    assert rms(counts.mean[:, 0] - white.mean[:, 0]) < 0.02 * step
    ratio = counts.covariance[:, 0, 0] / white.covariance[:, 0, 0]
    assert np.all(np.abs(ratio - 1.0) < 0.05)


@pytest.mark.parametrize("noise", [0.2, 0.5, 3.0])
def test_noise_before_rounding_is_found(noise):
    """Estimate the noise beneath and above the count from the record alone."""
    found = []
    for seed in range(3):
        reading, step = encoder(servo_angle(seed).states(TIME)[:, 0], 4096, noise, seed)
        found.append(smooth_rounded(TIME, reading, step, None)[2] / step)
    # n = 1600 readings tell a deviation to 1/√(2n) = 2 % where each one shows its noise; beneath the count only those
    # near a threshold do, a quarter of the record or less, and holds far from one say nothing.
    assert np.mean(found) == pytest.approx(noise, rel=0.15 if noise < 0.5 else 0.06)


def test_absence_of_noise_is_found():
    """Report no noise for counts that never flicker."""
    for seed in range(4):
        reading, step = encoder(servo_angle(seed).states(TIME)[:, 0], 12800)
        assert smooth_rounded(TIME, reading, step, None)[2] == 0.0


def test_noise_of_a_continuous_reading_is_found():
    """Estimate the noise of a reading that is not rounded at all."""
    truth, n = servo_angle(1).states(TIME)[:, 0], len(TIME)
    found = []
    for seed in range(4):
        reading = truth + 2e-3 * np.random.default_rng(seed).standard_normal(n)
        smoothed, _, noise = smooth_rounded(TIME, reading, 0.0, None)
        taken = np.sum(smoothed.covariance[:, 0, 0]) / noise**2  # degrees of freedom that the signal takes of n
        found.append(noise / math.sqrt(1.0 - taken / n))
    # n readings tell a deviation to 1/√(2n) = 1.8 %; three standard deviations of the mean of four
    assert np.mean(found) == pytest.approx(2e-3, rel=3.0 / math.sqrt(2.0 * n * len(found)))


def test_rough_noise_ignores_motion_and_spikes():
    """Give the noise of a moving signal a tenth of whose readings are wild."""
    generator = np.random.default_rng(0)
    value = 0.2 * np.sin(TIME) + 1e-3 * generator.standard_normal(len(TIME))
    value[generator.random(len(TIME)) < 0.1] += 0.5
    # A wild reading spoils three second differences of 0.3 n: the median then sits at the 0.71 quantile of the good
    # ones, 1.57 times too high. It is a start value, not a result.
    assert 0.9e-3 < rough_noise(value) < 1.8e-3


def test_a_motion_about_a_threshold_is_known_as_well_as_stated() -> None:
    """State the error of a value whose counts go to and fro, which tell when it crosses and not how far it goes."""
    generator, step = np.random.default_rng(4), 1.5e-3
    scores = []
    for _ in range(20):
        # Two to four counts a second, 0.15 to 0.45 of a count to each side of a threshold that is somewhere near.
        rates, sizes = generator.uniform(2.0, 4.0, 3), generator.uniform(0.05, 0.15, 3)
        swings = sizes @ np.sin(2.0 * math.pi * rates[:, None] * TIME + generator.uniform(0.0, 6.3, (3, 1)))
        truth = (generator.uniform(0.45, 0.55) + swings) * step
        smoothed, _, _ = smooth_rounded(TIME, np.rint(truth / step) * step, step)
        scores.append(rms((smoothed.mean[:, 0] - truth) / np.sqrt(smoothed.covariance[:, 0, 0])))
    # The stiffest prior that the crossings allow gives 8 to 11. The density still comes out low, as what is between the
    # crossings speaks for none: 1.3 (at most 2) here, and 1 where the beam moves further.
    assert np.median(scores) < 1.6
    assert max(scores) < 2.3


def test_a_large_motion_may_be_as_stiff_as_it_is() -> None:
    """Ask for no rougher prior where a motion over many counts turns, nor where the value rests on one."""
    knot, lowest = np.arange(len(TIME) - 1), np.full(len(TIME) - 1, -22.0)
    for truth in (0.03 * np.cos(math.pi * TIME), np.zeros(len(TIME)), np.where(TIME > 8.0, 0.03, 0.0)):
        assert np.all(_let_turn(TIME, np.rint(truth / 1e-3) * 1e-3, 0.5e-3, knot, lowest) == lowest)


def test_the_prior_lets_a_value_turn_where_its_counts_do() -> None:
    """Spread by q/√12 over the counts between opposite changes, and pass missing ones over."""
    count = np.repeat([0.0, 1.0, 0.0, 1.0, 2.0], 10)
    count[13] = np.nan
    time = 0.01 * np.arange(50)
    least = _let_turn(time, count, 0.5, np.arange(49), np.full(49, -22.0))
    assert np.all(least[10:30] > -22.0)
    assert np.all(least[[*range(10), *range(30, 49)]] == -22.0)
    assert np.sqrt(np.exp(least[15]) * 0.1**5 / 20.0) == pytest.approx(1.0 / math.sqrt(12.0))


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.0, 1e-9, 1e-7, 1e-6])
@pytest.mark.parametrize("changes", [0, 1, 4])
def test_a_signal_that_stands_still_is_smoothed(step: float, changes: int) -> None:
    """Give finite states of constants and steps that are known exactly, however many stamps there are, and how far
    apart: one in ten was infinite with a noise of a hundredth of a microradian."""
    generator = np.random.default_rng(changes)
    for _ in range(60):
        count = int(generator.integers(10, 300))
        time = generator.uniform(0.0, 60.0) + generator.choice([0.002, 0.01, 0.04, 0.2]) * np.arange(count)
        level = generator.uniform(-0.3, 0.3) + 0.05 * (np.arange(count) * (changes + 1) // count % 2)
        value = np.round(level / step) * step if step else level
        smoothed, _, _ = smooth_rounded(time, value, step, None)
        assert np.isfinite(smoothed.mean).all()
        assert np.isfinite(smoothed.covariance).all()
        if not changes:
            np.testing.assert_allclose(smoothed.mean[:, 0], value, atol=1e-6)  # a count of 1e-6 at most
