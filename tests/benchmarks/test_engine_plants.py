"""Data that another engine's contact made: no equation of motion, no law of ours moves the ball there."""

import pytest

from benchmarks.calibration.rows import Outcome
from benchmarks.calibration.run import diagnosed
from benchmarks.calibration.trials import plan

ENGINES = ("mujoco", "pybullet")
EFFECTS = ("rolling_resistance", "level_error")
# Of twelve 95 % intervals at least nine hold the truth in 99.8 % of all plans (binomial), one error in 16,000 is beyond
# four standard errors. One interval alone misses in one plan of twenty: that says nothing.
HOLDING, STANDARD_ERRORS = 9, 4.0


@pytest.mark.slow
def test_undeclared_effects_in_an_engines_scene_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Name exactly the effect that acts unseen on a ball of MuJoCo or PyBullet, its size as the interval promises."""
    monkeypatch.setattr("benchmarks.calibration.pose._DEFLECTIONS", (1.0, 1.0))  # rests at 3°, the same in each trial
    trials = [one for one in plan(("confusion",), only=EFFECTS) if one.plant in ENGINES]
    assert len(trials) == 12  # each effect at three sizes in each engine
    rows = [diagnosed(trial, "test") for trial in trials]
    assert [row.outcome for row in rows] == [Outcome.RIGHT] * len(rows), rows
    intervals = [one for row in rows for one in row.intervals()]
    assert sum(one.covers for one in intervals) >= HOLDING, intervals
    assert max(abs(one.z) for one in intervals) < STANDARD_ERRORS, intervals


@pytest.mark.slow
@pytest.mark.parametrize("plant", ENGINES)
def test_nothing_is_found_where_an_engines_scene_lacks_nothing(plant: str) -> None:
    """Say none of scenes in which only what is declared acts."""
    trials = [one for one in plan(("null",)) if one.plant == plant and one.declared][:3]
    rows = [diagnosed(trial, "test") for trial in trials]
    # One search of fifty may name something by chance; of three, two do in one plan of 800.
    assert [row.verdict for row in rows].count("none") >= 2, rows
    assert all((row.verdict == "none") == (row.named == ()) for row in rows), rows
