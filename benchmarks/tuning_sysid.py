"""The same fit by `mujoco.sysid` (extra `sysid`): what a user writes who hands it the scene and a recording."""

from __future__ import annotations

import importlib
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout
from scipy.interpolate import CubicSpline

from analytic.motion import FloatArray

GRAVITY = 9.81
sysid: Any = importlib.import_module("mujoco.sysid")  # an extra


def fit_by_sysid(
    scene: str, radius: float, stamps: FloatArray, angle: FloatArray, position: FloatArray
) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    """Friction, level angle and start of one free run: values, and 95 % intervals, by name.

    Args:
        scene: MJCF of beam and ball, driven by the beam's angular acceleration.
        radius: rolling radius [m].
        stamps, angle, position: of the recording, the angle without noise and rounding, shape (n,) [s], [rad], [m].
    """
    spec = mujoco.MjSpec.from_string(scene)
    step = spec.option.timestep
    beam = CubicSpline(stamps, angle)
    grid = stamps[0] + step * np.arange(int(np.ceil((stamps[-1] - stamps[0]) / step)) + 2)
    alpha = beam(grid)
    control = np.diff(alpha, 2, prepend=2.0 * alpha[0] - alpha[1])[:, None] / step**2
    rate, height = float((alpha[1] - alpha[0]) / step), float(spec.body("ball").pos[2])

    def set_friction(changed: mujoco.MjSpec, parameter: Any) -> None:
        for pair in changed.pairs:
            pair.friction[1] = parameter.value[0]

    def set_level(changed: mujoco.MjSpec, parameter: Any) -> None:
        changed.option.gravity = GRAVITY * np.array([np.sin(parameter.value[0]), 0.0, -np.cos(parameter.value[0])])

    parameters = sysid.ParameterDict()
    parameters.add(sysid.Parameter("friction", 0.015, 0.002, 0.5, modifier=set_friction))
    parameters.add(sysid.Parameter("level_angle_rad", 0.0, -0.05, 0.05, modifier=set_level))
    parameters.add(sysid.Parameter("s", position[0], -1.0, 2.0))
    parameters.add(sysid.Parameter("v", 0.0, -1.0, 1.0))

    def positions(x: FloatArray, given: Any) -> FloatArray:
        given.update_from_vector(x)
        model = sysid.apply_param_modifiers(given, spec)
        s, v = float(given["s"].value[0]), float(given["v"].value[0])
        cos, sin = np.cos(alpha[0]), np.sin(alpha[0])
        pose = np.array([alpha[0], s * cos + height * sin, 0.0, height * cos - s * sin, 1.0, 0.0, 0.0, 0.0])
        along, across = v + height * rate, -s * rate
        speed = np.array(
            [rate, along * cos + across * sin, 0.0, across * cos - along * sin, 0.0, v / radius + rate, 0.0]
        )
        state, _ = rollout.rollout(model, mujoco.MjData(model), sysid.create_initial_state(model, pose, speed), control)
        x_ball, z_ball = state[0, :, 2], state[0, :, 4]  # after time and beam angle
        run = x_ball * np.cos(alpha[1:]) - z_ball * np.sin(alpha[1:])
        return np.interp(stamps, grid, np.concatenate(([s], run)))

    def residual(x: FloatArray, given: Any) -> tuple[list[FloatArray], list[FloatArray], list[None]]:
        # MuJoCo's optimizer hands in single columns, and columns of several vectors at once.
        columns = np.atleast_2d(x.T)
        rest = np.column_stack([positions(one, given) - position for one in columns])
        return [rest if x.ndim > 1 else rest[:, 0]], [], []

    best, result = sysid.optimize(parameters, residual, optimizer="scipy", verbose=False, max_iters=60)
    rest = residual(result.x, parameters)[0]
    _, halves = sysid.calculate_intervals(rest, result.jac)
    names = ("friction", "level_angle_rad", "s", "v")
    values = dict(zip(names, np.asarray(best.as_vector(), float).tolist(), strict=True))
    return values, {name: (values[name] - half, values[name] + half) for name, half in zip(names, halves, strict=True)}
