"""The lag is found to a fraction of a sample, and not invented where the motion does not tell it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.metrics.lag import lag

TIME = np.arange(0.0, 16.0, 0.01)


def motion(time, late=0.0):
    """A ball that oscillates by 0.1 m with a period of 4 s, not quite harmonically [m]."""
    t = time - late
    return 0.3 + 0.1 * np.sin(0.5 * np.pi * t) + 0.04 * np.sin(1.3 * np.pi * t + 1.0)


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.2, 0.2))
def test_delayed_sine_is_late_by_its_delay(late):
    """Find a pure delay, positive if the model is late, far below the sampling step."""
    # the cubic spline errs by 5/384 h⁴ |s''''| = 1.3e-10 · (0.1 · 6 + 0.04 · 278) m < 2e-9 m at speeds of 0.2 m/s
    assert lag(TIME, motion(TIME), TIME, motion(TIME, late)) == pytest.approx(late, abs=1e-6)


@pytest.mark.parametrize("step", [0.005, 0.05, 0.1])
def test_coarse_sampling_still_tells_milliseconds(step):
    """Find 40 ms to well under 1 ms, even from a sensor at 10 Hz."""
    time = np.arange(0.0, 16.0, step)
    # at h = 0.1 s the spline errs by at most 1.5e-5 m inside, typically at 0.2 m/s: 0.08 ms
    assert lag(time, motion(time), time, motion(time, 0.04)) == pytest.approx(0.04, abs=1e-4)


@given(gain=st.floats(0.2, 5.0), start=st.floats(-1.0, 1.0), speed=st.floats(-0.1, 0.1), level=st.floats(-0.02, 0.02))
@settings(max_examples=20, deadline=None)
def test_gain_and_drift_are_no_lag(gain, start, speed, level):
    """Keep the lag apart from a gain and from the drift of a free run: start state, constant angle error."""
    model = gain * motion(TIME, 0.03) + start + speed * TIME + 0.5 * level * TIME**2
    # the spline's 2e-9 m as above; drifts of up to 4 m leave 1e-15 m; the search stops at 1e-8 s
    assert lag(TIME, motion(TIME), TIME, model) == pytest.approx(0.03, abs=1e-6)


def test_lag_survives_blanks_and_uneven_stamps():
    """Find the lag on uneven stamps with gaps."""
    rng = np.random.default_rng(3)
    time = np.cumsum(rng.uniform(0.005, 0.015, 1500))
    valid = rng.random(time.size) < 0.6
    # h <= 15 ms: 5/384 h⁴ |s''''| < 1e-8 m at 0.2 m/s
    assert lag(time[valid], motion(time[valid]), time, motion(time, -0.025)) == pytest.approx(-0.025, abs=1e-6)


@given(st.floats(-1e3, 1e3))
@settings(max_examples=10, deadline=None)
def test_clock_does_not_matter(shift):
    """Give the same lag whenever the clock was started."""
    expected = lag(TIME, motion(TIME), TIME, motion(TIME, 0.05))
    # stamps near 1000 s carry 1e-13 s, which moves which stamps count by at most one at either end
    assert lag(TIME + shift, motion(TIME), TIME + shift, motion(TIME, 0.05)) == pytest.approx(expected, abs=1e-6)


def test_noise_scatters_the_lag_as_theory_says():
    """Scatter by no more than the Cramér–Rao bound allows for, under white noise."""
    rng = np.random.default_rng(5)
    noise = 0.002
    found = np.array(
        [lag(TIME, motion(TIME) + rng.normal(0.0, noise, TIME.size), TIME, motion(TIME, 0.04)) for _ in range(60)]
    )
    inner = TIME[50:-50]
    speed = np.gradient(motion(inner), inner)
    bound = noise / np.sqrt(inner.size * np.var(speed))  # least possible standard deviation, 0.27 ms
    # sample deviation of 60 draws is known to 9 %; drift and gain fitted beside cost a little: 1.5 allows both
    assert np.std(found) < 1.5 * bound
    assert abs(np.mean(found) - 0.04) < 4.0 * 1.5 * bound / np.sqrt(60)


@pytest.mark.parametrize(
    ("measured", "model"),
    [
        (lambda t: 0.3 + 0 * t, lambda t: motion(t)),
        (lambda t: motion(t), lambda t: 0.3 + 0 * t),
        (lambda t: 0.3 + 0.1 * t, lambda t: 0.3 + 0.11 * t),
        (lambda t: 0.3 + 0.05 * t**2, lambda t: 0.31 + 0.06 * t**2),
    ],
    ids=["rest", "model at rest", "steady rolling", "steady acceleration"],
)
def test_motion_that_does_not_tell_gives_no_lag(measured, model):
    """Give NaN if a lag is equivalent to another start state."""
    assert np.isnan(lag(TIME, measured(TIME), TIME, model(TIME)))


def test_noise_at_rest_gives_no_lag():
    """Give NaN, not a chance shift, when sensor noise meets a model that creeps."""
    rng = np.random.default_rng(7)
    for _ in range(50):
        noise, creep = rng.normal(0.0, 5e-4, TIME.size), 1e-5 * np.cumsum(rng.normal(size=TIME.size))
        assert np.isnan(lag(TIME, noise, TIME, creep))


@pytest.mark.parametrize(("noise", "told"), [(0.006, True), (0.06, False)])
def test_lag_that_noise_hides_is_not_told(noise, told):
    """Give the lag of 25 noisy readings if they tell it to a twentieth of a second, else NaN."""
    # σ/(√n A ω/√2) is 0.014 s and 0.14 s at ω = 1.2 rad/s, against a tenth of the range of 0.5 s
    for seed in range(10):
        time = np.arange(0.0, 16.0, 0.6)
        measured = 0.1 * np.sin(1.2 * time) + np.random.default_rng(seed).normal(0.0, noise, time.size)
        found = lag(time, measured, TIME, 0.1 * np.sin(1.2 * (TIME - 0.04)))
        assert np.isnan(found) != told
        assert not told or abs(found - 0.04) < 4.0 * 0.014


def test_lag_beyond_the_search_is_not_told():
    """Give NaN, not the end of the range, for a model 0.8 s late."""
    assert np.isnan(lag(TIME, motion(TIME), TIME, motion(TIME, 0.8), max_lag=0.5))


def test_run_away_model_has_no_lag():
    """Give NaN for a diverged model."""
    model = motion(TIME)
    model[-1] = np.inf
    assert np.isnan(lag(TIME, motion(TIME), TIME, model))
