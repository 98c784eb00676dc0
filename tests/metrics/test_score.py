"""One record says everything about one source on one horizon."""

from dataclasses import asdict, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.metrics import METRICS, RunComparison, horizon_name, score

TIME = np.arange(0.0, 16.0, 0.01)


def run(time=TIME, *, gain=1.0, late=0.0, offset=0.0, noise=0.0, clock=0.0):
    """A measured ball and a model with known errors."""
    rng = np.random.default_rng(0)

    def position(t):
        return 0.1 * np.sin(0.4 * np.pi * t) + 0.03 * np.sin(1.1 * np.pi * t)

    def velocity(t):
        return 0.04 * np.pi * np.cos(0.4 * np.pi * t) + 0.033 * np.pi * np.cos(1.1 * np.pi * t)

    return RunComparison(
        time=time + clock,
        measured=0.3 + position(time) + noise * rng.normal(size=time.size),
        model=0.3 + offset + gain * position(time - late),
        measured_velocity=velocity(time),
        model_velocity=gain * velocity(time - late),
        uncertainty=np.full(time.shape, 0.002),
    )


def metrics(record):
    """The metrics of a score by name."""
    return {name: getattr(record, name) for name in METRICS}


def test_offset_shows_where_it_should():
    """Report an offset of 4 mm in mm, in the paper's integral, over the uncertainty, and not in velocity or lag."""
    record = score("cam", run(offset=0.004))
    assert (record.source, record.horizon, record.windows, record.samples) == ("cam", "whole", 1, 1600)
    assert record.duration_s == pytest.approx(15.99)
    assert record.max_error_m == pytest.approx(0.004)
    assert record.rms_error_mm == pytest.approx(4.0)
    assert record.e_disp_m_s == pytest.approx(0.004 * 15.99)
    assert record.end_error_median_mm == record.end_error_max_mm == pytest.approx(4.0)
    assert record.fit_percent == pytest.approx(100.0 * (1.0 - 0.004 / np.std(run().measured)))
    assert record.max_velocity_error_m_s == record.e_vel_m == 0.0
    assert record.lag_ms == pytest.approx(0.0, abs=1e-3)
    assert record.fraction_outside_tube == 0.0
    assert score("cam", run(offset=0.004), tolerance=0.003).fraction_outside_tube == 1.0
    assert record.rms_error_over_uncertainty == pytest.approx(2.0)
    assert np.isnan(record.rms_error_standard_error_mm)


def test_gain_and_delay_are_told_apart():
    """Report a gain as magnitude and a delay as lag."""
    assert score("cam", run(gain=1.1)).sprague_geers_magnitude == pytest.approx(0.1, abs=1e-9)
    assert score("cam", run(gain=1.1)).lag_ms == pytest.approx(0.0, abs=1e-3)
    assert score("cam", run(late=0.04)).lag_ms == pytest.approx(40.0, abs=1e-3)


def test_perfect_model_has_the_best_of_everything():
    """Give 0, 100 % and "excellent" to a model that is the measurement."""
    record = score("truth", run())
    assert record.rms_error_mm == record.e_disp_m_s == record.e_vel_m == record.sprague_geers_combined == 0.0
    assert record.fit_percent == 100.0
    assert record.iso18571_rating == pytest.approx(1.0, abs=1e-11)
    assert record.iso18571_rank == "excellent"


@settings(max_examples=15, deadline=None)
@given(st.floats(-1e3, 1e3))
def test_clock_does_not_matter(clock):
    """Give the same score for any offset of the time stamps."""
    expected, shifted = (metrics(score("cam", run(late=0.02, gain=1.05, noise=5e-4, clock=c))) for c in (0.0, clock))
    # rounding of the stamps may move one noisy stamp (2 mm at 4σ) at either end in or out of the lag's overlap:
    # e ċ / Σ ċ² = 0.002 m / (1500 · 0.1 m/s) = 0.013 ms each
    assert shifted.pop("lag_ms") == pytest.approx(expected.pop("lag_ms"), abs=0.03)
    # stamps near 1000 s carry 1e-13 s against steps of 0.01 s: 1e-11, times up to 1e3 samples in the ISO grid
    assert shifted == pytest.approx(expected, rel=1e-8, nan_ok=True)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.8))
def test_blanks_are_as_if_never_recorded(seed, share):
    """Give the same score whether unknown stamps are NaN, masked as outliers, or absent from the errors."""
    lost = np.random.default_rng(seed).random(TIME.size) < share
    full = run(late=0.02, gain=1.05, noise=5e-4)
    blank = replace(full, measured=np.where(lost, np.nan, full.measured))
    outliers = replace(full, measured=np.where(lost, 99.0, full.measured), use=~lost)
    assert metrics(score("cam", blank)) == pytest.approx(metrics(score("cam", outliers)), rel=0, abs=0, nan_ok=True)
    assert score("cam", blank).rms_error_mm == pytest.approx(1e3 * np.sqrt(np.mean((full.error[~lost]) ** 2)))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_integrals_do_not_depend_on_the_sampling(seed):
    """Give the paper's integrals, Sprague and Geers' errors and the lag of the motion, not of the stamps."""
    # 1700 gaps last 17 ± 0.19 s: no seed leaves half a second without stamps before the end
    gaps = np.random.default_rng(seed).uniform(0.002, 0.018, 1700)
    inner = np.cumsum(gaps)
    uneven = np.concatenate(([0.0], inner[inner < 15.98], [15.99]))
    even, scattered = (score("cam", run(time, late=0.02, gain=1.05)) for time in (TIME, uneven))
    # ∫|e|dt with steps h <= 18 ms: T h²/12 max|ë| = 1.6e-5 m s at ë ≈ 0.036 m/s², and h² |ė|/8 at about 25 kinks
    assert scattered.e_disp_m_s == pytest.approx(even.e_disp_m_s, abs=6e-5)
    # trapezoids err by T h²/12 max|d²(m²)/dt²| <= 4.3e-4 s · 0.1 m²/s² on ∫m² = 0.087 m² s, alike for m and c
    assert scattered.sprague_geers_magnitude == pytest.approx(even.sprague_geers_magnitude, abs=5e-4)
    assert scattered.sprague_geers_phase == pytest.approx(even.sprague_geers_phase, abs=5e-4)
    assert scattered.lag_ms == pytest.approx(even.lag_ms, abs=1e-3)


def cut(whole, seconds):
    """The run cut into windows of equal length."""
    window = np.floor(whole.time / seconds + 1e-9).astype(int)
    arrays = {k: v for k, v in asdict(whole).items() if v is not None}
    return [RunComparison(**{k: v[window == w] for k, v in arrays.items()}) for w in range(window.max() + 1)]


def test_windows_pool_to_the_whole():
    """Give the same errors over all stamps whether in one piece or in many, integrals less the seams."""
    whole = run(late=0.02, gain=1.05, noise=5e-4)
    one, many = score("cam", whole), score("cam", cut(whole, 2.0), horizon=horizon_name(2.0))
    assert (many.horizon, many.windows, many.samples) == ("2 s", 8, one.samples)
    for name in ("max_error_m", "rms_error_mm", "rms_velocity_error_m_s", "rms_error_over_uncertainty"):
        assert getattr(many, name) == pytest.approx(getattr(one, name))
    seams = 7 * 0.01
    assert many.duration_s == pytest.approx(one.duration_s - seams)
    assert 0.0 <= one.e_disp_m_s - many.e_disp_m_s <= seams * one.max_error_m
    assert many.rms_error_standard_error_mm > 0.0


def test_window_ends_are_summed_up_by_median_and_maximum():
    """Report where predictions of one length end up: typically and at worst."""
    time = np.linspace(0.0, 1.0, 11)
    windows = [RunComparison(time=time, measured=time, model=time * (1.0 + error)) for error in (0.01, -0.02, 0.06)]
    record = score("cam", windows, horizon=horizon_name(1.0))
    assert record.end_error_median_mm == pytest.approx(20.0)
    assert record.end_error_max_mm == pytest.approx(60.0)


def test_fit_of_windows_is_against_the_mean_of_each():
    """Compare each window's errors with the motion in that window only."""
    time = np.linspace(0.0, 1.0, 11)
    ramp = 0.1 * time
    windows = [RunComparison(time=time, measured=ramp + k, model=ramp + k + 0.01) for k in range(5)]
    assert score("cam", windows).fit_percent == pytest.approx(100.0 * (1.0 - 0.01 / np.std(ramp)))


def test_run_away_model_meets_no_limit():
    """Give a diverged model infinite errors instead of raising."""
    whole = run()
    model = whole.model.copy()
    model[-100:] = np.nan
    record = score("friction_printed", replace(whole, model=model))
    assert record.max_error_m == record.rms_error_mm == record.e_disp_m_s == np.inf
    assert record.fit_percent == -np.inf
    assert record.fraction_outside_tube == pytest.approx(100 / 1600)
    assert record.iso18571_rank == "undefined"
    for name in ("max_error_m", "fit_percent", "sprague_geers_magnitude", "lag_ms", "iso18571_rating"):
        assert not METRICS[name].meets(getattr(record, name), 0.0)


def test_unknown_velocity_and_uncertainty_leave_nan():
    """Give NaN, not 0, for metrics whose inputs are missing."""
    record = score("cam", RunComparison(time=TIME, measured=run().measured, model=run().model))
    assert np.isnan([record.e_vel_m, record.max_velocity_error_m_s, record.rms_velocity_error_m_s]).all()
    assert np.isnan([record.rms_error_over_uncertainty, record.fraction_within_uncertainty]).all()


def test_single_known_position_is_scored():
    """Score a window with one known position: errors there, no integral, no relative metric."""
    measured = np.full(5, np.nan)
    measured[3] = 0.1
    record = score("cam", RunComparison(time=np.arange(5.0), measured=measured, model=np.full(5, 0.11)))
    assert record.rms_error_mm == pytest.approx(10.0)
    assert record.duration_s == record.e_disp_m_s == 0.0
    assert np.isnan([record.fit_percent, record.sprague_geers_magnitude, record.lag_ms, record.iso18571_rating]).all()


def test_no_window_is_refused():
    """Refuse an empty list of windows."""
    with pytest.raises(ValueError, match="no window"):
        score("cam", [])
