"""The ISO/TS 18571 rating equals the published implementation, and the standard's formulas where they can be solved."""

import time
from statistics import median

import numpy as np
import pytest

from harness.metrics.iso18571 import best_shift, even_grid, rank, rate, smoothed_slope

# Both sides sum at most 2e3 terms in different orders: 2e3 ε = 4e-13 relative, on ratings of at most 1.
SAME = 1e-11


def oracle(measured, model):
    """Ratings of the package of the Vehicle Safety Institute, TU Graz."""
    module = pytest.importorskip(
        "objective_rating_metrics.rating", reason="the published package objective-rating-metrics is not installed"
    )
    grid = 0.01 * np.arange(len(measured))
    rating = module.ISO18571(np.column_stack((grid, measured)), np.column_stack((grid, model)), dt=0.01)
    return (
        rating.overall_rating(-1),
        rating.corridor_rating(-1),
        rating.phase_rating(-1),
        rating.magnitude_rating(-1),
        rating.slope_rating(-1),
    )


def random_pair(rng, samples):
    """A ball under a random drive, and a model that is off in gain, timing, shape and drift."""
    measured = 1e-3 * np.cumsum(np.cumsum(rng.normal(size=samples)))
    model = np.roll(measured, rng.integers(-samples // 4, samples // 4 + 1))
    model = rng.normal(1.0, 0.3) * model + rng.normal(0.0, 0.2) * measured[rng.permutation(samples)] * rng.integers(2)
    return measured + 1e-3 * rng.normal(size=samples), model + 1e-2 * rng.random() * rng.normal(size=samples)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_ratings_equal_the_published_package(seed):
    """Give its overall rating and its four parts over random signals of many lengths."""
    rng = np.random.default_rng(seed)
    for samples in (11, 12, 15, 19, 20, 21, *rng.integers(22, 300, 10)):
        measured, model = random_pair(rng, int(samples))
        assert rate(measured, model) == pytest.approx(oracle(measured, model), abs=SAME)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_ratings_equal_the_package_on_quantised_signals(seed):
    """Follow it along the same warp where a coarse sensor makes many warps equally good."""
    rng = np.random.default_rng(100 + seed)
    for samples in rng.integers(30, 200, 8):
        measured, model = (np.round(signal / 0.01) * 0.01 for signal in random_pair(rng, int(samples)))
        assert rate(measured, model) == pytest.approx(oracle(measured, model), abs=SAME)


@pytest.mark.slow
def test_ratings_equal_the_package_on_a_long_recording():
    """Agree on 16 s at 100 Hz."""
    measured, model = random_pair(np.random.default_rng(42), 1600)
    assert rate(measured, model) == pytest.approx(oracle(measured, model), abs=SAME)


def test_perfect_model_is_rated_one():
    """Rate a model that equals the measurement 1 in all parts, even where it repeats itself exactly."""
    # five periods: shifts by one period correlate perfectly too, and must not be preferred
    signal = np.sin(2.0 * np.pi * np.arange(500) / 100.0)
    assert rate(signal, signal) == pytest.approx((1.0,) * 5, abs=SAME)


@pytest.mark.parametrize(("offset", "expected"), [(0.04, 1.0), (0.2, (0.3 / 0.45) ** 2), (0.6, 0.0)])
def test_corridor_of_an_offset(offset, expected):
    """Rate a constant offset by ((b₀ − d)/(b₀ − a₀))², d over the largest measured value."""
    measured = np.sin(np.linspace(0.0, 0.5 * np.pi, 200))
    assert rate(measured, measured + offset).corridor == pytest.approx(expected, abs=SAME)


@pytest.mark.parametrize("shift", [-20, -3, 0, 7, 39, 40])
def test_phase_falls_linearly_with_the_shift(shift):
    """Rate k samples of shift in n by 1 − k/(0.2 n), either way, and find its sign: positive is late."""
    pulse = np.exp(-0.5 * ((np.arange(400) - 200) / 25.0) ** 2)
    measured, model = pulse[100:300], pulse[100 - shift : 300 - shift]
    assert best_shift(measured, model) == shift
    assert rate(measured, model).phase == pytest.approx(1.0 - abs(shift) / 40.0, abs=SAME)


def test_slope_of_a_gain():
    """Rate a slope that is 50 % too large by 1 − 0.5/2."""
    measured = np.sin(np.linspace(0.0, 6.0, 300))
    # a gain moves no correlation, so nothing is shifted
    assert rate(measured, 1.5 * measured).slope == pytest.approx(0.75, abs=SAME)


def test_smoothed_slope_of_a_parabola():
    """Keep the derivative of a parabola: central differences and symmetric means are exact for it."""
    index = np.arange(50.0)
    slope = smoothed_slope(index**2)
    assert slope[5:-5] == pytest.approx(2.0 * index[5:-5], abs=1e-10)


@pytest.mark.parametrize(
    ("rating", "name"),
    [
        (1.0, "excellent"),
        (0.95, "excellent"),
        (0.94, "good"),
        (0.81, "good"),
        (0.80, "fair"),
        (0.59, "fair"),
        (0.58, "poor"),
        (0.0, "poor"),
        (float("nan"), "undefined"),
    ],
)
def test_ranks_have_the_limits_of_the_standard(rating, name):
    """Rank by 0.94, 0.80 and 0.58, each belonging to the worse side."""
    assert rank(rating) == name


@pytest.mark.parametrize(
    ("measured", "model"),
    [(np.zeros(100), np.ones(100)), (np.arange(10.0), np.arange(10.0)), (np.arange(50.0), np.full(50, np.inf))],
    ids=["rest", "too short", "run away"],
)
def test_undefined_ratings_are_nan(measured, model):
    """Return UNDEFINED for short, constant or non-finite signals."""
    assert np.isnan(rate(measured, model)).all()


def test_stuck_model_counts_as_not_shifted():
    """Rate a model at rest although it correlates at no shift."""
    measured = 0.1 * np.sin(np.linspace(0.0, 6.0, 300))
    stuck = rate(measured, np.zeros(300))
    assert stuck.phase == 1.0
    assert stuck.magnitude == 0.0
    # |0 − T| over |T| is 1, half of the largest slope error
    assert stuck.slope == pytest.approx(0.5, abs=SAME)


def test_even_grid_keeps_even_samples_and_fills_blanks():
    """Leave an even record as it is and bridge a blank by a straight line."""
    grid = np.array([0.0, 0.1, 0.2, 0.5, 0.6])
    measured, model = even_grid(grid, 2.0 * grid, -grid)
    even = np.linspace(0.0, 0.6, 7)
    assert measured == pytest.approx(2.0 * even, abs=1e-15)
    assert model == pytest.approx(-even, abs=1e-15)


def test_long_recording_takes_milliseconds():
    """Rate 16 s at 100 Hz in under 50 ms of processor time once compiled."""
    measured, model = random_pair(np.random.default_rng(1), 1600)
    rate(measured, model)

    def seconds() -> float:
        begin = time.process_time()
        rate(measured, model)
        return time.process_time() - begin

    assert median(seconds() for _ in range(5)) < 0.05
