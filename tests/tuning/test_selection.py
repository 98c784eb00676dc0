"""What is tried: values that the engine runs through, and those that it does not."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.engines.catalogue import engine_of
from harness.identify.pose import problem_of
from harness.identify.problem.problem import Problem
from harness.recording import load_case
from harness.report.tuning.words import sentences
from harness.simulator import Experiment, write_case
from harness.tuning.tune import Verdict, tune


@pytest.fixture(scope="module")
def slipping(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Two recordings of 9 s of a ball that slips on its beam."""
    folder: Path = tmp_path_factory.mktemp("slipping") / "case"
    hidden = {"contact_slip": {"friction_coefficient": 0.0085}}
    write_case(folder, Experiment(hidden=hidden, duration=9.0, rate=25.0, counts=4096, predict=0, seed=501))
    return problem_of(load_case(folder))


@pytest.mark.slow
def test_values_with_which_the_engine_fails_are_told_as_such(slipping: Problem) -> None:
    """Call a friction not tried, instead of seen and idle, where the ball that slides leaves a rail at a long step."""
    made = tune(slipping, engine_of("mujoco"), {"time_step": 4e-3}, ["friction=0.004:0.011"])
    friction = made.selection.screened["friction"]
    assert made.verdict is Verdict.PHYSICS
    assert friction.failed == friction.tried == (0.005, 0.01)
    assert not friction.seen
    told = " ".join(sentences(made, None, "case"))
    assert "`friction` could not be tried at 0.005 and 0.01" in told
    assert "`--set mujoco.time_step=0.002` may let it run through" in told


@pytest.mark.slow
def test_a_shorter_step_lets_the_friction_be_found(slipping: Problem) -> None:
    """Find the friction that the longer step hid, within the bounds that are given for it."""
    made = tune(slipping, engine_of("mujoco"), {"time_step": 2e-3}, ["friction=0.004:0.04"], jobs=2)
    assert made.selection.pays == ("friction",)
    low, high = made.selection.found.interval("friction")
    # within three half-widths: two recordings are one draw, and MuJoCo's friction law is not quite the plant's
    assert abs(made.selection.found.values["friction"] - 0.0085) < 1.5 * (high - low)
    assert "could not be tried" not in " ".join(sentences(made, None, "case"))


@pytest.mark.slow
def test_a_level_is_found_where_friction_stops_the_ball(tmp_path: Path) -> None:
    """Begin at the level of CAM: from the given one, free runs that stop elsewhere end in another minimum."""
    hidden, declared = {"level_error": {"angle": -0.0052}}, {"rolling_resistance": {"coefficient": 0.002}}
    about = Experiment(hidden=hidden, declared=declared, duration=16.0, rate=50.0, predict=0, seed=502)
    write_case(tmp_path / "case", about)
    problem = problem_of(load_case(tmp_path / "case"))
    made = tune(problem, engine_of("mujoco"), {"time_step": 4e-3}, ["rolling_friction"], jobs=2)
    assert made.selection.pays == ("level_angle_rad",)
    low, high = made.selection.found.interval("level_angle_rad")
    assert abs(made.selection.found.values["level_angle_rad"] + 0.0052) < 1.5 * (high - low)
    assert made.selection.found.misfit < 2.0
