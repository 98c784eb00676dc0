"""The beam behind its linkage: a lag, and a support that tilts."""

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


def test_a_tilting_support_turns_the_beam_besides() -> None:
    """Turn by drift · t more, at a rate that is as much more, and behind a lag too."""
    for lag in (0.0, 0.1):
        level, drifting = moved(Follower(lag=lag)), moved(Follower(lag=lag, drift=1e-3))
        np.testing.assert_allclose(drifting.angle - level.angle, 1e-3 * level.time, rtol=0.0, atol=1e-14)
        np.testing.assert_allclose(drifting.rate - level.rate, 1e-3, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("wrong", [{"lag": -1.0}, {"drift": np.inf}])
def test_impossible_follower_is_refused(wrong: dict[str, float]) -> None:
    """Refuse what cannot be, naming the quantity."""
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Follower(**wrong)
