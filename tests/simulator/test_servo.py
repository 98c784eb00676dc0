"""The servo moves as its equation says and within its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.simulator import Servo

FREE = Servo(natural_frequency=15.0, damping=0.6, rate_limit=np.inf, acceleration_limit=np.inf)


def step_response(servo: Servo, command: float, dt: float, duration: float) -> tuple[FloatArray, ...]:
    """Time, angle, rate and acceleration after a command at rest at zero."""
    steps = round(duration / dt)
    angle, rate, acceleration = np.zeros((3, steps + 1))
    servo.follow(command, dt, angle, rate, acceleration)
    return np.arange(steps + 1) * dt, angle, rate, acceleration


def test_free_servo_is_the_damped_oscillator() -> None:
    """Approach the closed step response of second order, with the first-order error of a held acceleration."""
    time, angle, _, _ = step_response(FREE, 0.05, 2e-4, 0.6)
    _, finer, _, _ = step_response(FREE, 0.05, 1e-4, 0.6)
    decay, frequency = 0.6 * 15.0, 15.0 * math.sqrt(1 - 0.6**2)
    swing = np.cos(frequency * time) + decay / frequency * np.sin(frequency * time)
    exact = 0.05 * (1 - np.exp(-decay * time) * swing)
    # α̈ is held for a step, as if it came dt/2 late. Extrapolated to dt = 0, (ω₀ dt)² of 0.05 rad remain: 4.5e-7.
    np.testing.assert_allclose(2 * finer[::2] - angle, exact, rtol=0.0, atol=(15.0 * 2e-4) ** 2 * 0.05)
    ratio = np.max(np.abs(angle - exact)) / np.max(np.abs(finer[::2] - exact))
    # first order, up to a part ω₀ dt = 0.3 %
    assert ratio == pytest.approx(2.0, rel=3e-3)


def test_servo_respects_its_limits() -> None:
    """Reach but never pass the rate and acceleration limits on a large command."""
    servo = Servo(rate_limit=0.3, acceleration_limit=5.0)
    _, angle, rate, acceleration = step_response(servo, 0.5, 1e-4, 4.0)
    assert np.max(np.abs(acceleration)) == 5.0
    assert np.max(rate) <= 0.3
    assert np.max(rate) == pytest.approx(0.3, rel=1e-6)
    # 4 s leave more than 2 s after the slope: exp(−7 · 2) of at most 0.05 rad
    assert angle[-1] == pytest.approx(0.5, abs=1e-6)


def test_rate_and_acceleration_belong_to_the_angle() -> None:
    """Give α̇ and α̈ that are exactly the derivatives of the piecewise quadratic α."""
    dt = 1e-4
    _, angle, rate, acceleration = step_response(Servo(), 0.06, dt, 1.0)
    # identities of a quadratic, to rounding of 0.06 rad and 0.5 rad/s divided by dt and dt²
    np.testing.assert_allclose(np.diff(rate) / dt, acceleration[:-1], atol=2e-12)
    np.testing.assert_allclose(np.diff(angle) / dt, 0.5 * (rate[1:] + rate[:-1]), atol=2e-13)
