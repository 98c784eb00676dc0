"""A step of several balls on one beam gives each of them bit for bit what the step for all effects gives."""

from __future__ import annotations

import numpy as np
import pytest

from analytic.compiled import njit
from analytic.effects import acting, parameters_with
from analytic.kernel import Grid
from analytic.lean_step import DAMPED, DAMPED_DRY, DRY, GENERAL, SMOOTH, path_of
from analytic.models import CAM
from analytic.motion import FloatArray
from analytic.rig import Rig
from analytic.shared_step import ball_step, beam_step
from analytic.step import advance
from tests.motions import Sines

pytestmark = pytest.mark.slow

RIG = Rig(level_angle=0.002)
GRID = Grid.over(np.linspace(0.0, 5.0, 251))
RESISTANCE = {"rolling_resistance": {"coefficient": 0.03}}
STRIBECK = {"static_coefficient": 0.03, "kinetic_coefficient": 0.01, "stribeck_velocity": 0.05}
DAMPING = {"viscous_damping": {"coefficient": 0.02}, "quadratic_drag": {"coefficient": 0.03}}
EFFECTS: dict[str, tuple[int, dict[str, dict[str, float]]]] = {
    "nothing": (SMOOTH, {}),
    "a dry friction": (DRY, RESISTANCE),
    "a damping": (DAMPED, DAMPING),
    "a dry friction and a damping": (DAMPED_DRY, RESISTANCE | DAMPING),
    "a friction after Stribeck": (DRY, {"stribeck_friction": STRIBECK}),
    "slip": (GENERAL, {"contact_slip": {"friction_coefficient": 0.01}}),
}


@njit(cache=False)
def together(table: FloatArray, steps: FloatArray, balls: FloatArray, p: FloatArray) -> FloatArray:
    """s, ṡ and w of all balls after each step, shape (steps, balls, 3)."""
    path, out = path_of(p), np.empty((len(steps), *balls.shape))
    for j in range(len(steps)):
        on = beam_step(path, table, 2 * j, p)
        for i in range(len(balls)):
            s, v, w = out[j - 1, i] if j > 0 else balls[i]
            out[j, i] = ball_step(path, on, s, v, w, steps[j], table, 2 * j, p)
    return out


@pytest.mark.parametrize("name", EFFECTS)
def test_each_ball_takes_the_general_step(name: str) -> None:
    """Move balls that roll both ways, rest, stop and slip as one by one."""
    path, effects = EFFECTS[name]
    p = parameters_with(CAM, RIG, [acting(effect, values) for effect, values in effects.items()])
    assert path_of(p) == path
    balls = np.array([(0.36, 0.05, 0.0), (0.0, 0.0, 0.0), (-0.2, -0.3, 0.0), (0.1, 1e-4, 0.0)])
    table = GRID.tabulate(Sines())
    found = together(table, GRID.steps, balls, p)
    for i, (s, v, w) in enumerate(balls):
        for j, h in enumerate(GRID.steps):
            s, v, w = advance(s, v, w, h, table, 2 * j, p)
            assert tuple(found[j, i]) == (s, v, w)
    if path in (DRY, DAMPED_DRY):
        assert 0.02 < (found[:, :, 1] == 0.0).mean() < 0.98  # about stops as much as about motion
