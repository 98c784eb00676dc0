"""Whether innovations know the beam's motion."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.validation.beam_dependence import LAGS, SIGNIFICANT, beam_dependence, dependence, joined
from tests.motions import Sines

TIME = np.arange(0.0, 16.0, 0.01)
JUDGED = np.ones(len(TIME), dtype=bool)
RUNS = 200


@pytest.fixture(scope="module")
def inputs() -> FloatArray:
    """A beam angle before each stamp, at every lag."""
    return Sines().evaluate(TIME[LAGS[-1] <= TIME, None] - LAGS)


def test_white_innovations_are_called_dependent_no_more_often_than_promised(inputs: FloatArray) -> None:
    """Call independent noise dependent in one case of a hundred.

    Of 200 runs that is a binomial of mean 2 and deviation 1.4; 8 are four deviations away. And p is uniform: its mean
    over 200 runs stays within four standard errors, 4 × 0.289/√200 = 0.08, of a half.
    """
    generator = np.random.default_rng(0)
    p = np.array([dependence(generator.standard_normal(len(inputs)), inputs).p for _ in range(RUNS)])
    assert np.sum(p < SIGNIFICANT) <= 8
    assert np.mean(p) == pytest.approx(0.5, abs=0.08)


def test_a_correlation_is_found_at_its_lag(inputs: FloatArray) -> None:
    """Find a share of the angle of 0.3 s ago that makes up 2 % of the innovations' power.

    Then χ² is about 0.02 × 1500 readings = 30 above its degrees of freedom, of which two sines leave four; p = 0.01
    needs 13.3 in all.
    """
    generator = np.random.default_rng(1)
    lag = int(np.argmin(np.abs(LAGS - 0.3)))
    before = inputs[:, lag] / inputs[:, lag].std()
    found = dependence(generator.standard_normal(len(inputs)) + np.sqrt(0.02) * before, inputs)
    assert found.p < SIGNIFICANT
    assert found.correlation > 0.0
    assert abs(found.correlation) == pytest.approx(np.sqrt(0.02), abs=4.0 / np.sqrt(len(inputs)))


def test_one_wild_innovation_decides_nothing(inputs: FloatArray) -> None:
    """Let a reading that misses by a thousand standard deviations count as four."""
    ratio = np.random.default_rng(2).standard_normal(len(inputs))
    ratio[700] = 1000.0
    wild = dependence(ratio, inputs)
    ratio[700] = 4.0
    assert wild == dependence(ratio, inputs)


def test_a_beam_that_stands_tells_nothing() -> None:
    """Test nothing where the beam does not move, and say so by no freedom."""
    ratio = np.random.default_rng(3).standard_normal(500)
    found = dependence(ratio, np.full((500, len(LAGS)), 0.02))
    assert (found.freedom, found.p) == (0, 1.0)


def test_too_short_a_recording_is_not_tested() -> None:
    """Test nothing where there is less than a second before any reading."""
    motion = Sines()
    time = TIME[:100]
    found = beam_dependence(time, np.ones(100), JUDGED[:100], motion)
    assert set(found) == {"angle", "rate", "acceleration"}
    assert all(one.freedom == 0 and one.p == 1.0 for one in found.values())


def test_recordings_add_up(inputs: FloatArray) -> None:
    """Add χ² and degrees of freedom of recordings, and keep the largest correlation."""
    generator = np.random.default_rng(4)
    each = [{"angle": dependence(generator.standard_normal(len(inputs)), inputs)} for _ in range(2)]
    both = joined(each)["angle"]
    assert both.statistic == sum(one["angle"].statistic for one in each)
    assert both.freedom == sum(one["angle"].freedom for one in each)
    assert abs(both.correlation) == max(abs(one["angle"].correlation) for one in each)
