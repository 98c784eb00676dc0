"""Effects do to the ball what their laws say; set-valued frictions hold it at rest for good."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.effects import CATALOGUE, EffectError, acting, parameters_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import BeamMotion, FloatArray, beam_states
from analytic.rig import Rig
from tests.motions import Fixed, Sines

RIG = Rig()
M, R_, G = RIG.mass, RIG.rolling_radius, RIG.gravity
TIME = np.arange(0.0, 10.001, 0.01)
START = (0.36, 0.05)


def run(motion: BeamMotion, start: tuple[float, float], *effects: tuple[str, dict[str, float]]) -> FloatArray:
    """s and ṡ of CAM with effects, shape (2, n)."""
    grid = Grid.over(TIME)
    vector = parameters_with(CAM, RIG, [acting(name, values) for name, values in effects])
    runs = integrate(grid, grid.tabulate(motion), vector, np.array([start]))
    return np.stack((runs.position[0], runs.velocity[0]))


def eq_14_with(force: Callable[[float, float, float], float], tilt: Callable[[float], float]) -> FloatArray:
    """s of eq. 14 typed anew, with a force F(s, ṡ, t) [N] and a tilt [rad] that depends on s, on `Sines()`."""
    motion = Sines()

    def slope(t: float, y: FloatArray) -> tuple[float, float]:
        s, v = y
        angle, rate, angular = beam_states(motion, np.array([t]))[0].tolist()
        J, h = RIG.inertia, RIG.eccentricity
        right = M * G * math.sin(angle + tilt(s)) + M * s * rate**2 - (M * (h + R_) + J / R_) * angular + force(s, v, t)
        return v, right / (J / R_**2 + M)

    found = solve_ivp(slope, (0.0, 10.0), START, "DOP853", TIME, rtol=1e-11, atol=1e-12)
    position: FloatArray = found.y[0]
    return position


LAWS = {
    "viscous_damping": ({"coefficient": 0.03}, lambda s, v, t: -0.03 * v, lambda s: 0.0),
    "quadratic_drag": ({"coefficient": 0.2}, lambda s, v, t: -0.2 * abs(v) * v, lambda s: 0.0),
    "level_error": ({"angle": -0.005}, lambda s, v, t: 0.0, lambda s: -0.005),
    "track_curvature": ({"curvature": 0.06, "centre": 0.33}, lambda s, v, t: 0.0, lambda s: 0.06 * (0.33 - s)),
    "track_bump": (
        {"height": 3e-4, "centre": 0.45, "width": 0.03},
        lambda s, v, t: 0.0,
        lambda s: 3e-4 * (s - 0.45) / 0.03**2 * math.exp(-0.5 * ((s - 0.45) / 0.03) ** 2),
    ),
    "beam_compliance": ({"compliance": 0.02}, lambda s, v, t: 0.0, lambda s: 0.02 * M * G * s),
}


@pytest.mark.parametrize("name", LAWS)
def test_smooth_effect_obeys_its_law(name: str) -> None:
    """Follow eq. 14 with the effect's law typed anew, integrated adaptively."""
    values, force, tilt = LAWS[name]
    expected = eq_14_with(force, tilt)
    # The reference's tolerance grows over 10 s to about 1e-9 m; |ṡ| ṡ and the bump cost the kernel's order a little.
    np.testing.assert_allclose(run(Sines(), START, (name, values))[0], expected, atol=2e-8)


def test_rolling_resistance_stops_the_ball_where_its_work_is_done() -> None:
    """Roll out on a level beam over v²/(2 K c g): the kinetic energy over the resistance."""
    c, v = 0.004, 0.1
    position, velocity = run(Fixed(), (0.1, v), ("rolling_resistance", {"coefficient": c}))
    assert position[-1] - 0.1 == pytest.approx(v**2 / (2 * RIG.rolling_ratio * c * G), rel=1e-9)
    assert velocity[-1] == 0.0


@pytest.mark.parametrize("tilt", [0.99, -0.99])
@pytest.mark.parametrize(
    "friction",
    [
        ("rolling_resistance", {"coefficient": 0.004}),
        ("directional_resistance", {"coefficient_plus": 0.004, "coefficient_minus": 0.004}),
        (
            "stribeck_friction",
            {"static_coefficient": 0.004, "kinetic_coefficient": 0.002, "stribeck_velocity": 0.01},
        ),
    ],
    ids=lambda value: value[0],
)
def test_dry_friction_holds_the_ball_without_creep(tilt: float, friction: tuple[str, dict[str, float]]) -> None:
    """Keep a ball at rest to the bit on a slope just below atan(c)."""
    position, velocity = run(Fixed(tilt * math.atan(0.004)), (0.3, 0.0), friction)
    assert np.all(position == 0.3)
    assert np.all(velocity == 0.0)


def test_dry_friction_lets_go_above_its_limit() -> None:
    """Accelerate on a slope above atan(c) by K g (sin α − c cos α)."""
    c, tilt = 0.004, 0.006
    position, _ = run(Fixed(tilt), (0.3, 0.0), ("rolling_resistance", {"coefficient": c}))
    a = RIG.rolling_ratio * G * (math.sin(tilt) - c * math.cos(tilt))
    np.testing.assert_allclose(position, 0.3 + 0.5 * a * TIME**2, atol=1e-9)


def test_direction_decides_which_coefficient_resists() -> None:
    """Decelerate by K c₊ g towards + and by K c₋ g towards −."""
    values = {"coefficient_plus": 0.002, "coefficient_minus": 0.006}
    for sign, c in ((1, 0.002), (-1, 0.006)):
        _, velocity = run(Fixed(), (0.3, sign * 0.3), ("directional_resistance", values))
        assert velocity[50] == pytest.approx(sign * (0.3 - RIG.rolling_ratio * c * G * 0.5), rel=1e-9)


def test_effects_of_one_kind_add_up() -> None:
    """Take two level errors as their sum."""
    both = run(Sines(), START, ("level_error", {"angle": 0.002}), ("level_error", {"angle": 0.001}))
    np.testing.assert_allclose(both, run(Sines(), START, ("level_error", {"angle": 0.003})), atol=1e-12)


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("rolling_resistence", {}, "Did you mean 'rolling_resistance'"),
        ("level_error", {"angel": 0.1}, "has the parameters angle"),
        ("level_error", {"angle": 3.0}, "must lie between -0.2 and 0.2 rad"),
    ],
)
def test_wrong_effect_is_named(name: str, values: dict[str, float], message: str) -> None:
    """Say what exists when a name or value is wrong."""
    with pytest.raises(EffectError, match=message):
        acting(name, values)


def test_every_effect_says_what_it_is() -> None:
    """Give each effect a law, a source, and units and bounds that contain its typical size."""
    for name, effect in CATALOGUE.items():
        assert effect.name == name
        assert effect.law
        assert effect.source
        for parameter in effect.parameters:
            assert parameter.low <= parameter.typical <= parameter.high
            assert parameter.unit
