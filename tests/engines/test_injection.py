"""Effects act in the engines as they act in the kernel and in the independent plant."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.effects import acting, parameters_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import FloatArray, State
from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.injection import force_of, motion_for_engine
from harness.simulator import Plant, simulate
from tests.motions import Fixed, Sines

RIG = Rig()
STAMPS = np.arange(1001) / 100.0
START = State(0.36, 0.0)
EFFECTS = {
    "viscous_damping": {"coefficient": 0.03},
    "directional_resistance": {"coefficient_plus": 0.002, "coefficient_minus": 0.005},
    "track_curvature": {"curvature": 0.06, "centre": 0.33},
    "beam_compliance": {"compliance": 0.003},
}


def in_engine(name: str, effect: str, values: dict[str, float], motion: Sines | Fixed) -> FloatArray:
    """s of an engine at its default step with one effect injected [m]."""
    engine, dt = engine_of(name), engine_of(name).parameters().time_step
    force = force_of([acting(effect, values)], RIG, motion, STAMPS, dt)
    return engine.run(RIG, motion, START, STAMPS, force=force).trajectory.position


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_rolling_resistance_in_engine_matches_the_independent_plant(name: str) -> None:
    """Roll, stop and turn as the virtual rig does, whose contact resists by a moment and not by this force."""
    motion = Sines()
    truth = simulate(Plant(rolling_resistance=0.003), motion, START, 10.0)
    position = in_engine(name, "rolling_resistance", {"coefficient": 0.003}, motion)
    # Each engine alone is within 1 µm of eq. 14; a turning point adds at most K c g dt² ≈ 2e-8 m/s to the velocity.
    assert np.max(np.abs(position - np.interp(STAMPS, truth.time, truth.position))) < 2e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
@pytest.mark.parametrize("effect", EFFECTS)
def test_effect_in_engine_matches_the_kernel(name: str, effect: str) -> None:
    """Move the engine's ball as the kernel's."""
    motion, values = Sines(), EFFECTS[effect]
    grid = Grid.over(STAMPS)
    vector = parameters_with(CAM, RIG, [acting(effect, values)])
    expected = integrate(grid, grid.tabulate(motion), vector, np.array([[START.position, 0.0]])).position[0]
    # As above; a force taken at the ball's position half a step late would cost some 1e-4 m.
    assert np.max(np.abs(in_engine(name, effect, values, motion) - expected)) < 5e-6


@pytest.mark.parametrize("time_step", [1e-3, 2e-3])
@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_ball_that_was_held_sets_off_as_in_the_kernel(name: str, time_step: float) -> None:
    """Stop, hold the ball while the slope is below atan(c), and let it go without a push of its own."""
    motion, effects = Sines(((0.012, 2.0, 0.0),)), [acting("rolling_resistance", {"coefficient": 0.003})]
    grid, start = Grid.over(STAMPS, 1e-3), State(0.1, 0.0)
    expected = integrate(grid, grid.tabulate(motion), parameters_with(CAM, RIG, effects), np.array([[0.1, 0.0]]))
    engine = engine_of(name)
    force = force_of(effects, RIG, motion, STAMPS, time_step)
    parameters = parameters_of(engine, {"time_step": time_step})
    position = engine.run(RIG, motion, start, STAMPS, parameters=parameters, force=force).trajectory.position
    assert (np.abs(expected.velocity[0]) < 1e-9).sum() > 5  # it is held for some hundredths of a second
    # Each of the 6 times it sets off within a step of up to dt, with K g |α̇| dt²/8 = 0.7 × 9.81 × 0.024 × 4e-6/8 =
    # 8e-8 m/s too much or too little at 2 ms, for 5 s on average; a velocity left over from the stop would be of the
    # order of K c g dt = 4e-5 m/s.
    assert np.max(np.abs(position - expected.position[0])) < 6 * 8e-8 * 5.0


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_ball_at_rest_stays_at_rest_in_engine(name: str) -> None:
    """Hold the ball on a slope below atan(c): no creep beyond what the engine's own contact leaves."""
    position = in_engine(name, "rolling_resistance", {"coefficient": 0.004}, Fixed(0.0035))
    # Without friction the ball would be more than a metre away.
    assert np.ptp(position) < 1e-7


@pytest.mark.parametrize(
    ("effect", "values"),
    [
        ("angle_nonlinearity", {"square": 0.6, "cube": 4.0}),
        ("angle_hold", {"interval": 0.12}),
        ("angle_lag", {"time_constant": 0.1}),
        ("angle_servo", {"lag": 0.12, "damping": 0.6}),
        ("level_drift", {"rate": 5e-4}),
    ],
)
def test_beam_of_the_engine_turns_as_the_independent_plants(effect: str, values: dict[str, float]) -> None:
    """Drive the engine's beam as the virtual rig's linkage moves its own: the ball runs alike, and else elsewhere."""
    motion = Sines()
    truth = simulate(Plant().with_effects({effect: values}), motion, START, 10.0)
    expected = np.interp(STAMPS, truth.time, truth.position)
    engine = engine_of("mujoco")
    driven = motion_for_engine([acting(effect, values)], motion, STAMPS)
    # Each alone is within 1 µm of eq. 14; the plant takes the angle for straight within a step of 0.1 ms.
    assert np.max(np.abs(engine.run(RIG, driven, START, STAMPS).trajectory.position - expected)) < 3e-6
    assert np.max(np.abs(engine.run(RIG, motion, START, STAMPS).trajectory.position - expected)) > 1e-2


def test_no_effect_is_no_force() -> None:
    """Leave the engine alone when nothing acts."""
    assert force_of([], RIG, Fixed(), STAMPS, 1e-3) is None
