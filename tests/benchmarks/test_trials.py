"""The plan of trials: complete, balanced, and the same whenever and in whatever part it is asked for."""

from __future__ import annotations

import math
from collections import Counter

import pytest

from analytic.effects import CATALOGUE, acting
from benchmarks.calibration.pose import experiment_of
from benchmarks.calibration.sizes import PAIRS, POWER, POWER_ERRORS, SCALES, SIZES, SPREAD, UNLISTED_SCALES
from benchmarks.calibration.trials import NULL_TRIALS, SEEDS, in_engines, plan
from harness.errors import InputError
from harness.identify.problem.settings import DEFAULT
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.simulator import UNLISTED

PLAN = plan()


def test_the_whole_catalogue_is_tried_at_every_size() -> None:
    """Hide each effect of the catalogue alone at each of three sizes, as often as there are seeds, with a whole law."""
    for name, effect in CATALOGUE.items():
        assert set(SCALES[name].middle) | set(SCALES[name].fixed) == {one.name for one in effect.parameters}
    tried = Counter((one.name, one.size) for one in PLAN if one.study == "confusion" and one.name in CATALOGUE)
    assert tried == Counter({(name, size): SEEDS for name in CATALOGUE for size in SIZES})


def test_structures_and_pairs_are_tried() -> None:
    """Hide each unlisted structure, and each pair, as often as there are seeds."""
    tried = Counter(one.name for one in PLAN if one.study == "confusion" and one.name not in CATALOGUE)
    assert set(UNLISTED_SCALES) == set(UNLISTED)
    assert tried == dict.fromkeys([*UNLISTED, *(" + ".join(pair) for pair in PAIRS)], SEEDS)


def test_effect_free_trials_hide_nothing() -> None:
    """Plan at least 200 trials that hide nothing, half with each encoder, a fifth in each engine's scene."""
    null = [one for one in PLAN if one.study == "null"]
    assert len(null) == NULL_TRIALS >= 200
    assert not any(one.hidden or one.unlisted for one in null)
    assert Counter(one.encoder for one in null) == {"fine": 100, "paper": 100}
    assert Counter(one.plant for one in null) == {"virtual_rig": 120, "mujoco": 40, "pybullet": 40}
    # of each kind of declaration some: with 200 draws at 15 % (level alone: 0.4 · 0.25, both: 0.6 · 0.25) or more,
    # (1 − 0.1)^200 = 7e-10 is what chance leaves to none at all
    declared = {tuple(sorted(one.declared)) for one in null}
    assert declared == {(), ("rolling_resistance",), ("level_error",), ("level_error", "rolling_resistance")}


def test_every_trial_is_long_enough_for_held_out_blocks() -> None:
    """Record enough blocks of 3 s for the search by held-out errors to be tried in every trial."""
    for one in PLAN:
        windows = int(experiment_of(one).duration - KNOWN - AHEAD) + 1  # that begin at full seconds
        assert one.recordings * math.ceil(windows / AHEAD) >= DEFAULT.min_blocks, one


def test_every_plant_sees_every_effect() -> None:
    """Move the ball of each effect by the virtual rig and by both engines; where it slides or hops, by the rig only."""
    for name in CATALOGUE:
        plants = {one.plant for one in PLAN if one.study == "confusion" and one.name == name}
        assert plants == ({"virtual_rig", "mujoco", "pybullet"} if in_engines(name) else {"virtual_rig"})


def test_trials_are_the_same_in_every_part() -> None:
    """Give the same trial whether all is planned, or one effect, or more seeds."""
    by_name = {(one.study, one.name, one.size, one.number): one for one in PLAN}
    for part in (plan(["confusion"], seeds=2, only=["level_error"]), plan(["power"], seeds=7), plan(["null"], count=9)):
        for one in part:
            key = (one.study, one.name, one.size, one.number)
            assert by_name.get(key, one) == one
    assert len({one.spec for one in PLAN}) == len({one.seed for one in PLAN}) == len(PLAN)


def test_sizes_can_be() -> None:
    """Keep every size within the bounds of its effect, in the catalogue and in the virtual rig."""
    for one in PLAN:
        for name, values in one.hidden.items():
            acting(name, values)
        experiment_of(one)


@pytest.mark.parametrize("name", list(SCALES))
def test_sizes_do_not_overlap(name: str) -> None:
    """Draw each size within ± 20 % of its factor, so that small, middle and large stay apart."""
    scale, parameter = SCALES[name], next(iter(SCALES[name].middle))
    one_unit = scale.middle[parameter] - scale.neutral
    for one in PLAN:
        if one.name == name and one.study == "confusion":
            factor = abs((one.hidden[name][parameter] - scale.neutral) / one_unit)
            # values are kept to six digits: of a gain of 1.05, 5e-6 of which the change is 0.05
            assert abs(factor / one.factor - 1.0) < SPREAD + 1e-3


def test_power_is_tried_at_sizes_in_standard_errors() -> None:
    """Follow the main effects at four and six standard errors, with names of their own."""
    power = [one for one in PLAN if one.study == "power"]
    tried = Counter((one.name, one.errors) for one in power)
    assert tried == Counter({(name, errors): SEEDS for name in POWER for errors in POWER_ERRORS})
    assert {one.size for one in power} == {"4 standard errors", "6 standard errors"}
    assert not any(one.errors for one in PLAN if one.study != "power")


def test_signs_are_both_tried() -> None:
    """Draw both signs of what has a sign."""
    for name in (name for name, scale in SCALES.items() if scale.signed):
        parameter = next(iter(SCALES[name].middle))
        drawn = {one.hidden[name][parameter] > SCALES[name].neutral for one in PLAN if one.name == name}
        assert drawn == {True, False}, name


def test_an_unknown_effect_is_refused() -> None:
    """Say what there is when asked for an effect that no trial hides."""
    with pytest.raises(InputError, match="level_error"):
        plan(["confusion"], only=["levl_error"])
