"""Detection limits: what an independent rig with effects of twice and of a third of the limit is found to have."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from analytic.effects import CATALOGUE
from harness.identify.design.detection import ALIKE, Limit, detection_limits
from harness.identify.estimate.fit import fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from tests.identify.short_rig import on_flat_rail

EFFECTS = ("level_error", "viscous_damping", "angle_lag", "position_gain")


Values = dict[str, dict[str, float]]
RESISTANCE: Values = {"rolling_resistance": {"coefficient": 0.01}}


def problem_with(folder: Path, hidden: Values, seed: int = 5, duration: float = 6.0, **experiment: Any) -> Problem:
    """Two short recordings of the virtual rig with these hidden effects, read and posed."""
    write_case(folder, Experiment(hidden=hidden, duration=duration, predict=0, seed=seed, **experiment))
    return problem_of(load_case(folder))


@pytest.fixture(scope="module")
def limits(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Limit]:
    """Detection limits on a rig that has no hidden effect."""
    problem = problem_with(tmp_path_factory.mktemp("nothing"), {})
    return {one.effect: one for one in detection_limits(problem).limits}


def found(folder: Path, one: Limit, factor: float) -> tuple[bool, float]:
    """Whether the criterion keeps an effect that acts at a multiple of its limit, and its gain."""
    sign = math.copysign(1.0, CATALOGUE[one.effect].parameters[0].typical - one.neutral)
    problem = problem_with(folder, {one.effect: {one.parameter: one.neutral + sign * factor * one.limit}})
    base = fit(problem, Hypothesis(()))
    tried = fit(problem, Hypothesis((one.effect,)), process_noise=base.process_noise)
    decision = Criterion(problem.settings).decide(Rule.ADD, tried, base)
    return decision.kept, decision.gain


@pytest.mark.slow
@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_of_twice_the_limit_is_found_and_of_a_third_is_not(
    name: str, limits: dict[str, Limit], tmp_path: Path
) -> None:
    """Keep an effect of twice its limit, and not one of a third, on records of the independent plant.

    With one parameter the limit is √(6 + log n) = 3.7 standard errors for n of about 1200, and an estimate scatters
    by one: a third of it is 1.2 ± 1 (kept with a probability of 0.7 %). Twice the limit would be 7.4 ± 1, but process
    noise takes up a part of what is missing, so that the gain grows slower than the square of the size: with other
    seeds than this it was 4 to 31, below 6 once in 30 (docs/check.md).
    """
    kept, gain = found(tmp_path / "twice", limits[name], 2.0)
    assert kept, gain
    kept, gain = found(tmp_path / "third", limits[name], 1.0 / 3.0)
    assert not kept, gain


@pytest.mark.slow
def test_limits_are_ordered_and_name_what_looks_alike(limits: dict[str, Limit]) -> None:
    """Give every effect a positive limit, not smaller than with all else explained, and pairs both ways."""
    for one in limits.values():
        if not one.inverse:
            assert 0.0 < one.explained <= one.limit, one.effect
        for other, correlation in one.alike:
            assert abs(correlation) > ALIKE
            assert one.effect in dict(limits[other].alike)
    # the coefficients of both directions together are a rolling resistance
    assert "rolling_resistance" not in limits or "directional_resistance" in dict(limits["rolling_resistance"].alike)


@pytest.mark.slow
def test_more_data_lower_the_limit(limits: dict[str, Limit], tmp_path: Path) -> None:
    """Lower the limit of a level error about as time to the power of −3/2 or faster, but no less than the square root.

    Twice the time holds twice the information at least: a factor of √2, less 10 % for what the motion differs by.
    """
    longer = {one.effect: one for one in detection_limits(problem_with(tmp_path, {}, duration=12.0)).limits}
    assert longer["level_error"].limit < limits["level_error"].limit / (0.9 * math.sqrt(2.0))


@pytest.mark.slow
def test_what_is_left_once_the_rest_is_explained_is_what_a_complete_model_shows(tmp_path: Path) -> None:
    """Foretell, with a resistance that nobody declared, the limits of effects that smooth the angle's error.

    A channel delay, which leaves that error as it is, tells how much lower limits are with the process noise that is
    expected in place of the fitted one. The others, which act on the same motion, differ from it by half at the most.
    """
    coarse = {"counts": 4096}  # where the angle's error matters
    known = problem_with(tmp_path / "known", {}, declared=RESISTANCE, **coarse)
    complete = {one.effect: one.limit for one in detection_limits(known).limits}
    missing = problem_with(tmp_path / "missing", RESISTANCE, **coarse)
    explained = {one.effect: one.explained for one in detection_limits(missing).limits}
    lower = {name: explained[name] / complete[name] for name in complete}
    for name in ("linkage_backlash", "angle_hold", "angle_lag", "angle_servo"):
        assert 1.0 / 1.5 < lower[name] / lower["channel_delay"] < 1.5, (name, lower[name])


@pytest.mark.slow
def test_a_ball_on_a_flat_rail_may_roll_on_a_smaller_radius(tmp_path: Path) -> None:
    """Give a limit for the rolling radius where the known one is the largest there can be."""
    flat = on_flat_rail(problem_with(tmp_path / "case", {}))
    found = {one.effect: one for one in detection_limits(flat).limits}
    assert math.isfinite(found["rolling_radius"].limit)
