"""An entry of the catalogue answers what is asked of it: sizes, starts, bounds, strengths, where it enters."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.effects import CATALOGUE, Acting, Effect, Force, Parameter, acting, motion_with, parameters_with, rig_with
from analytic.effects.effect import EngineEntry, Transmission
from analytic.effects.force import EffectError
from analytic.effects.sensor_law import SensorLaw
from analytic.models import CAM, CUM
from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig
from analytic.slots import PHASE
from tests.motions import Sines

VISITED = np.linspace(0.2, 0.5, 301)
RIG = Rig(rolling_radius=0.01)
PLAIN = Parameter("size", "m", -1.0, 2.0, -0.25)
FACTOR = Parameter("gain", "1", 0.5, 2.0, 1.1, neutral=1.0)
RADIUS = Parameter("radius", "m", 1e-3, 0.1, 0.011, neutral=lambda rig: rig.rolling_radius)
PLACE = Parameter(
    "centre",
    "m",
    -10.0,
    10.0,
    0.3,
    starts=lambda visited, rig: [float(visited[0]), rig.rolling_radius],
    place=True,
    fitted=lambda visited, rig: (float(visited[0]) - rig.rolling_radius, float(visited[-1])),
)


def effect(**given: object) -> Effect:
    """An effect of one strength that does what is given."""
    entry: dict[str, object] = {"parameters": (PLAIN,), "source": "here", **given}
    return Effect("made", "F = size", **entry)  # type: ignore[arg-type]


def test_a_parameter_knows_its_usual_size() -> None:
    """Be off by its typical value, a place by 3 cm, a factor or a radius by a twentieth of what it should be."""
    assert [one.size(RIG) for one in (PLAIN, PLACE)] == [0.25, 0.03]
    assert FACTOR.size(RIG) == pytest.approx(0.05)
    assert RADIUS.size(RIG) == pytest.approx(0.0005)
    assert [one.neutral_on(RIG) for one in (PLAIN, FACTOR, RADIUS)] == [0.0, 1.0, 0.01]


def test_a_value_outside_the_usual_range_is_implausible() -> None:
    """Take the upper end, at which a fit may be held by a bound, as outside; a range may depend on the rig."""
    lag = Parameter("lag", "s", 0.0, 1.0, 0.05, usual=(0.0, 1.0))
    assert [lag.plausible(value, RIG) for value in (-0.1, 0.0, 0.5, 1.0)] == [False, True, True, False]
    radius = Parameter("radius", "m", 1e-3, 0.1, 0.011, usual=lambda rig: (0.0, rig.rolling_radius))
    assert [radius.plausible(value, RIG) for value in (0.009, 0.011)] == [True, False]
    assert radius.usual_on(RIG) == (0.0, 0.01)
    assert PLAIN.plausible(1e3, RIG)
    with pytest.raises(EffectError, match=r"typical is 0\.05, outside the usual range"):
        Parameter("lag", "s", 0.0, 1.0, 0.05, usual=(0.0, 0.05))


def test_a_fit_begins_where_the_parameter_says() -> None:
    """Begin at given starts, by recordings and rig where they depend on those, else at neutral or typical values."""
    given = Parameter("size", "m", -1.0, 2.0, -0.25, starts=(0.1, -0.1))
    assert list(given.starts_on(VISITED, RIG)) == [0.1, -0.1]
    assert list(PLACE.starts_on(VISITED, RIG)) == [0.2, 0.01]
    assert list(PLAIN.starts_on(VISITED, RIG)) == [-0.25]
    assert [list(one.starts_on(VISITED, RIG)) for one in (FACTOR, RADIUS)] == [[1.0], [0.01]]
    assert (given.fixed_starts, PLACE.fixed_starts) == ((0.1, -0.1), ())


def test_bounds_of_a_fit_follow_recordings_and_rig() -> None:
    """Fit within the parameter's bounds, or within closer ones that the recordings give."""
    assert PLAIN.bounds_on(VISITED, RIG) == (-1.0, 2.0)
    assert PLACE.bounds_on(VISITED, RIG) == pytest.approx((0.19, 0.5))


def test_a_bump_is_looked_for_where_the_ball_was() -> None:
    """Bound its place by the positions, an outlier or two aside, and 10 cm beyond; begin all along them."""
    _, centre, width = CATALOGUE["track_bump"].parameters
    visited = np.append(VISITED, 3.0)
    low, high = centre.bounds_on(visited, RIG)
    # 0.5 % of 302 positions are the first and last two millimetres
    assert low == pytest.approx(0.1, abs=2e-3)
    assert high == pytest.approx(0.6, abs=2e-3)
    starts = np.array(centre.starts_on(visited, RIG))
    assert starts.min() == pytest.approx(0.206, abs=2e-3)
    assert starts.max() == pytest.approx(0.495, abs=2e-3)
    assert np.diff(starts).max() < 0.03  # a bump is 2 cm wide
    assert width.bounds_on(visited, RIG)[1] < width.high


def test_a_curvature_is_looked_for_in_the_middle() -> None:
    """Begin with its centre amid the positions."""
    centre = CATALOGUE["track_curvature"].parameters[1]
    assert list(centre.starts_on(VISITED, RIG)) == pytest.approx([0.35])


@pytest.mark.parametrize("mass", [0.0027, 0.071, 1.0])
def test_a_presliding_is_looked_for_where_a_sensor_sees_it(mass: float) -> None:
    """Let a usual friction give way by 3 µm to 0.3 mm at the start, and never by less than any sensor can tell."""
    stiffness, rig = CATALOGUE["presliding_hysteresis"].parameters[1], RIG.with_(mass=mass)
    (low, high), friction = stiffness.bounds_on(VISITED, rig), 0.002 * mass * rig.gravity
    assert [friction / start for start in stiffness.starts_on(VISITED, rig)] == pytest.approx([3e-4, 3e-5, 3e-6])
    assert low < min(stiffness.starts_on(VISITED, rig)) < max(stiffness.starts_on(VISITED, rig)) < high
    assert friction / high == pytest.approx(3e-7)


def test_the_first_parameter_of_a_force_is_its_strength() -> None:
    """Take what is marked as strength; of a force, if nothing is, the first parameter; of anything else, none."""
    force = Force("position", lambda s, size, width: size * np.exp(-((s / width) ** 2)))
    two = (PLAIN, Parameter("width", "m", 0.01, 1.0, 0.1))
    assert effect(force=force, parameters=two).strengths == {"size"}
    marked = (PLAIN, Parameter("width", "m", 0.01, 1.0, 0.1, strength=True))
    assert effect(force=force, parameters=marked).strengths == {"width"}
    assert effect(write=lambda p, rig, values: None).strengths == frozenset()


def test_an_effect_says_how_it_enters_an_engine() -> None:
    """Push the ball, shape the scene, turn the beam or change what is recorded; settings of an engine push nothing."""

    def nothing(*_: object) -> None:
        return None

    pushing = effect(write=nothing)
    assert (pushing.pushes, pushing.enters) == (True, "force on the ball")
    assert effect(force=Force("position", lambda s, size: size * s)).pushes
    by_engine = effect(write=nothing, engine=EngineEntry("its own friction", {"mujoco": lambda values: {}}))
    assert (by_engine.pushes, by_engine.enters) == (False, "its own friction")
    assert effect(alter=lambda rig, values: rig).enters == "the scene's geometry"
    assert not effect(alter=lambda rig, values: rig).pushes
    for one in (effect(transmission=lambda values: Transmission()), effect(turn=lambda motion, stamps, values: motion)):
        assert (one.pushes, one.enters) == (False, "angle of the driven beam")
    sensed = effect(sensor=lambda values: SensorLaw())
    assert (sensed.pushes, sensed.enters) == (False, "sensor side: what is recorded of the position")


def test_a_model_lacks_what_it_is_not_said_to_have() -> None:
    """Have the pivot in CAM and not in CUM; any other effect in neither."""
    for name, one in CATALOGUE.items():
        has = [one.relations.in_baseline(model) for model in (CUM, CAM)]
        assert has == [False, name == "eccentric_pivot"]


def test_what_acts_says_so_with_its_values() -> None:
    """Give name, values and units, none for a number."""
    assert acting("rolling_resistance", {"coefficient": 0.002}).text() == "rolling_resistance (coefficient = 0.002)"
    bump = {"height": 1e-4, "centre": 0.3, "width": 0.02}
    assert acting("track_bump", bump).text() == "track_bump (height = 0.0001 m, centre = 0.3 m, width = 0.02 m)"


def test_the_ball_lies_at_zero_unless_told() -> None:
    """Take φ₀ = 0 where none is given, and any only for an effect to which it matters."""
    imbalance = [acting("ball_imbalance", {"offset": 1e-4})]
    assert parameters_with(CAM, RIG, imbalance)[PHASE] == 0.0
    assert parameters_with(CAM, RIG, imbalance, phase=0.7)[PHASE] == 0.7
    assert parameters_with(CAM, RIG, [acting("level_error", {"angle": 0.01})], phase=0.7)[PHASE] == 0.0
    assert rig_with(RIG, imbalance) is RIG


def test_an_effect_may_turn_the_beam_by_the_stamps() -> None:
    """Hand motion, stamps and values on to an effect that turns the beam in a way of its own."""
    seen: list[object] = []

    def turn(motion: BeamMotion, stamps: FloatArray, values: object) -> BeamMotion:
        seen.extend((motion, stamps, values))
        return motion

    motion, stamps, one = Sines(), np.linspace(0.0, 1.0, 11), effect(turn=turn)
    values = {"size": 0.5}
    assert motion_with(motion, stamps, [Acting(one, values)]) is motion
    assert seen == [motion, stamps, values]
