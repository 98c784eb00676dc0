"""The roughness of the beam's motion that the ball tells."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.rig import Rig
from harness.identify.estimate.fit import Fit, fit
from harness.identify.filter.run import deviance
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.beam_roughness import with_beam_roughness
from harness.identify.selection.search import search
from harness.recording import load_case
from harness.simulator import bundled
from harness.simulator.plant import Plant
from harness.simulator.protocol import Controller, Sensors, perform, recording_text
from harness.simulator.servo import Servo
from tests.posed import pose
from tests.pushed import with_random_accelerations

RESISTANCE = "rolling_resistance"
SEED = 5053  # of moves and noise: a rig whose beam moves within its counts more than they show
HELD = 5000  # one whose ball is held until the beam starts


def followed(folder: Path, seed: int) -> Problem:
    """Two recordings of a controller that follows a noisy position, on a rig with an encoder of 4096 counts."""
    plant = Plant(rig=Rig(level_angle=bundled.LEVEL_ANGLE), rolling_resistance=bundled.ROLLING_RESISTANCE)
    for number, (name, protocol) in enumerate(bundled.PROTOCOLS.items()):
        _, record = perform(protocol, plant, Servo(), Controller(), Sensors(), seed + number)
        (folder / name).write_text(recording_text(record), encoding="utf-8")
    (folder / "rig.toml").write_text(bundled.rig_text(), encoding="utf-8")
    return problem_of(load_case(folder))


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> tuple[Problem, Fit]:
    """Such a rig, and the fit of what acts there."""
    problem = followed(tmp_path_factory.mktemp("shaken"), SEED)
    return problem, fit(problem, Hypothesis((RESISTANCE,)))


def test_the_ball_tells_that_the_beam_moves_within_its_counts(shaken: tuple[Problem, Fit]) -> None:
    """Find a rougher beam, which needs less process noise and follows the ball's readings better."""
    problem, found = shaken
    rougher = with_beam_roughness(problem, found)
    assert rougher.roughness > 1.0
    again = fit(rougher, found.hypothesis)
    assert again.deviance < found.deviance - 4.0  # the decrease for which it is taken, which a new fit does not lose
    assert again.process_noise < 0.5 * found.process_noise


def gain_of_a_play(problem: Problem) -> float:
    """Decrease of the deviance by a play that is not there."""
    without, play = (fit(problem, Hypothesis((RESISTANCE, *more))) for more in ((), ("linkage_backlash",)))
    return without.deviance - play.deviance


# 14: a parameter's price ln n = 8 of 2800 readings, and 6 that are asked beyond.
@pytest.mark.slow
def test_a_held_ball_leaves_nothing_for_a_play_to_explain(tmp_path: Path) -> None:
    """Gain less by it than what makes an effect believed; 16 where a held ball forgets the error of the beam's rate."""
    assert gain_of_a_play(followed(tmp_path, HELD)) < 14.0


def test_a_rougher_beam_leaves_nothing_for_a_play_to_explain(shaken: tuple[Problem, Fit]) -> None:
    """Gain less by it than what makes an effect believed."""
    problem, found = shaken
    assert gain_of_a_play(with_beam_roughness(problem, found)) < 14.0


def test_no_roughness_is_estimated_where_no_process_noise_is_needed(shaken: tuple[Problem, Fit]) -> None:
    """Leave a problem as it is whose fit has the process noise that changes no innovation."""
    problem, found = shaken
    assert with_beam_roughness(problem, replace(found, process_noise=problem.least_process_noise)) is problem


def test_no_roughness_is_estimated_where_physics_is_missing(tmp_path: Path) -> None:
    """Leave a problem as it is where a strong damping is in the recordings and not in the model."""
    problem = pose(tmp_path / "case", 6, {"viscous_damping": {"coefficient": 0.03}}).problem
    assert with_beam_roughness(problem, fit(problem, Hypothesis(()))) is problem


def test_no_roughness_is_taken_that_leaves_the_process_noise(shaken: tuple[Problem, Fit]) -> None:
    """Leave a problem as it is if the rougher beam fits better, by 12, and still needs 97 % of the process noise."""
    problem = with_random_accelerations(shaken[0], 8e-4)
    found = fit(problem, Hypothesis((RESISTANCE,)))
    rougher = problem.rougher(100.0)
    densities = found.process_noise * np.linspace(0.1, 1.0, 10)
    deviances = [deviance(rougher, found.terms, density) for density in densities]
    assert min(deviances) < found.deviance - 4.0
    assert densities[np.argmin(deviances)] > 0.75 * found.process_noise
    assert with_beam_roughness(problem, found) is problem


def test_roughness_is_estimated_once(shaken: tuple[Problem, Fit]) -> None:
    """Leave a problem as it is whose roughness is known."""
    problem, found = shaken
    rougher = problem.rougher(10.0)
    assert with_beam_roughness(rougher, found) is rougher


@pytest.mark.slow
def test_a_search_begins_anew_with_the_roughness(shaken: tuple[Problem, Fit]) -> None:
    """Name the resistance alone, and return the problem that the fits are of."""
    problem = shaken[0]
    selection = search(problem)
    assert selection.problem.roughness > 1.0
    assert selection.found.hypothesis.names == (RESISTANCE,)
    assert selection.problem.recordings[0].drive.std[:, 0].mean() > problem.recordings[0].drive.std[:, 0].mean()
