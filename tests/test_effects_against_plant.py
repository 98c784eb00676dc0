"""Kernel and virtual rig, which share no equation, move the ball alike under every effect that acts on the ball."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.effects import acting, motion_with, parameters_with
from analytic.kernel import Grid, integrate
from analytic.models import CAM
from analytic.motion import State
from analytic.rig import Rig
from harness.simulator import Plant, simulate
from tests.motions import Sines

RIG, MOTION, TIME = Rig(), Sines(), np.arange(1001) / 100.0
EFFECTS = {
    "viscous_damping": {"coefficient": 0.03},
    "quadratic_drag": {"coefficient": 0.2},
    "rolling_resistance": {"coefficient": 0.004},
    "directional_resistance": {"coefficient_plus": 0.002, "coefficient_minus": 0.005},
    "stribeck_friction": {"static_coefficient": 0.005, "kinetic_coefficient": 0.003, "stribeck_velocity": 0.02},
    "presliding_hysteresis": {"coefficient": 0.003, "stiffness": 50.0},
    "level_error": {"angle": -0.003},
    "track_curvature": {"curvature": 0.06, "centre": 0.33},
    "track_bump": {"height": 3e-4, "centre": 0.45, "width": 0.03},
    "beam_compliance": {"compliance": 0.005},
    "level_drift": {"rate": 5e-4},
    "level_per_recording": {"spread": 0.004},
    "rolling_radius": {"radius": 0.0105},
    "contact_slip": {"friction_coefficient": 0.012},
}


@pytest.mark.parametrize("name", EFFECTS)
def test_kernel_moves_the_ball_as_the_plant_does(name: str) -> None:
    """Agree over 10 s and metres of travel, with stops, turns, slipping and micro-displacement."""
    values = EFFECTS[name]
    truth = simulate(Plant(step=5e-5).with_effects({name: values}), MOTION, State(0.36, 0.0), 10.0)
    grid = Grid.over(TIME)
    effects = [acting(name, values)]
    vector, beam = parameters_with(CAM, RIG, effects), motion_with(MOTION, TIME, effects)
    position = integrate(grid, grid.tabulate(beam), vector, np.array([[0.36, 0.0]])).position[0]
    # The kernel's step of 2.5 ms leaves K c g h²/2 ≈ 8e-8 m/s at each of some ten stops, and Dahl's spring of 22 rad/s
    # (ω h)²/24 of a stretch of 40 µm at each reversal: 1 and 10 µm after 10 s.
    bound = 2e-5 if name == "presliding_hysteresis" else 3e-6
    assert np.max(np.abs(position - np.interp(TIME, truth.time, truth.position))) < bound


@pytest.mark.parametrize("longest", [2.5e-3, 1e-4])
@pytest.mark.parametrize(("grip", "rolling"), [(0.012, 0.002), (0.012, 0.004), (0.008, 0.004)])
def test_a_ball_that_slides_is_also_resisted_in_rolling(grip: float, rolling: float, longest: float) -> None:
    """Move alike where slipping and rolling resistance act at once, closer with shorter steps."""
    values = {"contact_slip": {"friction_coefficient": grip}, "rolling_resistance": {"coefficient": rolling}}
    truth = simulate(Plant(step=5e-5).with_effects(values), MOTION, State(0.36, 0.0), 10.0)
    slides = np.abs(truth.slip) > 1e-9  # rounding leaves 1e-16
    assert 0.4 < np.mean(slides) < 0.9
    grid = Grid.over(TIME, longest)
    vector = parameters_with(CAM, RIG, [acting(name, one) for name, one in values.items()])
    position = integrate(grid, grid.tabulate(MOTION), vector, np.array([[0.36, 0.0]])).position[0]
    # Where a ball that slides, or begins to just then, turns round within a step, the kernel lets the resistance go on
    # as it was, c N/(m ι) in the slip the one way instead of the other. Friction moves ṡ − w/(1 + 1/ι) as little as
    # the impulse of a bat its centre of percussion: that is wrong by 2 K c g h, and so is ṡ when the slip has ended. N
    # is the weight to a percent; all else is as above.
    turning = truth.spin - truth.rate
    ends = truth.time[1:][(turning[1:] * turning[:-1] <= 0.0) & (slides[1:] | slides[:-1])]
    assert len(ends)
    step_left = 2.0 * RIG.rolling_ratio * rolling * RIG.gravity * longest
    bound = 3e-6 + 1.01 * step_left * np.sum(TIME[-1] - ends)
    assert np.max(np.abs(position - np.interp(TIME, truth.time, truth.position))) < bound
    # Either law alone is elsewhere by more than the whole bound.
    for name, one in values.items():
        vector = parameters_with(CAM, RIG, [acting(name, one)])
        alone = integrate(grid, grid.tabulate(MOTION), vector, np.array([[0.36, 0.0]])).position[0]
        assert np.max(np.abs(alone - position)) > 10.0 * bound


# Effects that act between the measured angle and the ball's equation.
TURNING = {
    "angle_lag": {"time_constant": 0.15},
    "angle_servo": {"lag": 0.15, "damping": 0.5},
    "angle_nonlinearity": {"square": 0.6, "cube": 4.0},
    "angle_hold": {"interval": 0.1234},
}


@pytest.mark.parametrize("name", TURNING)
def test_beam_turns_in_the_model_as_the_plants_does(name: str) -> None:
    """Turn the beam, and move the ball on it, as the virtual rig does, whose linkage shares nothing with the model."""
    effect = acting(name, TURNING[name])
    truth = simulate(Plant(step=5e-5).with_effects({name: TURNING[name]}), MOTION, State(0.36, 0.0), 10.0)
    beam = motion_with(MOTION, TIME, [effect])
    grid = Grid.over(TIME)
    vector = parameters_with(CAM, RIG, [effect])
    position = integrate(grid, grid.tabulate(beam), vector, np.array([[0.36, 0.0]])).position[0]
    # As above; a quintic through stamps 10 ms apart leaves 0.01⁶/46080 of the sixth derivative, 1e-15 rad, and the
    # plant takes the angle for straight within a step: (ω h)²/8 of it, 1e-10 rad, in ten seconds 3e-8 m.
    assert np.max(np.abs(position - np.interp(TIME, truth.time, truth.position))) < 3e-6
    angles = np.interp(TIME, truth.time, truth.angle)
    assert np.max(np.abs(beam.evaluate(TIME) - angles)) < 1e-8
    assert np.max(np.abs(MOTION.evaluate(TIME) - angles)) > 1e-3
