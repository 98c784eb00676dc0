"""Data that another engine's contact made: no equation of motion, no law of ours moves the ball there."""

import pytest

from benchmarks.calibration.rows import Outcome
from benchmarks.calibration.run import diagnosed
from benchmarks.calibration.trials import plan


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rolling_resistance", "level_error"])
@pytest.mark.parametrize("plant", ["mujoco", "pybullet"])
def test_an_undeclared_effect_in_an_engines_scene_is_named(plant: str, name: str) -> None:
    """Name exactly the effect that acts unseen in a ball of MuJoCo or PyBullet, with its size in the interval."""
    trial = next(one for one in plan(("confusion",), only=(name,)) if one.plant == plant and one.size == "middle")
    row = diagnosed(trial, "test")
    assert row.outcome is Outcome.RIGHT, row
    assert [one.covers for one in row.intervals()] == [True]


@pytest.mark.slow
@pytest.mark.parametrize("plant", ["mujoco", "pybullet"])
def test_nothing_is_found_where_an_engines_scene_lacks_nothing(plant: str) -> None:
    """Say none of a scene in which only what is declared acts."""
    trial = next(one for one in plan(("null",)) if one.plant == plant and one.declared)
    row = diagnosed(trial, "test")
    assert row.verdict == "none", row
    assert row.named == ()
