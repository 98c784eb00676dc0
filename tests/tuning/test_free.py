"""What may be tuned: names, bounds, and refusals that say what to do."""

from __future__ import annotations

import pytest

from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.errors import InputError
from harness.tuning.estimate.free import DEFAULT_FREE, Free, free_of, level_of

MUJOCO = engine_of("mujoco")


def free(*names: str, **settings: float) -> tuple[Free, ...]:
    """These parameters of MuJoCo on the paper's rig."""
    return free_of(MUJOCO, Rig(), parameters_of(MUJOCO, settings), names)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet"])
def test_the_default_set_is_within_the_bounds_of_the_engine(engine: str) -> None:
    """Accept every value that the screening tries, together with what it needs beside it."""
    loaded = engine_of(engine)
    for one in free_of(loaded, Rig(), parameters_of(loaded, {}), None):
        assert one.name in DEFAULT_FREE[engine]
        for value in one.tried:
            assert one.low <= value <= one.high
            if not one.quantity:
                parameters_of(loaded, {**one.beside, one.name: value})


def test_scales_lead_back_to_the_value() -> None:
    """Return a value from its number on the scale of the fit, logarithmic or not."""
    for one in (*free("friction", "solref_dampratio", "rolling_radius_m"), level_of(Rig())):
        for value in one.tried:
            # two roundings of double precision
            assert one.value(one.scaled(value)) == pytest.approx(value, rel=1e-14)


def test_a_rolling_radius_stays_within_the_ball() -> None:
    """Let no centre lie higher above the edges than one radius."""
    (one,) = free("rolling_radius_m")
    assert one.high == Rig().radius
    assert max(one.tried) <= Rig().radius


def test_on_a_flat_track_the_inertia_is_free_instead_of_the_rolling_radius() -> None:
    """Tune how the ball's mass is distributed where its rolling radius is its own."""
    flat = Rig(rolling_radius=0.0132)
    names = [one.name for one in free_of(MUJOCO, flat, parameters_of(MUJOCO, {}), None)]
    assert "inertia_kg_m2" in names
    assert "rolling_radius_m" not in names


@pytest.mark.parametrize(
    ("names", "settings", "told"),
    [
        (("fricton",), {}, "Did you mean 'friction'"),
        (("friction", "friction"), {}, "names friction twice"),
        (("friction",), {"friction": 0.3}, "set it or free it"),
        (("condim",), {}, "not a number to be fitted"),
        (("time_step",), {}, "not a number to be fitted"),
        (("friction=0.1",), {}, "friction=LOW:HIGH"),
        (("friction=0.2:0.1",), {}, "the smaller one first"),
        (("friction=nan:0.1",), {}, "are two numbers"),
        (("friction=0.01:1000",), {}, "give narrower ones"),
        (("friction=0.01:0.1", "mujoco.friction"), {}, "names friction twice"),
    ],
)
def test_what_cannot_be_free_is_refused(names: tuple[str, ...], settings: dict[str, float], told: str) -> None:
    """Say what is wrong with a name and what to do."""
    with pytest.raises(InputError, match=told):
        free(*names, **settings)


def test_bounds_of_the_user_narrow_those_of_the_engine() -> None:
    """Fit and try values between them alone, on the same kind of scale."""
    (one,) = free("friction=0.006:0.03")
    assert (one.low, one.high) == (0.006, 0.03)
    assert one.logarithmic
    assert one.tried == (0.01, 0.02)
    (narrow,) = free("mujoco.friction = 0.011:0.013")
    assert len(narrow.tried) > 1
    assert all(0.011 < value < 0.013 for value in narrow.tried)
    # one rounding of double precision at either end
    assert narrow.value(narrow.scaled(0.5)) == pytest.approx(0.013, rel=1e-15)


def test_bounds_of_the_level_hold_beside_any_set() -> None:
    """Take bounds of the level, which is free in any case, and refuse impossible ones."""
    assert free("level_angle_rad=-0.02:0.03") == ()
    level = level_of(Rig(), ["friction", "level_angle_rad=-0.02:0.03"])
    assert (level.low, level.high) == (-0.02, 0.03)
    with pytest.raises(InputError, match=r"its bounds are -0\.3491 to 0\.3491"):
        level_of(Rig(), ["level_angle_rad=-1:1"])
