"""The position's way into the record: delay, lag and scale, in closed loop and open."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.motion import FloatArray, State
from harness.simulator import (
    Channel,
    Encoder,
    Laser,
    Plant,
    Protocol,
    Record,
    Run,
    Sensors,
    Servo,
    perform,
    record,
    simulate,
)
from harness.simulator.protocol import Controller
from tests.simulator.motions import Sines

DT = 1e-4
EXACT = Sensors(
    encoder=Encoder(counts=10**9),
    laser=Laser(near=-10.0, far=10.0, noise_near=0.0, noise_far=0.0, resolution=1e-12),
)
PROTOCOL = Protocol(0.36, ((0.5, 0.45), (3.0, 0.3)), 6.0)


def performed(name: str, **values: float) -> tuple[Run, Record]:
    """A closed-loop experiment with sensors that make no error but this effect."""
    effects = {name: values}
    return perform(PROTOCOL, Plant().with_effects(effects), Servo(), Controller(), EXACT.with_effects(effects), 1)


def shift(time: FloatArray, early: FloatArray, late: FloatArray) -> float:
    """By how much `late` comes after `early` [s]: the lag at which their rates correlate best, to 1 ms."""
    lags = np.arange(-0.1, 0.1001, 0.001)
    inner = (time > 0.2) & (time < time[-1] - 0.2)
    rates = [CubicSpline(time, x).derivative() for x in (early, late)]
    matches = [np.corrcoef(rates[0](time[inner] - lag), rates[1](time[inner]))[0, 1] for lag in lags]
    return float(lags[int(np.argmax(matches))])


@pytest.mark.parametrize("delay", [0.06, -0.04, 0.0137])
def test_delay_is_found_by_cross_correlation(delay: float) -> None:
    """Record the position `delay` later than the angle of the same instant, or earlier where it is negative."""
    run, written = performed("channel_delay", delay=delay)
    true, recorded = run.position[::100], written.position
    angle_shift = shift(written.time, run.shaft[::100], written.angle)
    # the grid of lags, 1 ms
    assert shift(written.time, true, recorded) - angle_shift == pytest.approx(delay, abs=1.1e-3)
    assert angle_shift == pytest.approx(max(-delay, 0.0), abs=1.1e-3)


def test_delayed_position_is_the_earlier_one() -> None:
    """Record s(t − delay), and where the ball lay before it began."""
    run, written = performed("channel_delay", delay=0.0137)
    expected = np.interp(np.maximum(written.time - 0.0137, 0.0), run.time, run.position)
    np.testing.assert_allclose(written.position, expected, rtol=0.0, atol=2e-12)  # the resolution


def test_gain_scales_the_record_only() -> None:
    """Record 1.03 s, while the ball is where it is."""
    run, written = performed("position_gain", gain=1.03)
    np.testing.assert_allclose(written.position, 1.03 * run.position[::100], rtol=0.0, atol=1e-12)


def test_curve_bends_the_record_only() -> None:
    """Record s + 0.2 s² − 0.1 s³, while the ball is where it is."""
    run, written = performed("position_nonlinearity", square=0.2, cube=-0.1)
    s = run.position[::100]
    np.testing.assert_allclose(written.position, s + 0.2 * s**2 - 0.1 * s**3, rtol=0.0, atol=1e-12)


def test_lag_obeys_its_equation() -> None:
    """Follow τ ẏ = s − y from y(0) = s(0), whose solution for s = a sin ω t is closed."""
    tau, omega = 0.08, 4.0
    time = np.arange(0.0, 3.0, DT)
    position = 0.1 * np.sin(omega * time)
    seen = Channel(time_constant=tau).read(position, DT, time)
    damped = np.sin(omega * time) - omega * tau * np.cos(omega * time) + omega * tau * np.exp(-time / tau)
    # a sine taken for straight within a step: (ω dt)²/8 of 0.1 m
    np.testing.assert_allclose(seen, 0.1 * damped / (1 + (omega * tau) ** 2), rtol=0.0, atol=2.1e-9)


def test_lag_trails_by_its_time_constant() -> None:
    """Come τ late behind a steady motion."""
    time = np.arange(0.0, 2.0, DT)
    seen = Channel(time_constant=0.05).read(0.2 * time, DT, time)
    assert seen[-1] == pytest.approx(0.2 * (time[-1] - 0.05), abs=1e-12)


@pytest.mark.parametrize(
    "effect",
    [("channel_delay", {"delay": 0.06}), ("channel_delay", {"delay": -0.03}), ("position_lag", {"time_constant": 0.1})],
)
def test_closed_loop_reads_what_a_whole_run_reads(effect: tuple[str, dict[str, float]]) -> None:
    """Write down in progress what reading the finished run writes down."""
    run, closed = performed(effect[0], **effect[1])
    opened = record(run, EXACT.with_effects({effect[0]: effect[1]}), 1)
    np.testing.assert_allclose(opened.position, closed.position, rtol=0.0, atol=2e-12)
    np.testing.assert_array_equal(opened.angle, closed.angle)


def test_channel_leaves_the_ball_alone() -> None:
    """Move the ball the same in open loop, whatever is recorded of it."""
    for effects in ({}, {"channel_delay": {"delay": 0.1}}, {"position_gain": {"gain": 1.1}}):
        run = simulate(Plant().with_effects(effects), Sines(), State(0.3, 0.0), 1.0)
        np.testing.assert_array_equal(run.position, simulate(Plant(), Sines(), State(0.3, 0.0), 1.0).position)


@pytest.mark.parametrize(
    "wrong", [{"gain": 0.0}, {"time_constant": -1.0}, {"delay": np.inf}, {"square": np.nan}, {"cube": np.inf}]
)
def test_impossible_channel_is_refused(wrong: dict[str, float]) -> None:
    """Refuse a channel that cannot exist, naming the quantity."""
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Channel(**wrong)
