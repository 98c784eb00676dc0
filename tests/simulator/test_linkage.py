"""Play and ratio between the measured angle and the beam."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.motion import State
from harness.simulator import Linkage, Plant, Run, simulate
from tests.simulator.motions import Sines

WIDTH = 0.0087
SLOW = Sines(((0.05, 1.0, 0.0),))


def moved(linkage: Linkage, motion: Sines = SLOW, duration: float = 16.0) -> Run:
    """A run of the plant with this linkage."""
    return simulate(Plant(linkage=linkage, rolling_resistance=0.01), motion, State(0.3, 0.0), duration)


def test_gain_scales_the_beam() -> None:
    """Turn the beam by gain times the measured angle, rates alike."""
    run = moved(Linkage(gain=1.05), duration=2.0)
    np.testing.assert_allclose(run.angle, 1.05 * run.shaft, rtol=1e-15)
    np.testing.assert_allclose(run.rate, 1.05 * run.shaft_rate, rtol=1e-15)
    np.testing.assert_array_equal(run.shaft, SLOW.angle(run.time))


def test_hysteresis_is_as_wide_as_the_play() -> None:
    """Lag by b/2 on the way up and lead by b/2 on the way down, so that the loop is b wide."""
    run = moved(Linkage(width=WIDTH, corner=0.1))
    middle = (run.time > 3.0) & (np.abs(run.shaft) < 0.01)
    lost = run.shaft - run.angle
    # the soft corner, δ = b/10, is passed after 0.04 rad at least: exp(−0.04/8.7e-4) = 1e-20
    np.testing.assert_allclose(lost[middle & (run.shaft_rate > 0)], WIDTH / 2, rtol=1e-12)
    np.testing.assert_allclose(lost[middle & (run.shaft_rate < 0)], -WIDTH / 2, rtol=1e-12)


def test_beam_stands_still_within_the_play() -> None:
    """Leave beam and ball where they are while the shaft moves less than b/2 minus the corner from its middle."""
    run = moved(Linkage(width=WIDTH), Sines(((0.39 * WIDTH, 3.0, 0.0),)), 5.0)
    assert np.all(run.angle == 0.0)
    assert np.all(run.position == 0.3)


@pytest.mark.parametrize("start", [-1.0, 1.0])
def test_play_may_begin_at_a_flank(start: float) -> None:
    """Begin with the beam b/2 beside the shaft, on the side where the shaft touches it."""
    run = moved(Linkage(width=WIDTH, play_start=start), duration=0.01)
    assert run.shaft[0] - run.angle[0] == start * WIDTH / 2


def test_rate_belongs_to_the_angle() -> None:
    """Give a rate without jumps that integrates to the angle, and an acceleration that integrates to the rate."""
    run = moved(Linkage(width=WIDTH, corner=0.1))
    # Trapezoids of 1e-4 s: where a flank is met, β̈ jumps by θ̇²/δ <= 0.05²/8.7e-4 = 2.9 rad/s²; the rate is wrong by
    # its jump times dt there, and the angle by dt² times it; everything else is smaller by ω dt. Five flanks in 16 s.
    steps = np.diff(run.time)
    angle = np.cumsum(0.5 * (run.rate[1:] + run.rate[:-1]) * steps)
    rate = np.cumsum(0.5 * (run.acceleration[1:] + run.acceleration[:-1]) * steps)
    assert np.max(np.abs(angle - run.angle[1:])) < 5 * 2.9 * 1e-8
    assert np.max(np.abs(rate - (run.rate[1:] - run.rate[0]))) < 2 * 5 * 2.9 * 1e-4
    assert np.max(np.abs(np.diff(run.rate))) < (2.9 + 0.05) * 1e-4 * 1.01


def test_softer_corner_keeps_the_width() -> None:
    """Reach the same loop with a corner of half the width, only later."""
    sharp, soft = moved(Linkage(width=WIDTH, corner=0.01)), moved(Linkage(width=WIDTH, corner=0.5))
    top = np.argmin(np.abs(sharp.time - 2.5 * np.pi))
    assert sharp.angle[top] == pytest.approx(0.05 - WIDTH / 2, abs=1e-9)
    assert soft.angle[top] == pytest.approx(0.05 - WIDTH / 2, abs=1e-9)  # 0.09 rad past the corner: exp(−20)
    assert np.max(np.abs(sharp.angle - soft.angle)) > 0.1 * WIDTH


@pytest.mark.parametrize("wrong", [{"gain": 0.0}, {"width": -1.0}, {"corner": 0.6}, {"play_start": 2.0}])
def test_impossible_linkage_is_refused(wrong: dict[str, float]) -> None:
    """Refuse a linkage that cannot exist, naming the quantity."""
    with pytest.raises(ValueError, match=next(iter(wrong))):
        Linkage(**wrong)
