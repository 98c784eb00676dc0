"""On a flat rail, and in grooves as shallow as one likes, the engines roll the ball as eq. 14 says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.effects import acting, parameters_with
from analytic.geometry import FLAT_BELOW
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import FloatArray, State
from analytic.rig import SOLID_SPHERE, Rig
from analytic.slots import ORIGIN
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.health import Failure
from harness.engines.injection import engine_settings, force_of
from harness.engines.protocol import EngineRun
from harness.errors import EngineFailure
from harness.simulator import Plant, simulate
from tests.engines.test_dart import needs_dart
from tests.motions import Fixed, Sines
from tests.reference import reference

BALL = Rig()
SOLID = BALL.with_(inertia=SOLID_SPHERE * BALL.mass * BALL.radius**2)
FLAT = SOLID.with_(rolling_radius=BALL.radius)
MOTION, START, STAMPS = Sines(), State(0.36, 0.0), np.arange(1001) / 100.0
NAMES = ["mujoco", "pybullet", pytest.param("dart", marks=needs_dart)]
# Error at 1 ms over 10 s [m]. All three schemes are of second order: s shifts by s⃛ dt³/12 a step, with
# s⃛ <= K g |α̇| = 5/7 × 9.81 × 0.13 = 0.9 m/s³ of one sign for a quarter of a period of 3.7 s, passed on as velocity for
# 10 s: 0.9/12 × 1e-6 × 0.92 × 10 = 0.7 µm. MuJoCo's and PyBullet's errors may be twice that. DART's ball rides up to a
# tenth of SINK g dt² = 0.3 µm off its height: 2 (1 − K) × 0.03 µm/R of a path of 1.5 m are 2 µm more.
BOUND = {"mujoco": 1.4e-6, "pybullet": 1.4e-6, "dart": 3.4e-6}
EFFECTS = {
    "viscous_damping": {"coefficient": 0.03},
    "quadratic_drag": {"coefficient": 0.2},
    "rolling_resistance": {"coefficient": 0.003},
    "directional_resistance": {"coefficient_plus": 0.002, "coefficient_minus": 0.005},
    "stribeck_friction": {"static_coefficient": 0.005, "kinetic_coefficient": 0.003, "stribeck_velocity": 0.02},
    "level_error": {"angle": -0.003},
    "track_curvature": {"curvature": 0.06, "centre": 0.33},
    "track_bump": {"height": 3e-4, "centre": 0.45, "width": 0.03},
    "beam_compliance": {"compliance": 0.003},
    "ball_imbalance": {"offset": 5e-5},
}


def groove(gap: float) -> Rig:
    """A solid ball on edges whose half distance is this share of its radius."""
    return SOLID.with_(rolling_radius=SOLID.radius * math.sqrt(1.0 - gap**2))


def run(name: str, rig: Rig = FLAT, **settings: float) -> EngineRun:
    """Drive the two sines."""
    engine = engine_of(name)
    return engine.run(rig, MOTION, START, STAMPS, parameters=parameters_of(engine, settings))


def error_of(result: EngineRun, rig: Rig = FLAT) -> float:
    """max |s − s of eq. 14| [m]."""
    return float(np.abs(result.trajectory.position - reference(CAM, rig, MOTION, START, STAMPS).position).max())


def kernel(effect: str, values: dict[str, float], longest: float = 2.5e-3) -> FloatArray:
    """s of the kernel on a flat rail with one effect [m]."""
    grid = Grid.over(STAMPS, longest)
    vector = parameters_with(CAM, FLAT, [acting(effect, values)])
    vector[ORIGIN] = START.position
    return integrate(grid, grid.tabulate(MOTION), vector, np.array([[START.position, 0.0]])).position[0]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("rig", [FLAT, FLAT.with_(level_angle=-0.0028, eccentricity=-0.02)], ids=["level", "tilted"])
def test_a_ball_on_a_flat_rail_follows_eq_14(name: str, rig: Rig) -> None:
    """Roll over a metre with K = 5/7 and stay within a few micrometres of the reference solution."""
    assert rig.rolling_ratio == pytest.approx(5.0 / 7.0)
    assert error_of(run(name, rig), rig) < BOUND[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_the_error_vanishes_with_the_step(name: str) -> None:
    """Step at 0.1 ms: a hundredth of the error, plus the slip that MuJoCo leaves to first order."""
    # ½ s α̇² dt × 0.2/1.8 × (1 − K) over 10 s with s α̇² = 0.01 m/s² on average (tests/engines/test_mujoco.py)
    slip = 0.5 * 0.01 * 1e-4 * 0.2 / 1.8 * (1.0 - FLAT.rolling_ratio) * 10.0 if name == "mujoco" else 0.0
    assert error_of(run(name, time_step=1e-4)) < 0.01 * BOUND[name] + slip


@pytest.mark.parametrize("name", NAMES)
def test_the_ball_stays_on_the_line_and_turns_with_its_radius(name: str) -> None:
    """Keep one loaded contact, the height R and y = 0, where nothing but symmetry guides the ball, and s/φ = R."""
    result = run(name)
    health = result.health
    assert (health.contacts_min, health.contacts_max) == (1, 1)
    assert health.lateral_offset_max < 1e-12  # rounding
    # Half the way by which the surface leaves its tangent in a step, (2 ṡ α̇ + s α̈) dt²/4 <= 0.1 µm.
    assert health.height_error_max < 0.1e-6
    # N/m lies between g and g − 2 ṡ α̇ − s α̈, less than 1 m/s² apart.
    assert 0.85 * FLAT.mass * FLAT.gravity < health.normal_force_min < FLAT.mass * FLAT.gravity
    travel = result.trajectory.position - START.position
    radius = float(travel @ result.rolled_angle / (result.rolled_angle @ result.rolled_angle))
    assert radius == pytest.approx(FLAT.rolling_radius, rel=1e-5)  # 0.1 µm of 13 mm


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("gap", [0.01, 0.999 * FLAT_BELOW, 1.001 * FLAT_BELOW, 0.2])
def test_nothing_changes_between_a_groove_and_a_flat_rail(name: str, gap: float) -> None:
    """Stay as exact for every r close to R, whether edges or a plane carry the ball."""
    assert error_of(run(name, groove(gap)), groove(gap)) < BOUND[name]


@pytest.mark.parametrize("name", NAMES)
def test_the_step_of_a_diagnosis_suits_a_flat_rail_and_the_shallowest_groove(name: str) -> None:
    """Roll with steps of 2 ms too, with four times the error."""
    for rig in (FLAT, groove(1.001 * FLAT_BELOW)):
        assert error_of(run(name, rig, time_step=2e-3), rig) < 4.0 * BOUND[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_acts_on_a_flat_rail_as_in_the_kernel(name: str, effect: str) -> None:
    """Move the engine's ball as the kernel's under every law that acts on the ball."""
    values, dt = EFFECTS[effect], engine_of(name).parameters().time_step
    force = force_of([acting(effect, values)], FLAT, MOTION, STAMPS, dt, origin=START.position)
    result = engine_of(name).run(FLAT, MOTION, START, STAMPS, force=force)
    # ṡ and so a force are known half a step late to second order: as the engines' own error, and at each of some ten
    # turning points K c g dt² ≈ 5e-8 m/s, for 5 s on average.
    bound = BOUND[name] + 10 * 5e-8 * 5.0
    if effect == "ball_imbalance":  # on its hills an error grows by √(K g e)/R = 1.4 a second, for one: e^1.4
        bound *= 4.1
    assert np.abs(result.trajectory.position - kernel(effect, values)).max() < bound


@pytest.mark.parametrize("effect", [*EFFECTS, "presliding_hysteresis", "contact_slip"])
def test_the_virtual_rig_moves_the_ball_on_a_flat_rail_as_the_kernel(effect: str) -> None:
    """Agree with the plant, which shares no equation with the kernel, as in a groove."""
    others = {
        "presliding_hysteresis": {"coefficient": 0.003, "stiffness": 50.0},
        "contact_slip": {"friction_coefficient": 0.012},
    }
    values = {**EFFECTS, **others}[effect]
    truth = simulate(Plant(rig=FLAT, step=5e-5).with_effects({effect: values}), MOTION, START, 10.0)
    # bounds as in tests/test_effects_against_plant.py
    bound = 2e-5 if effect == "presliding_hysteresis" else 3e-6
    assert np.abs(kernel(effect, values) - np.interp(STAMPS, truth.time, truth.position)).max() < bound


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_a_slippery_flat_rail_lets_the_ball_slide_by_coulombs_law(name: str) -> None:
    """Slide with μ N of friction down a slope that μ does not hold: (g sin α − μ g cos α) t²/2."""
    tilt, mu, dt = 0.2, 0.02, 1e-4
    settings = engine_settings([acting("contact_slip", {"friction_coefficient": mu})], name) | {"time_step": dt}
    engine, stamps = engine_of(name), np.linspace(0.0, 0.5, 51)
    slid = engine.run(FLAT, Fixed(tilt), State(0.0, 0.0), stamps, parameters=parameters_of(engine, settings))
    sliding = FLAT.gravity * (math.sin(tilt) - mu * math.cos(tilt))
    rolling = FLAT.rolling_ratio * FLAT.gravity * math.sin(tilt)
    # A run starts rolling, so that its velocity is off by dt/2 times the difference of the accelerations.
    # MuJoCo lifts a sliding contact by μ times the slip that it removes in a step, a hundredth: 1e-4 of N.
    slack = 0.5 * dt * 0.5 * abs(rolling - sliding) + 1e-4 * 0.5 * sliding * 0.25
    assert slid.trajectory.position[-1] == pytest.approx(0.5 * sliding * 0.25, abs=slack)


@pytest.mark.parametrize("name", NAMES)
def test_the_grip_of_a_shallow_groove_is_that_of_its_edges(name: str) -> None:
    """Hold the ball with μ slightly above (1 − K) tan α r/R, and let it slide with μ slightly below."""
    rig, tilt = groove(0.999 * FLAT_BELOW), 0.1
    needed = (1.0 - rig.rolling_ratio) * math.tan(tilt) * rig.rolling_radius / rig.radius
    parameter = {"mujoco": "friction", "pybullet": "lateral_friction_rail", "dart": "friction"}[name]
    engine = engine_of(name)
    # r/R is 0.995: without it, the first would slide
    for factor, holds in ((1.003, True), (0.997, False)):
        parameters = parameters_of(engine, {parameter: factor * needed, "slip_limit": 1e-4})
        arguments = (rig, Fixed(tilt), State(0.0, 0.0), np.linspace(0.0, 0.5, 51))
        if holds:
            engine.run(*arguments, parameters=parameters)
        else:
            with pytest.raises(EngineFailure) as caught:
                engine.run(*arguments, parameters=parameters)
            assert caught.value.failure is Failure.SLIPPED


@pytest.mark.parametrize("name", NAMES)
def test_a_ball_that_is_thrown_off_a_flat_rail_is_a_failure(name: str) -> None:
    """Notice a beam that falls away below the ball."""
    with pytest.raises(EngineFailure) as caught:
        engine_of(name).run(FLAT, Sines(((0.1, 12.6, 0.0),)), START, STAMPS)
    assert caught.value.failure is Failure.LIFTED_OFF
