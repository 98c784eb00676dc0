"""What the catalogue says of its effects is so: where they vanish, where they are, what contains their laws."""

from __future__ import annotations

import pickle
from dataclasses import astuple, replace

import numpy as np
import pytest

from analytic.effects import (
    CATALOGUE,
    Acting,
    Effect,
    acting,
    motion_with,
    parameters_with,
    rig_with,
    sensor_with,
    transmission_with,
)
from analytic.law import acceleration, dry_limit, normal_force
from analytic.models import CAM
from analytic.motion import FloatArray, beam_states
from analytic.rig import Rig
from analytic.slots import DAHL, ORIGIN, TRACTION
from analytic.step import dahl_limit
from tests.motions import Fixed, Sines

RIG = Rig()
NOTHING: list[Acting] = []
TURNING = np.linspace(0.0, 3.0, 301)  # stamps of a beam that turns [s]
# s [m], ṡ [m/s], α [rad], α̇ [rad/s], α̈ [rad/s²]: resting, rolling either way, the beam turning either way
STATES = [
    (s, v, angle, rate, angular)
    for s in (0.0, 0.1, 0.29, 0.52)
    for v in (-0.3, 0.0, 0.2)
    for angle, rate, angular in ((-0.05, 0.0, 0.0), (0.04, 0.3, -2.0))
]


def felt(effects: list[Acting], states: list[tuple[float, ...]] = STATES) -> FloatArray:
    """All that effects do to beam, ball and sensor: its motion, acceleration, frictions, slip, gains, delays."""
    p = parameters_with(CAM, RIG, effects, phase=0.4)
    p[ORIGIN] = 0.2
    gains, sensor = transmission_with(effects), sensor_with(effects)
    assert sensor.error is None  # which is a spline term's alone
    fixed = [p[TRACTION], p[DAHL], gains.gain, gains.play, *astuple(sensor)[:-1]]
    fixed += [rig_with(RIG, effects).rolling_ratio, rig_with(RIG, effects).lever]
    laws = [
        (acceleration(*at, p), *(dry_limit(at[0], at[1], towards, *at[2:], p) for towards in (1.0, -1.0)))
        for at in states
    ]
    beam = beam_states(motion_with(Sines(), TURNING, effects), TURNING)
    return np.array([*fixed, *np.ravel(laws), *np.ravel(beam)])


def at(effect: Effect, **changed: float) -> list[Acting]:
    """The effect at its typical values, but for those given."""
    return [acting(effect.name, {one.name: one.typical for one in effect.parameters} | changed)]


@pytest.mark.parametrize("effect", CATALOGUE.values(), ids=lambda effect: effect.name)
def test_an_effect_goes_from_process_to_process_by_its_name(effect: Effect) -> None:
    """Be the catalogue's own entry again after pickling, laws and all."""
    assert pickle.loads(pickle.dumps(effect)) is effect
    with pytest.raises(pickle.PicklingError, match="not that of the catalogue"):
        pickle.dumps(replace(effect, phrase="another law under the same name"))


# Not the pivot, which is where the rig file says, nor a ball that slips, the less the larger its friction, never not at
# all.
VANISHING = [name for name, one in CATALOGUE.items() if not one.relations.in_baseline(CAM) and not one.engine.settings]


@pytest.mark.parametrize("name", VANISHING)
def test_an_effect_vanishes_with_its_strengths_and_with_nothing_else(name: str) -> None:
    """Do nothing where all strengths are zero, or at the neutral value of what is a factor or a radius."""
    effect = CATALOGUE[name]
    strengths = dict.fromkeys(effect.strengths, 0.0)
    if strengths:
        neutral = strengths
    else:
        neutral = {one.name: one.neutral_on(RIG) for one in effect.parameters}
        assert all(value != 0.0 for value in neutral.values())
    np.testing.assert_allclose(felt(at(effect, **neutral)), felt(NOTHING), rtol=1e-12, atol=1e-15)
    assert np.any(np.abs(felt(at(effect)) - felt(NOTHING)) > 1e-12)
    for one in effect.parameters:
        if not one.strength and one.low <= 0.0 and strengths:
            assert np.any(np.abs(felt(at(effect, **{one.name: 0.0})) - felt(NOTHING)) > 1e-12)


@pytest.mark.parametrize("name", [name for name, one in CATALOGUE.items() if one.relations.nested_in])
def test_a_spline_term_contains_the_laws_nested_in_it(name: str) -> None:
    """Push, resist per normal force, or be recorded alike in all states in which the spline term's regressor is the
    same."""
    effect = CATALOGUE[name]
    full, bare = (parameters_with(CAM, RIG, effects, phase=0.4) for effects in (at(effect), NOTHING))
    full[ORIGIN] = bare[ORIGIN] = 0.2

    def law(state: tuple[float, ...], friction: bool) -> float:
        sense = 1.0 if state[1] > 0.0 else -1.0
        limit = dry_limit(state[0], state[1], sense, *state[2:], full) + dahl_limit(*state, full)
        if friction:
            return limit / normal_force(*state, full)
        return acceleration(*state, full) - acceleration(*state, bare) - sense * limit

    pushed = 0.0
    if effect.tilting is not None:  # alike however the beam turns, at every time
        turning = [beam_states(motion_with(base, TURNING, at(effect)), TURNING) for base in (Sines(), Fixed(0.01))]
        tilts = [
            states[:, 0] - base.evaluate(TURNING) for states, base in zip(turning, (Sines(), Fixed(0.01)), strict=True)
        ]
        np.testing.assert_allclose(tilts[0], tilts[1], rtol=0.0, atol=1e-15)
        assert effect.relations.nested_in == (("time", False),)
        return
    if effect.sensor is not None:  # what is recorded is another function of the position, and of nothing else
        sensor = sensor_with(at(effect))
        assert effect.relations.nested_in == (("reading", False),)
        assert (sensor.lag, sensor.delay) == (0.0, 0.0)
        assert float(sensor.curve(np.array(0.3))) != 0.3
        return
    for regressor, friction in effect.relations.nested_in:
        index = {"position": 0, "velocity": 1, "angle": 2, "roll_angle": 0}.get(regressor)
        for fixed in (0.25, 0.31):
            # small tilts, as the spline term has none: cos α is 1 to 1e-4; faster than a Stribeck velocity of 20 mm/s
            states = [(0.1, 0.2, 0.01, 0.0, 0.0), (0.3, 0.12, -0.01, 0.0, 0.0), (0.45, 0.1, 0.0, 0.0, 0.0)]
            if index is not None:
                value = 0.01 * fixed if index == 2 else fixed
                states = [(*state[:index], value, *state[index + 1 :]) for state in states]
            pushes = [law(state, friction) for state in states]
            np.testing.assert_allclose(pushes, pushes[0], rtol=3e-4, atol=1e-12)
            pushed = max(pushed, *map(abs, pushes))
    assert pushed > 1e-6


@pytest.mark.parametrize("effect", CATALOGUE.values(), ids=CATALOGUE)
def test_a_place_is_a_place(effect: Effect) -> None:
    """Act alike further along if the place of the effect is moved as far; other lengths are no places."""
    shift = 0.05
    typical = {one.name: one.typical for one in effect.parameters}
    level = [(s, v, 0.0, 0.0, 0.0) for s in (0.25, 0.3, 0.36) for v in (-0.3, 0.2)]
    further = [(state[0] + shift, *state[1:]) for state in level]
    here = felt(at(effect), level)
    somewhere = bool(np.any(np.abs(felt(at(effect), further) - here) > 1e-9))
    for one in effect.parameters:
        if somewhere and one.unit == "m" and not one.strength:
            moved = felt(at(effect, **{one.name: typical[one.name] + shift}), further)
            assert one.place is np.allclose(moved, here, rtol=1e-9, atol=1e-12)
        else:
            assert not one.place


@pytest.mark.parametrize("effect", CATALOGUE.values(), ids=CATALOGUE)
def test_bounds_are_those_of_a_range_wherever_the_ball_was(effect: Effect) -> None:
    """Give every parameter a lower and an upper bound, also for a ball that never left the origin."""
    for visited in (np.zeros(5), np.linspace(-0.2, 0.4, 5)):
        for parameter in effect.parameters:
            low, high = parameter.bounds_on(visited, RIG)
            assert np.isfinite([low, high]).all()
            assert low < high, (parameter.name, visited)


@pytest.mark.parametrize("effect", CATALOGUE.values(), ids=CATALOGUE)
def test_what_holds_a_ball_at_rest_is_set_valued(effect: Effect) -> None:
    """Be marked as dry if, and only if, the law limits a force at rest."""
    p = parameters_with(CAM, RIG, at(effect))
    holds = any(dry_limit(0.3, 0.0, towards, 0.0, 0.0, 0.0, p) > 0.0 for towards in (1.0, -1.0))
    assert effect.dry is holds


def test_one_effect_stands_for_each_unknown_quantity() -> None:
    """Have one for K, for α₀, which acts as the rig's level angle does, and for h, which acts as its eccentricity."""
    standing = [one.relations.stands_for for one in CATALOGUE.values() if one.relations.stands_for]
    assert sorted(standing) == ["level", "lever", "ratio"]
    (level,) = (one for one in CATALOGUE.values() if one.relations.stands_for == "level")
    tilted = parameters_with(CAM, RIG.with_(level_angle=0.01), NOTHING)
    p = parameters_with(CAM, RIG.with_(level_angle=0.0), [acting(level.name, {"angle": 0.01})])
    assert [acceleration(*state, p) for state in STATES] == [acceleration(*state, tilted) for state in STATES]
    (pivot,) = (one for one in CATALOGUE.values() if one.relations.stands_for == "lever")
    lower = parameters_with(CAM, RIG.with_(eccentricity=0.05), NOTHING)
    p = parameters_with(CAM, RIG.with_(eccentricity=0.0), [acting(pivot.name, {"eccentricity": 0.05})])
    np.testing.assert_allclose(
        [acceleration(*state, p) for state in STATES], [acceleration(*state, lower) for state in STATES], rtol=1e-12
    )


@pytest.mark.parametrize(
    ("name", "parameter", "largest"),
    [
        ("rolling_resistance", "coefficient", 0.05),  # tan 2.9°
        ("angle_gain", "gain", 2.0),
        ("position_gain", "gain", 2.0),
        ("angle_lag", "time_constant", 1.0),
        ("angle_servo", "lag", 1.0),
        ("position_lag", "time_constant", 1.0),
    ],
)
def test_absurd_sizes_are_implausible(name: str, parameter: str, largest: float) -> None:
    """Call a friction implausible that holds a ball on 3°, a gain of two, and a lag of a second."""
    (one,) = [each for each in CATALOGUE[name].parameters if each.name == parameter]
    assert not one.plausible(largest, Rig())
    assert one.plausible(0.99 * largest, Rig())
    assert one.plausible(one.typical, Rig())


def test_a_drag_is_judged_by_what_it_does_to_a_ball() -> None:
    """Call a drag implausible that lets a ball roll no faster than 0.1 m/s down a slope of 0.05, whatever its mass."""
    for rig in (Rig(), Rig(mass=0.0027)):
        weight = 0.05 * rig.mass * rig.gravity
        for name, largest in (("viscous_damping", weight / 0.1), ("quadratic_drag", weight / 0.1**2)):
            (one,) = CATALOGUE[name].parameters
            assert one.plausible(0.99 * largest, rig)
            assert not one.plausible(1.01 * largest, rig)
