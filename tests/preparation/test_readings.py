"""Readings of fast sensors are used in means, which tell as much of the ball."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.preparation.readings import used_readings
from harness.signals.ball_state import BallEstimate

NOISE = 3e-4  # of a reading [m]
EVERY = 15  # readings in a mean, at 1 kHz


def estimate(time: FloatArray, path: FloatArray) -> BallEstimate:
    """A smoothed path [m], at these stamps [s], of which nothing else matters."""
    n = len(time)
    return BallEstimate(
        time=time,
        position=path,
        velocity=np.gradient(path, time),
        residual=np.zeros(n),
        covariance=np.zeros((n, 3, 3)),
        noise=NOISE,
        noise_estimated=True,
        trusted=np.ones(n, dtype=bool),
    )


def swing(time: FloatArray) -> FloatArray:
    """A ball that swings by 0.3 m at half a hertz: up to 3 m/s² and 0.9 m/s [m]."""
    return 0.3 * np.sin(np.pi * time)


def test_slow_readings_stay_as_they_are() -> None:
    """Use each with its own noise."""
    time = np.arange(500) / 100
    reading = swing(time) + NOISE * np.random.default_rng(0).standard_normal(500)
    used = used_readings(estimate(time, swing(time)), reading, NOISE, 1)
    assert (used.every, used.noise) == (1, NOISE)
    np.testing.assert_array_equal(used.position, reading)


def test_means_scatter_about_the_path_by_the_noise_they_state() -> None:
    """Of 15 readings with white noise, a fifteenth of the variance; on the path at their stamp, not late or early."""
    time = np.arange(40_001) / 1000
    reading = swing(time) + NOISE * np.random.default_rng(1).standard_normal(len(time))
    used = used_readings(estimate(time, swing(time)), reading, NOISE, EVERY)
    off = (used.position - swing(time))[used.stamps]
    assert np.isfinite(off).all()
    # The variance of m means is known within √(2/m) of it, their mean within one deviation over √m; four of these.
    m = len(off)
    assert used.noise**2 == pytest.approx(NOISE**2 / 15, rel=4 * math.sqrt(2 / m))
    assert np.mean(off**2) == pytest.approx(used.noise**2, rel=4 * math.sqrt(2 / m))
    assert abs(np.mean(off)) < 4 * used.noise / math.sqrt(m)
    # Late by one row they would be off by 0.9 m/s · 1 ms · cos, whose slope on the velocity is 1 ms.
    speed = np.gradient(swing(time), time)[used.stamps]
    late = float(speed @ off / (speed @ speed))
    assert abs(late) < 4 * used.noise / math.sqrt(float(speed @ speed)) < 1e-4


def test_neither_missing_readings_nor_uneven_stamps_shift_a_mean() -> None:
    """Without noise, means are on the path where a third of the readings is missing and stamps are off by 0.3 ms."""
    random = np.random.default_rng(2)
    time = np.arange(10_000) / 1000 + random.uniform(-3e-4, 3e-4, 10_000)
    reading = np.where(random.random(10_000) < 1 / 3, np.nan, swing(time))
    used = used_readings(estimate(time, swing(time)), reading, 0.0, 9)
    known = np.isfinite(used.position)
    assert known.sum() > 0.95 * len(time) / used.every
    np.testing.assert_allclose(used.position[known], swing(time)[known], rtol=0.0, atol=1e-12)


def test_an_offset_of_the_smoothed_path_does_not_matter() -> None:
    """A path that is smoothed wrongly by 5 mm gives the same means: readings decide where the ball is."""
    time = np.arange(10_000) / 1000
    reading = swing(time) + NOISE * np.random.default_rng(3).standard_normal(len(time))
    right, wrong = (used_readings(estimate(time, swing(time) + off), reading, NOISE, EVERY) for off in (0.0, 5e-3))
    np.testing.assert_allclose(wrong.position, right.position, rtol=0.0, atol=1e-12)


def test_the_mean_of_coloured_noise_is_not_taken_for_better_than_it_is() -> None:
    """Noise correlated over 20 ms stays nearly whole in means over 15 ms: more than 0.8 of its deviation."""
    random, rho, n = np.random.default_rng(4), math.exp(-1 / 20), 40_001
    noise = np.empty(n)
    noise[0] = random.standard_normal()
    for k in range(1, n):
        noise[k] = rho * noise[k - 1] + math.sqrt(1 - rho**2) * random.standard_normal()
    time = np.arange(n) / 1000
    used = used_readings(estimate(time, swing(time)), swing(time) + NOISE * noise, NOISE, EVERY)
    # The mean over T = 15 ms keeps 2 (x - 1 + e^-x)/x² of the variance, x = T/20 ms: 0.79, known within 5 %.
    assert used.noise == pytest.approx(math.sqrt(0.79) * NOISE, rel=0.1)
