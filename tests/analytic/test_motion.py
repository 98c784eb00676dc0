"""Beam motions made of others, and what effects do between the measured angle and the beam, and behind the ball."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.effects import SensorLaw, Transmission, acting, motion_with, sensor_with, transmission_with
from analytic.motion import BeamMotion, DelayedMotion, ScaledMotion, SplineMotion, beam_states
from tests.motions import Sines

MOTION = Sines()
TIME = np.linspace(0.0, 6.0, 601)
CUBIC = SplineMotion(CubicSpline(np.arange(7.0), np.arange(7.0) ** 3))


def derivatives(motion: BeamMotion, time: np.ndarray = TIME) -> list[np.ndarray]:
    """α, α̇ by default and by name, and α̈."""
    return [motion.evaluate(time), motion.derivative(time), motion.derivative(time, 1), motion.derivative(time, 2)]


def test_spline_gives_its_own_derivatives() -> None:
    """Be t³, 3 t² twice and 6 t for the spline of t³, which is that cubic itself."""
    expected = [TIME**3, 3.0 * TIME**2, 3.0 * TIME**2, 6.0 * TIME]
    for found, each in zip(derivatives(CUBIC), expected, strict=True):
        np.testing.assert_allclose(found, each, rtol=0.0, atol=1e-12)  # 12 of half an ulp of 216, 1.4e-14
    np.testing.assert_array_equal(beam_states(CUBIC, TIME), np.column_stack([derivatives(CUBIC)[i] for i in (0, 1, 3)]))


def test_scaled_motion_is_scaled_in_all_derivatives() -> None:
    """Multiply the angle and what follows from it alike."""
    for found, base in zip(derivatives(ScaledMotion(MOTION, 1.05)), derivatives(MOTION), strict=True):
        np.testing.assert_array_equal(found, 1.05 * base)


def test_delayed_motion_is_the_motion_of_earlier() -> None:
    """Be what the motion was, and outside of its range what it is at the range's end."""
    late = DelayedMotion(MOTION, 0.3, 1.0, 5.0)
    for found, base in zip(derivatives(late), derivatives(MOTION, np.clip(TIME - 0.3, 1.0, 5.0)), strict=True):
        np.testing.assert_array_equal(found, base)


@pytest.mark.parametrize("gain", [0.95, 1.05])
def test_gain_between_angle_and_beam_scales_the_motion(gain: float) -> None:
    """Turn the beam by the gain times the measured angle."""
    found = motion_with(MOTION, TIME, [acting("angle_gain", {"gain": gain})])
    np.testing.assert_array_equal(found.evaluate(TIME), gain * MOTION.evaluate(TIME))


def test_motion_without_effects_is_the_motion_itself() -> None:
    """Leave it alone where nothing acts between, a gain of one included."""
    idle = [acting("viscous_damping", {"coefficient": 0.01}), acting("angle_gain", {"gain": 1.0})]
    assert motion_with(MOTION, TIME, idle) is MOTION


def test_backlash_follows_at_half_the_gap_and_rests_while_it_crosses() -> None:
    """Trail a rising angle by half the width, lead a falling one, rest in between; begin in the middle of the gap."""
    width = 0.02
    late = motion_with(MOTION, TIME, [acting("linkage_backlash", {"width": width})])
    angle, rate = MOTION.evaluate(TIME), MOTION.derivative(TIME)
    beam, turning = late.evaluate(TIME), late.derivative(TIME)
    behind = angle - beam
    # the play is followed on a grid of 0.5 ms, on which a beam at 0.13 rad/s turns by 7e-5 rad
    assert np.all(np.abs(behind) <= 0.5 * width + 7e-5)
    assert behind[0] == 0.0
    up, down = np.isclose(behind, 0.5 * width, atol=1e-12), np.isclose(behind, -0.5 * width, atol=1e-12)
    assert min(np.count_nonzero(up), np.count_nonzero(down)) > 100
    assert np.all(rate[up] > -1e-3)
    assert np.all(rate[down] < 1e-3)
    np.testing.assert_array_equal(turning[up | down], rate[up | down])
    np.testing.assert_array_equal(late.derivative(TIME, 2)[up | down], MOTION.derivative(TIME, 2)[up | down])
    crossing = ~(up | down)
    assert np.count_nonzero(crossing) > 20
    assert np.all(turning[crossing] == 0.0)
    assert np.all(late.derivative(TIME, 2)[crossing] == 0.0)
    # at rest: two neighbours in the gap stand alike
    both = crossing[1:] & crossing[:-1]
    assert np.all(np.diff(beam)[both] == 0.0)


def test_backlash_holds_up_to_both_ends_of_a_recording() -> None:
    """Be known at the first and the last stamp, whatever multiple of the play's grid they are apart."""
    stamps = np.array([0.2, 3.00017])
    late = motion_with(MOTION, stamps, [acting("linkage_backlash", {"width": 0.02})])
    begin, end = late.evaluate(stamps)
    assert begin == MOTION.evaluate(stamps)[0]
    assert abs(end - MOTION.evaluate(stamps)[1]) == pytest.approx(0.01, abs=1e-12)


def test_gains_multiply_and_plays_add() -> None:
    """Take several transmissions as one."""
    several = [
        acting("angle_gain", {"gain": 1.1}),
        acting("linkage_backlash", {"width": 0.004}),
        acting("linkage_backlash", {"width": 0.002}),
        acting("angle_gain", {"gain": 0.8}),
    ]
    assert transmission_with(several) == Transmission(pytest.approx(0.88), pytest.approx(0.006))
    assert transmission_with([]) == Transmission(1.0, 0.0)


def test_sensors_stand_one_behind_the_other() -> None:
    """Multiply gains, add lags and delays."""
    several = [
        acting("position_gain", {"gain": 1.1}),
        acting("channel_delay", {"delay": 0.02}),
        acting("position_lag", {"time_constant": 0.03}),
        acting("channel_delay", {"delay": 0.01}),
    ]
    assert sensor_with(several) == SensorLaw(pytest.approx(1.1), pytest.approx(0.03), pytest.approx(0.03))
    twice = SensorLaw(1.1, 0.02, 0.01).behind(SensorLaw(0.5, 0.03, -0.04))
    assert twice == SensorLaw(pytest.approx(0.55), pytest.approx(0.05), pytest.approx(-0.03))
    assert sensor_with([]) == SensorLaw()
    position = np.sin(TIME)
    np.testing.assert_array_equal(SensorLaw().recorded(TIME, position), position)


def test_sensor_gain_scales_what_is_recorded() -> None:
    """Record gain times the position."""
    np.testing.assert_array_equal(SensorLaw(gain=1.1).recorded(TIME, np.sin(TIME)), 1.1 * np.sin(TIME))


@pytest.mark.parametrize("delay", [0.015, -0.015])
def test_delayed_sensor_records_what_was(delay: float) -> None:
    """Record the position of earlier, at the ends that of the first and last stamp, and nothing where it is unknown."""
    position = np.sin(TIME)
    position[200:220] = np.nan
    found = SensorLaw(delay=delay).recorded(TIME, position)
    assert np.array_equal(np.isnan(found), np.isnan(position))
    known = ~np.isnan(found)
    # a spline through a gap of 0.21 s errs by 5/384 h⁴ = 3e-5 near it
    expected = np.sin(np.clip(TIME - delay, 0.0, 6.0))
    np.testing.assert_allclose(found[known], expected[known], rtol=0.0, atol=3e-5)


def test_lagging_sensor_follows_a_ramp_behind_by_its_time_constant() -> None:
    """Begin settled, be exact for straight lines between stamps, and begin anew after a gap."""
    constant = 0.05
    ramp = 0.3 + 0.2 * TIME
    found = SensorLaw(lag=constant).recorded(TIME, ramp)
    expected = ramp - 0.2 * constant * (1.0 - np.exp(-TIME / constant))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13)  # 600 steps of 1e-16
    broken = ramp.copy()
    broken[300] = np.nan
    after = SensorLaw(lag=constant).recorded(TIME, broken)[301:]
    assert after[0] == ramp[301]
    lost = 0.2 * constant * (1.0 - np.exp(-(TIME[301:] - TIME[301]) / constant))
    np.testing.assert_allclose(after, ramp[301:] - lost, rtol=0.0, atol=1e-13)


def test_a_sensor_with_a_curve_records_a_cubic() -> None:
    """Record gain (s + a s² + b s³) with its slope, and find the position of which that was recorded."""
    curve, gain = acting("position_nonlinearity", {"square": 0.3, "cube": -0.2}), acting("position_gain", {"gain": 0.9})
    law = sensor_with([curve, gain])
    s = np.linspace(-0.3, 0.6, 91)
    expected = 0.9 * (s + 0.3 * s**2 - 0.2 * s**3)
    np.testing.assert_allclose(law.recorded(s, s), expected, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(law.slope(s), 0.9 * (1.0 + 0.6 * s - 0.6 * s**2), rtol=1e-14)
    np.testing.assert_allclose(law.position(expected), s, rtol=0.0, atol=1e-14)
    assert law.behind(SensorLaw(square=0.1)).square == pytest.approx(0.4)
