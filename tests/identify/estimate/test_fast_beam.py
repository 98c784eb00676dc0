"""Of a beam that turns far between two readings of its angle, the ball tells what of them is noise, what motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from harness.identify.estimate.fast_beam import with_fast_beam
from harness.identify.estimate.fit import fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.verdict import identify
from harness.recording import load_case
from tests.recording.hand_turned import STEP, Hand, write_hand_turned

DELAY = 0.06  # of the position [s]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_a_delay_is_no_hold_where_the_beam_is_half_seen(tmp_path: Path, seed: int) -> None:
    """Find a delay of 60 ms in ten readings a second of an exact angle, more likely than a hold or a servo.

    Of the angle's readings alone, several milliradians would be noise, and the hold as likely as the delay.
    """
    hand = Hand(corner=1.5, size=0.1, rate=10.0, delay=DELAY)
    problem = problem_of(load_case(write_hand_turned(tmp_path / "case", hand, seed)))
    assert problem.noise_share <= 0.1
    assert problem.roughness < 1.0
    delayed, held, servo = (
        fit(problem, Hypothesis((*problem.unknown, name))) for name in ("channel_delay", "angle_hold", "angle_servo")
    )
    error = delayed.deviations()["channel_delay", "delay"]
    # The plant's Euler steps shift the beam by one step at the most.
    assert delayed.values()["channel_delay", "delay"] == pytest.approx(DELAY, abs=STEP + 3.0 * error)
    assert error < 0.02 * DELAY
    assert delayed.deviance < min(held.deviance, servo.deviance) - 4.0


@pytest.mark.slow
def test_noise_of_an_angle_that_is_sampled_fast_enough_stays_noise(tmp_path: Path) -> None:
    """Leave an angle as its readings tell where its sensor is noisy and it is sampled fifty times a second."""
    hand = Hand(corner=1.0, size=0.1, rate=50.0, angle_noise=2e-3)
    problem = problem_of(load_case(write_hand_turned(tmp_path / "case", hand, seed=3)))
    assert all(one.drive.sensor.noise == pytest.approx(2e-3, rel=0.1) for one in problem.recordings)
    assert (problem.noise_share, problem.roughness) == (1.0, 1.0)


@pytest.mark.slow
def test_declared_noise_is_believed(tmp_path: Path) -> None:
    """Ask the ball for nothing where the noise is declared."""
    hand = Hand(corner=1.5, size=0.1, rate=10.0, duration=10.0)
    case = load_case(write_hand_turned(tmp_path / "case", hand, seed=4))
    declared = problem_of(replace(case, sensors=replace(case.sensors, angle_noise=1e-4)))
    assert with_fast_beam(declared) is declared


@pytest.mark.slow
def test_the_delay_is_named(tmp_path: Path) -> None:
    """Name the delay, or what is said to be indistinguishable from it, and nothing else."""
    hand = Hand(corner=1.0, size=0.1, rate=10.0, delay=DELAY)
    (effect,) = identify(problem_of(load_case(write_hand_turned(tmp_path / "case", hand, seed=5)))).effects
    assert "channel_delay" in {effect.name, *effect.indistinguishable_from}
