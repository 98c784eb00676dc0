"""Baselines: they find what they can know, and see no more of a window than its beginning."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.signal import lfilter

from analytic.rig import Rig
from harness.identify.pose import problem_of
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import AHEAD, KNOWN, Window, windows_of
from harness.identify.validation.baselines import (
    FITS,
    DoubleIntegrator,
    OutputError,
    fit_at_rest,
    fit_constant_velocity,
    fit_double_integrator,
    fit_output_error,
)
from harness.recording import load_case
from harness.signals.drive import make_drive
from harness.simulator import Experiment, write_case
from tests.posed import Posed

STEP = 0.02  # [s]


@pytest.fixture(scope="module")
def beam() -> PreparedRecording:
    """A beam that swings at three rates for 17 s; the ball is still to be put on it."""
    time = STEP * np.arange(851)
    angle = 0.03 * np.sin(1.1 * time) + 0.02 * np.sin(2.7 * time + 1.0) + 0.01 * np.sin(6.3 * time)
    return PreparedRecording("made", time, np.zeros_like(time), make_drive(time, angle))


def test_windows_tile_the_recording(beam: PreparedRecording) -> None:
    """Predict every reading between 2 s and the last whole window's end once, from the 2 s before its window."""
    windows = windows_of((beam,))
    judged = np.concatenate([beam.time[one.use][one.judged] for one in windows])
    np.testing.assert_array_equal(
        judged, beam.time[(beam.time > KNOWN - 1e-9) & (beam.time < KNOWN + 5 * AHEAD - 1e-9)]
    )
    for one in windows:
        assert one.known.sum() == round(KNOWN / STEP)
        assert one.time[one.known][-1] < one.time[one.judged][0]


def test_a_window_without_readings_is_left_out(beam: PreparedRecording) -> None:
    """Predict nothing from nothing: a gap takes away the windows that begin or end in it."""
    gap = np.where((beam.time >= 3.0) & (beam.time < 5.0), np.nan, beam.reading)
    assert [one.begin for one in windows_of((replace(beam, reading=gap),))] == [0.0, 6.0, 9.0, 12.0]


def test_the_integrator_finds_the_gain_of_a_rolling_ball(tmp_path: Path) -> None:
    """Find K g on a rig of the virtual plant where it is nearly the whole truth.

    What the integrator does not know is d = K (s α̇² − ℓ α̈ + g (sin α − α)), small where the pivot lies such that ℓ = 0.
    Of its double integral D the part along the driven column a, both without what a start and an offset can take, moves
    the gain by at most ‖D‖/‖a‖ (Cauchy-Schwarz); the noise of n readings by σ/‖a‖, of which four are allowed.
    """
    rig = Rig()
    rig = rig.with_(eccentricity=rig.eccentricity - rig.lever)
    truth = write_case(tmp_path / "case", Experiment(rig=rig, predict=0, seed=3))
    problem = problem_of(load_case(tmp_path / "case"))
    windows = windows_of(problem.recordings)
    missed, column = [], []
    for window in windows:
        (told,) = [one for one, record in zip(truth, problem.recordings, strict=True) if record is window.recording]
        s, t = told.position[window.use], window.time
        alpha, rate = (
            window.recording.drive.evaluate(t + window.begin),
            window.recording.drive.derivative(t + window.begin),
        )
        d = rig.rolling_ratio * (s * rate**2 + rig.gravity * (np.sin(alpha) - alpha))
        D = cumulative_simpson(cumulative_simpson(d, x=t, initial=0.0), x=t, initial=0.0)
        others, _ = np.linalg.qr(np.column_stack((np.ones_like(t), t, t**2)))
        a = DoubleIntegrator().driven(window)[:, 0]
        missed.append(D - others @ (others.T @ D))
        column.append(a - others @ (others.T @ a))
    size = float(np.linalg.norm(np.concatenate(column)))
    allowed = (float(np.linalg.norm(np.concatenate(missed))) + 4.0 * math.sqrt(problem.reading_variance)) / size
    found = fit_double_integrator(windows).gains[0]
    assert abs(found - rig.rolling_ratio * rig.gravity) < allowed
    assert allowed < 0.02 * found  # or it would say nothing


@pytest.mark.parametrize("poles", [(1.2, 9.0), (0.8, -0.9), (6.0, 5.0)], ids=["swings", "runs away", "damped"])
def test_the_black_box_finds_a_system_of_order_two(beam: PreparedRecording, poles: tuple[float, float]) -> None:
    """Find F and B of a known B/F from readings without noise, and predict it.

    Without noise the least sum of squares is zero at the truth; the search ends where a step changes it by less than
    1e-8 of itself, and slopes by differences of 1e-4 have errors of that order: 1e-4 of a pole is what may be left.
    """
    B = np.array([2e-3, -1e-3, 5e-4])
    F = OutputError(poles).denominator(STEP)
    made = replace(beam, reading=lfilter(B, F, beam.drive.evaluate(beam.time)))
    windows = windows_of((made,))
    seen, ahead = windows[:3], windows[3:]
    found = fit_output_error(seen)
    assert isinstance(found.law, OutputError)
    assert found.law.poles == pytest.approx(poles, rel=1e-4, abs=1e-4)
    np.testing.assert_allclose(found.gains[:3], B, rtol=1e-2)
    assert all(one.rms_error(found.predict(one)) < 1e-4 * np.ptp(one.reading) for one in ahead)


def test_the_black_box_of_order_three_finds_what_lags(beam: PreparedRecording) -> None:
    """Find a third pole, such as of a servo, in readings without noise, and predict what order two cannot.

    Tolerances as for order two.
    """
    poles = (0.3, 1.5, 5.0)
    made = replace(beam, reading=lfilter([2e-3], OutputError(poles).denominator(STEP), beam.drive.evaluate(beam.time)))
    windows = windows_of((made,))
    seen, ahead = windows[:3], windows[3:]
    third, second = fit_output_error(seen, 3), fit_output_error(seen)
    assert isinstance(third.law, OutputError)
    assert third.law.poles == pytest.approx(poles, rel=1e-2)
    for one in ahead:
        assert one.rms_error(third.predict(one)) < 1e-4 * np.ptp(one.reading)
        assert one.rms_error(third.predict(one)) < one.rms_error(second.predict(one))


def test_a_ball_at_rest_stays_and_one_in_motion_goes_on(beam: PreparedRecording) -> None:
    """Predict the last place, and the last velocity, of a ball that changes its motion in the known part.

    Without noise a memory that holds only what came after the change misses nothing.
    """
    time = beam.time
    stops = windows_of((replace(beam, reading=0.1 * np.minimum(time, 1.0)),))
    at_rest = fit_at_rest(stops[:1])
    assert at_rest.memory <= 1.0
    np.testing.assert_allclose(at_rest.predict(stops[0]), 0.1, atol=1e-12)
    goes = windows_of((replace(beam, reading=np.where(time < 1.0, 0.2, 0.2 + 0.05 * (time - 1.0))),))
    moving = fit_constant_velocity(goes[:1])
    np.testing.assert_allclose(moving.predict(goes[0])[goes[0].judged], goes[0].reading[goes[0].judged], atol=1e-12)


def test_a_noisy_sensor_lengthens_the_memory(beam: PreparedRecording) -> None:
    """Take the mean of 2 s where a resting ball's readings are noise alone: nothing else predicts as well.

    The mean of n readings is off by σ/√n: 0.1 of σ for 2 s, 0.45 for 0.1 s.
    """
    noise = np.random.default_rng(0).normal(0.0, 0.01, len(beam.time))
    windows = windows_of((replace(beam, reading=noise),))
    assert fit_at_rest(windows).memory >= 0.7


def test_the_chart_of_poles_is_that_of_sampled_differential_equations() -> None:
    """F has the roots exp(λ T) of λ² + f₁ λ + f₀ = 0, be they real or complex."""
    for first, zeroth in ((1.2, 9.0), (0.8, -0.9), (6.0, 5.0), (0.0, 0.0)):
        for further in ((), (3.0,)):
            rates = [*np.roots([1.0, first, zeroth]).astype(complex), *(-rate for rate in further)]
            made = OutputError((first, zeroth, *further)).denominator(STEP)
            np.testing.assert_allclose(made, np.poly(np.exp(STEP * np.array(rates))), atol=1e-12)


def test_uneven_stamps_are_no_hindrance(beam: PreparedRecording) -> None:
    """Predict as well where stamps jitter: the angle is known between them.

    Columns are interpolated between even times 20 ms apart: |s̈| < 1 m/s² leaves 1/8 · 0.02² = 5e-5 m.
    """
    rng = np.random.default_rng(0)
    time = beam.time + rng.uniform(-0.3, 0.3, len(beam.time)) * STEP
    window = Window(replace(beam, time=time), float(time[0]), slice(0, 250))
    even = Window(beam, 0.0, slice(0, 250))
    driven = DoubleIntegrator().driven(even)[:, 0]
    there = np.interp(window.time + window.begin, even.time, driven)
    inside = window.time + window.begin < even.time[-1]
    # begun at another time, the integral differs by a start: a straight line, whose slope and place are free
    line = np.polyfit(window.time[inside], (DoubleIntegrator().driven(window)[:, 0] - there)[inside], 1)
    rest = DoubleIntegrator().driven(window)[:, 0] - there - np.polyval(line, window.time)
    assert np.max(np.abs(rest[inside])) < 1e-4


def test_predictions_know_the_beginning_only(plain: Posed) -> None:
    """Stay the same when everything after the known part of a window is changed."""
    windows = windows_of(plain.problem.recordings)
    for fit in FITS.values():
        fitted = fit(windows)
        before = fitted.predict(windows[0])
        reading = windows[0].recording.reading.copy()
        reading[windows[0].use][windows[0].judged] += 0.1
        after = fitted.predict(replace(windows[0], recording=replace(windows[0].recording, reading=reading)))
        np.testing.assert_array_equal(before, after)
