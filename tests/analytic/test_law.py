"""The acceleration at one instant is the paper's, and each effect adds to it what its law says."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from analytic.effects import Acting as ActingEffect
from analytic.effects import Effect, Force, Parameter, acting, parameters_with
from analytic.law import (
    DRY_OF_POSITION,
    DRY_OF_ROLL,
    OF_ANGLE,
    OF_POSITION,
    OF_ROLL,
    OF_VELOCITY,
    acceleration,
    accelerations,
    dry_limit,
    normal_force,
)
from analytic.models import CAM, CUM, CUM_LINEAR, FRICTION, Reading, coefficients
from analytic.motion import FloatArray
from analytic.rig import Rig
from analytic.slots import ORIGIN, SHAPE, SHAPE_COUNT, SHAPE_LOW, SHAPE_NODES, SHAPE_STEP

RIG = Rig(level_angle=0.01)
K, G, M, r = RIG.rolling_ratio, RIG.gravity, RIG.mass, RIG.rolling_radius
# s, ṡ, α, α̇, α̈: no two terms alike, either direction
STATES = [(0.4, -0.3, 0.05, 0.3, 2.0), (0.25, 0.2, -0.4, -0.7, -5.0)]
AT_ANY_STATE = pytest.mark.parametrize("state", STATES)
ROUNDING = 1e-14  # some ten operations on terms of at most g = 10 m/s², 1.1e-16 of them each


def vector(*effects: tuple[str, dict[str, float]], phase: float = 0.0) -> FloatArray:
    """CAM with these effects."""
    return parameters_with(CAM, RIG, [acting(name, values) for name, values in effects], phase=phase)


@AT_ANY_STATE
def test_models_are_those_of_the_paper(state: tuple[float, ...]) -> None:
    """Compute eq. 3, 4 and 14, divided by m and typed anew."""
    s, _, angle, rate, angular = state
    tilt, k = angle + RIG.level_angle, 1.0 / (1.0 + RIG.inertia / (M * RIG.radius**2))
    lever = RIG.eccentricity + r + RIG.inertia / (M * r)
    expected = {
        CUM: k * (G * math.sin(tilt) + s * rate**2),
        CUM_LINEAR: k * G * tilt,
        CAM: K * (G * math.sin(tilt) + s * rate**2 - lever * angular),
    }
    for model, each in expected.items():
        assert acceleration(*state, coefficients(model, RIG)) == pytest.approx(each, rel=0.0, abs=ROUNDING)


@AT_ANY_STATE
@pytest.mark.parametrize("speed", [-0.3, -0.004, 0.0, 0.004, 0.3])
def test_friction_is_the_reading_of_eq_15(state: tuple[float, ...], speed: float) -> None:
    """Subtract F_f/m as each reading has it, within and beyond the transition velocity."""
    s, _, angle, rate, angular = state
    f, tanh = RIG.friction_coefficient, math.tanh(speed / RIG.transition_velocity)
    expected = {
        Reading.PRINTED: f * tanh * G * math.cos(angle) * speed,
        Reading.PRINTED_DISSIPATIVE: f * abs(tanh) * G * math.cos(angle) * speed,
        Reading.COULOMB: f * G * math.cos(angle) * tanh,
        Reading.VISCOUS: f * speed / M,
    }
    for reading, each in expected.items():
        found = acceleration(s, speed, angle, rate, angular, coefficients(FRICTION[reading], RIG))
        assert found == pytest.approx(K * (G * math.sin(angle + RIG.level_angle) - each), rel=0.0, abs=ROUNDING)


TILTS: dict[str, tuple[dict[str, float], Callable[[float], float]]] = {
    "level_error": ({"angle": -0.005}, lambda s: -0.005),
    "track_curvature": ({"curvature": 0.06, "centre": 0.33}, lambda s: 0.06 * (0.33 - s)),
    "track_bump": (
        {"height": 3e-4, "centre": 0.3, "width": 0.06},
        lambda s: 3e-4 * (s - 0.3) / 0.06**2 * math.exp(-0.5 * ((s - 0.3) / 0.06) ** 2),
    ),
    "beam_compliance": ({"compliance": 0.02}, lambda s: 0.02 * M * G * s),
}


@AT_ANY_STATE
@pytest.mark.parametrize("name", TILTS)
def test_effect_of_the_track_tilts_gravity(state: tuple[float, ...], name: str) -> None:
    """Turn gravity, and nothing else, by the slope of the track where the ball is."""
    values, slope = TILTS[name]
    tilt = state[2] + RIG.level_angle
    expected = K * G * (math.sin(tilt + slope(state[0])) - math.sin(tilt))
    found = acceleration(*state, vector((name, values))) - acceleration(*state, vector())
    assert found == pytest.approx(expected, rel=0.0, abs=ROUNDING)


@AT_ANY_STATE
def test_drag_opposes_the_motion(state: tuple[float, ...]) -> None:
    """Add −c ṡ/m and −c |ṡ| ṡ/m, times K."""
    v, free = state[1], acceleration(*state, vector())
    viscous = acceleration(*state, vector(("viscous_damping", {"coefficient": 0.03}))) - free
    quadratic = acceleration(*state, vector(("quadratic_drag", {"coefficient": 0.2}))) - free
    assert viscous == pytest.approx(-K * 0.03 * v / M, rel=0.0, abs=ROUNDING)
    assert quadratic == pytest.approx(-K * 0.2 * abs(v) * v / M, rel=0.0, abs=ROUNDING)


@AT_ANY_STATE
def test_ball_out_of_balance_is_turned_by_its_weight(state: tuple[float, ...]) -> None:
    """Add K g (e/r) sin(φ + φ₀), φ counted from where the ball began to roll."""
    p = vector(("ball_imbalance", {"offset": 5e-5}), phase=0.7)
    p[ORIGIN] = 0.36
    expected = K * G * 5e-5 / r * math.sin((state[0] - 0.36) / r + 0.7)
    assert acceleration(*state, p) - acceleration(*state, vector()) == pytest.approx(expected, rel=0.0, abs=ROUNDING)


@AT_ANY_STATE
def test_pivot_that_the_baseline_leaves_out_adds_its_lever(state: tuple[float, ...]) -> None:
    """Give the α̈ term of eq. 14 with an eccentricity of its own."""
    found = acceleration(*state, vector(("eccentric_pivot", {"eccentricity": 0.05})))
    expected = acceleration(*state, coefficients(CAM, RIG.with_(eccentricity=0.05)))
    assert found == pytest.approx(expected, rel=0.0, abs=ROUNDING)


@AT_ANY_STATE
def test_ball_rolls_on_the_radius_that_is_said_to_be_the_real_one(state: tuple[float, ...]) -> None:
    """Be the model of a rig with that rolling radius."""
    found = acceleration(*state, vector(("rolling_radius", {"radius": 0.0105})))
    assert found == acceleration(*state, coefficients(CAM, RIG.with_(rolling_radius=0.0105)))


def test_many_accelerations_are_those_of_each() -> None:
    """Take states row by row."""
    s, v, *beam = np.array(STATES).T
    expected = [acceleration(*state, vector()) for state in STATES]
    np.testing.assert_array_equal(accelerations(s, v, np.column_stack(beam), vector()), expected)


@AT_ANY_STATE
def test_normal_force_carries_weight_and_inertia(state: tuple[float, ...]) -> None:
    """Give g cos α − 2 ṡ α̇ − s α̈ − (h + r) α̇², and nothing once the ball would lift off."""
    s, v, angle, rate, angular = state
    expected = G * math.cos(angle) - 2.0 * v * rate - s * angular - (RIG.eccentricity + r) * rate**2
    assert normal_force(*state, vector()) == pytest.approx(expected, rel=0.0, abs=ROUNDING)
    assert normal_force(s, v, angle, rate, 2.0 * G / s, vector()) == 0.0
    # just before it lifts off
    assert 0.0 < normal_force(0.5, 0.0, 0.0, 0.0, (G - 0.5) / 0.5, vector()) < 0.6


@AT_ANY_STATE
def test_dry_friction_is_a_share_of_the_normal_force(state: tuple[float, ...]) -> None:
    """Hold up to K c N/m, with the coefficient of the direction and Stribeck's fall from rest."""
    pressed = K * normal_force(*state, vector())
    angle = state[2:]
    two = vector(("directional_resistance", {"coefficient_plus": 0.002, "coefficient_minus": 0.006}))
    assert dry_limit(*state[:2], 1.0, *angle, two) == pytest.approx(0.002 * pressed, rel=1e-14)
    assert dry_limit(*state[:2], -1.0, *angle, two) == pytest.approx(0.006 * pressed, rel=1e-14)
    values = {"static_coefficient": 0.006, "kinetic_coefficient": 0.004, "stribeck_velocity": 0.3}
    falling = vector(("stribeck_friction", values))
    expected = (0.004 + 0.002 * math.exp(-((state[1] / 0.3) ** 2))) * pressed
    for towards in (1.0, -1.0):
        assert dry_limit(*state[:2], towards, *angle, falling) == pytest.approx(expected, rel=1e-14)
    assert dry_limit(*state[:2], 1.0, *angle, vector()) == 0.0


LOW, STEP, COUNT = 0.1, 0.1, 6


def with_spline_term(kind: float, nodes: FloatArray, low: float = LOW, step: float = STEP) -> FloatArray:
    """CAM with a spline term through these nodes; the ball began to roll at 0."""
    p = vector()
    p[SHAPE], p[SHAPE_LOW], p[SHAPE_STEP], p[SHAPE_COUNT] = kind, low, step, len(nodes)
    p[SHAPE_NODES : SHAPE_NODES + len(nodes)] = nodes
    return p


def force_of(kind: float, nodes: FloatArray, at: float, low: float = LOW, step: float = STEP) -> float:
    """What the spline term pushes the ball with where its quantity has this value, F/m [m/s²]."""
    state = {
        OF_POSITION: (at, -0.3, 0.05, 0.3, 2.0),
        OF_VELOCITY: (0.4, at, 0.05, 0.3, 2.0),
        OF_ANGLE: (0.4, -0.3, at, 0.3, 2.0),
        OF_ROLL: (at * r, -0.3, 0.05, 0.3, 2.0),
    }[kind]
    return (acceleration(*state, with_spline_term(kind, nodes, low, step)) - acceleration(*state, vector())) / K


@pytest.mark.parametrize("kind", [OF_POSITION, OF_VELOCITY, OF_ANGLE])
def test_spline_term_goes_through_its_nodes(kind: float) -> None:
    """Meet every node, keep a straight line up to its ends and a parabola between inner nodes, stay constant beyond."""
    at = LOW + STEP * np.arange(COUNT)
    nodes = np.array([0.3, -0.1, 0.2, 0.5, -0.4, 0.1])
    for place, node in zip(at, nodes, strict=True):
        assert force_of(kind, nodes, place) == pytest.approx(node, rel=0.0, abs=1e-13)
    for place in (0.13, 0.25, 0.38, 0.57):
        assert force_of(kind, 2.0 * at - 0.3, place) == pytest.approx(2.0 * place - 0.3, rel=0.0, abs=1e-13)
    for place in (0.23, 0.35, 0.48):  # Catmull and Rom's slopes are those of a parabola
        assert force_of(kind, 3.0 * at**2, place) == pytest.approx(3.0 * place**2, rel=0.0, abs=1e-13)
    assert force_of(kind, nodes, -0.9) == pytest.approx(nodes[0], rel=0.0, abs=1e-13)
    assert force_of(kind, nodes, 0.9) == pytest.approx(nodes[-1], rel=0.0, abs=1e-13)


def test_spline_term_in_its_end_spans_is_the_parabola_through_them() -> None:
    """Bend in the first and last span as the slope of the inner node and a straight continuation have it."""
    nodes = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
    # Hermite at mid-span: (here + there)/2 + (slope here − slope there)/8
    assert force_of(OF_POSITION, nodes, 0.15) == pytest.approx(0.5 + (1.0 - 0.0) / 8.0, rel=0.0, abs=1e-13)
    assert force_of(OF_POSITION, nodes, 0.55) == pytest.approx(0.5 + (0.5 - 1.0) / 8.0, rel=0.0, abs=1e-13)
    assert force_of(OF_POSITION, nodes, 0.25) == pytest.approx(0.5 + (0.0 + 0.5) / 8.0, rel=0.0, abs=1e-13)


def test_spline_term_over_the_rolled_angle_is_periodic() -> None:
    """Go on after the last node with the first, at any turn, forward and backward."""
    nodes = np.array([0.3, -0.1, 0.2, 0.5, -0.4, 0.1])
    step = 2.0 * math.pi / len(nodes)
    for turn in (-2, 0, 3):
        for n, node in enumerate(nodes):
            at = 2.0 * math.pi * turn + step * n
            # a rolled angle of 20 rad is rounded to 4e-15, and a slope is at most 1 N/kg a radian
            assert force_of(OF_ROLL, nodes, at, 0.0, step) == pytest.approx(node, rel=0.0, abs=1e-13)
            slopes = [(nodes[(n + 1 + k) % 6] - nodes[(n - 1 + k) % 6]) / 2.0 for k in (0, 1)]
            middle = (node + nodes[(n + 1) % 6]) / 2.0 + (slopes[0] - slopes[1]) / 8.0
            assert force_of(OF_ROLL, nodes, at + step / 2.0, 0.0, step) == pytest.approx(middle, rel=0.0, abs=1e-13)


@pytest.mark.parametrize(("kind", "quantity"), [(DRY_OF_POSITION, 1.0), (DRY_OF_ROLL, 1.0 / r)])
def test_spline_term_of_a_friction_is_its_coefficient(kind: float, quantity: float) -> None:
    """Hold K c N/m with c from the spline term, added to what is known, and push by itself nowhere."""
    state = (0.25, 0.2, -0.4, -0.7, -5.0)
    step = 2.0 * math.pi / 6 if kind == DRY_OF_ROLL else STEP
    nodes = np.array([0.001, 0.002, 0.004, 0.003, 0.002, 0.001])
    p = with_spline_term(kind, nodes, 0.0, step)
    assert acceleration(*state, p) == acceleration(*state, vector())
    smooth = with_spline_term(OF_ROLL if kind == DRY_OF_ROLL else OF_POSITION, nodes, 0.0, step)
    coefficient = (acceleration(*state, smooth) - acceleration(*state, vector())) / K
    assert coefficient > 0.001
    for known in (0.0, 0.005):
        p[:SHAPE] = vector(("rolling_resistance", {"coefficient": known}))[:SHAPE]
        expected = K * (known + coefficient) * normal_force(*state, p)
        # the coefficient is a difference of accelerations of 10 m/s²
        assert dry_limit(*state[:2], 1.0, *state[2:], p) == pytest.approx(expected, rel=1e-11)
    p[:SHAPE], p[SHAPE_NODES : SHAPE_NODES + 6] = vector()[:SHAPE], -nodes
    assert dry_limit(*state[:2], 1.0, *state[2:], p) == 0.0


@pytest.mark.parametrize(
    ("by", "law", "of"),
    [
        ("position", lambda at, size: size * (at**3 - at), lambda s, v, angle: s),
        ("velocity", lambda at, size: size * (at**3 - at), lambda s, v, angle: v),
        ("angle", lambda at, size: size * (at**3 - at), lambda s, v, angle: angle),
        ("roll_angle", lambda at, size: size * np.cos(at), lambda s, v, angle: (s - 0.36) / r),
    ],
)
@AT_ANY_STATE
def test_force_of_a_users_law_is_the_law(
    by: str, law: Callable[..., FloatArray], of: Callable[..., float], state: tuple[float, ...]
) -> None:
    """Push with a cubic law exactly, with a cosine to what 513 nodes a turn leave."""
    size = Parameter("size", "1", -1e3, 1e3, 1.0)
    one = ActingEffect(Effect("own", "F", (size,), "here", force=Force(by, law)), {"size": 0.02})
    p = parameters_with(CAM, RIG, [one])
    p[ORIGIN] = 0.36
    expected = K * float(law(np.array(of(*state[:3])), 0.02)) / M
    # between nodes h = 2π/512 apart, h⁴/384 + 0.1 h⁵/30 of the fourth and fifth derivatives: 6e-11 of 0.2 m/s²
    assert acceleration(*state, p) - acceleration(*state, vector()) == pytest.approx(expected, rel=0.0, abs=2e-11)
