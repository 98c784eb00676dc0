"""The beam behind its linkage: lags, and a support that tilts."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.motion import State
from harness.simulator import Plant, Run, simulate
from harness.simulator.follower import Follower
from tests.simulator.motions import Sines

A, OMEGA = 0.05, 3.0


def moved(follower: Follower, duration: float = 4.0) -> Run:
    """A run of the plant whose shaft swings as A sin ω t."""
    plant = Plant(follower=follower, rolling_resistance=0.01)
    return simulate(plant, Sines(((A, OMEGA, 0.0),)), State(0.3, 0.0), duration)


def test_lag_follows_a_sine_as_a_low_pass_does() -> None:
    """Swing by A/√(1 + ω² T²) and late by atan ω T, once what it began with has faded."""
    run = moved(Follower(lag=0.1))
    late = run.time > 3.0  # exp(−30)
    expected = A / np.hypot(1.0, 0.1 * OMEGA) * np.sin(OMEGA * run.time - np.arctan(0.1 * OMEGA))
    # a sine taken for straight within a step of 0.1 ms: (ω dt)²/8 of it, in the rate over T
    np.testing.assert_allclose(run.angle[late], expected[late], rtol=0.0, atol=1e-9)
    rate = A * OMEGA / np.hypot(1.0, 0.1 * OMEGA) * np.cos(OMEGA * run.time - np.arctan(0.1 * OMEGA))
    np.testing.assert_allclose(run.rate[late], rate[late], rtol=0.0, atol=1e-8)
    assert run.rate[0] == pytest.approx(A * OMEGA)
    np.testing.assert_array_equal(run.shaft, A * np.sin(OMEGA * run.time))


@pytest.mark.parametrize("lag", [0.0, 0.05])
def test_servo_follows_a_sine_as_its_transfer_function_says(lag: float) -> None:
    """Swing by 1/(1 − q ω² + i L ω), q = (L/2ζ)², of the sine, once what it began with has faded; behind a lag too."""
    run = moved(Follower(lag=lag, servo_lag=0.2, servo_damping=0.6))
    late = run.time > 3.5  # exp(−ζ ω₀ t), ω₀ = 2 ζ/L: exp(−12)
    answer = 1.0 / (1.0 - (0.2 / 1.2) ** 2 * OMEGA**2 + 0.2j * OMEGA) / (1.0 + 1j * lag * OMEGA)
    swing = A * answer * np.exp(1j * OMEGA * run.time)
    # what has not faded: exp(−12.6) of the swing that it began with, 1e-7 of 0.05 rad, faster by ω₀ in the rate
    np.testing.assert_allclose(run.angle[late], swing.imag[late], rtol=0.0, atol=5e-7)
    np.testing.assert_allclose(run.rate[late], (1j * OMEGA * swing).imag[late], rtol=0.0, atol=3e-6)
    assert run.rate[0] == pytest.approx(A * OMEGA)


def test_a_tilting_support_turns_the_beam_besides() -> None:
    """Turn by drift · t more, at a rate that is as much more, and behind a lag too."""
    for lags in ({}, {"lag": 0.1}, {"servo_lag": 0.1}, {"lag": 0.05, "servo_lag": 0.1}):
        level, drifting = moved(Follower(**lags)), moved(Follower(**lags, drift=1e-3))
        np.testing.assert_allclose(drifting.angle - level.angle, 1e-3 * level.time, rtol=0.0, atol=1e-14)
        np.testing.assert_allclose(drifting.rate - level.rate, 1e-3, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("hold", [0.1, 0.12345])
def test_steps_follow_a_sine_as_their_mean_does(hold: float) -> None:
    """Swing late by half a step, and smaller by sin x/x, x = ω T/2; the same where a lag follows."""
    run = moved(Follower(hold=hold))
    x = 0.5 * OMEGA * hold
    late = run.time > 0.5
    expected = A * np.sin(x) / x * np.sin(OMEGA * run.time - x)
    # trapezoids of 0.1 ms: (ω dt)²/12 of it
    np.testing.assert_allclose(run.angle[late], expected[late], rtol=0.0, atol=1e-9)
    rate = A * OMEGA * np.sin(x) / x * np.cos(OMEGA * run.time - x)
    np.testing.assert_allclose(run.rate[late], rate[late], rtol=0.0, atol=1e-8)
    lagging = moved(Follower(hold=hold, lag=0.05))
    late = run.time > 3.0
    phase = OMEGA * run.time - x - np.arctan(0.05 * OMEGA)
    expected = A * np.sin(x) / x / np.hypot(1.0, 0.05 * OMEGA) * np.sin(phase)
    np.testing.assert_allclose(lagging.angle[late], expected[late], rtol=0.0, atol=1e-9)


def test_curve_bends_the_motion() -> None:
    """Turn to θ + a θ² + b θ³, at the rate that follows from it."""
    run = moved(Follower(square=0.5, cube=3.0), 1.0)
    np.testing.assert_allclose(run.angle, run.shaft + 0.5 * run.shaft**2 + 3.0 * run.shaft**3, rtol=0.0, atol=1e-16)
    slope = 1.0 + run.shaft + 9.0 * run.shaft**2
    np.testing.assert_allclose(run.rate, slope * run.shaft_rate, rtol=1e-14, atol=1e-17)


@pytest.mark.parametrize(
    "wrong",
    [
        {"lag": -1.0},
        {"servo_lag": -0.1},
        {"servo_damping": 0.0},
        {"drift": np.inf},
        {"hold": -0.1},
        {"square": np.nan},
    ],
)
def test_impossible_follower_is_refused(wrong: dict[str, float]) -> None:
    """Refuse what cannot be, naming the quantity."""
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Follower(**wrong)
