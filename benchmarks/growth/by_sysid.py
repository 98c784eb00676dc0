"""`python -m benchmarks.growth.by_sysid CASE`: one fit of four parameters by `mujoco.sysid` (extra `sysid`).

Level angle, viscosity of the air, and position and velocity at the start of a free run over the first recording to
identify from: what a user fits who knows already that the ball is damped. The scene is the harness's own, at the time
step of the engines in a diagnosis, driven by the angle as the harness smooths it.
"""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import click
import mujoco
import numpy as np
from mujoco import rollout

from analytic.motion import FloatArray
from harness.identify.pose import problem_of
from harness.identify.problem.problem import PreparedRecording
from harness.recording import load_case
from mjcf.scene import default_option, default_pair, make_scene

_STEP = 2e-3  # of the engines in a diagnosis [s]
_MOST = 60  # iterations
_NAMES = ("viscosity_Pa_s", "level_angle_rad", "position_m", "velocity_m_s")


@click.command()
@click.argument("path", metavar="CASE", type=click.Path(exists=True, path_type=Path))
def main(path: Path) -> None:
    """Fit and print the values of the four parameters as JSON."""
    problem = problem_of(load_case(path))
    options = default_option(problem.rig, _STEP)
    scene = make_scene(problem.rig, option=options, pair=default_pair(problem.rig, _STEP), driven=True)
    click.echo(json.dumps(fit(scene, problem.rig.rolling_radius, problem.rig.gravity, problem.recordings[0])))


def fit(scene: str, radius: float, gravity: float, recording: PreparedRecording) -> dict[str, float]:
    """Values of the parameters, by name.

    Args:
        scene: MJCF of beam and ball, driven by the beam's angular acceleration.
        radius: rolling radius [m].
        gravity: g [m/s²].
        recording: to fit to.
    """
    sysid: Any = importlib.import_module("mujoco.sysid")
    spec = mujoco.MjSpec.from_string(scene)
    known = np.isfinite(recording.reading)
    stamps, reading = recording.time[known], recording.reading[known]
    grid = np.arange(stamps[0], stamps[-1] + 2.0 * _STEP, _STEP)
    angle = recording.drive.evaluate(np.minimum(grid, recording.time[-1]))
    control = np.diff(angle, 2, prepend=2.0 * angle[0] - angle[1])[:, None] / _STEP**2
    rate, height = float((angle[1] - angle[0]) / _STEP), float(spec.body("ball").pos[2])

    def set_viscosity(changed: mujoco.MjSpec, parameter: Any) -> None:
        changed.option.viscosity = parameter.value[0]

    def set_level(changed: mujoco.MjSpec, parameter: Any) -> None:
        level = parameter.value[0]
        changed.option.gravity = gravity * np.array([np.sin(level), 0.0, -np.cos(level)])

    parameters = sysid.ParameterDict()
    for parameter in (
        sysid.Parameter(_NAMES[0], 0.0, 0.0, 1.0, modifier=set_viscosity),
        sysid.Parameter(_NAMES[1], 0.0, -0.05, 0.05, modifier=set_level),
        sysid.Parameter(_NAMES[2], reading[0], -1.0, 2.0),
        sysid.Parameter(_NAMES[3], 0.0, -1.0, 1.0),
    ):
        parameters.add(parameter)

    def positions(x: FloatArray, given: Any) -> FloatArray:
        given.update_from_vector(x)
        model = sysid.apply_param_modifiers(given, spec)
        s, v = float(given[_NAMES[2]].value[0]), float(given[_NAMES[3]].value[0])
        cos, sin = np.cos(angle[0]), np.sin(angle[0])
        pose = np.array([angle[0], s * cos + height * sin, 0.0, height * cos - s * sin, 1.0, 0.0, 0.0, 0.0])
        along, across = v + height * rate, -s * rate
        speed = np.array(
            [rate, along * cos + across * sin, 0.0, across * cos - along * sin, 0.0, v / radius + rate, 0.0]
        )
        state, _ = rollout.rollout(model, mujoco.MjData(model), sysid.create_initial_state(model, pose, speed), control)
        run = state[0, :, 2] * np.cos(angle[1:]) - state[0, :, 4] * np.sin(angle[1:])  # x, z after time and beam angle
        return np.interp(stamps, grid, np.concatenate(([s], run)))

    def residual(x: FloatArray, given: Any) -> tuple[list[FloatArray], list[FloatArray], list[None]]:
        columns = np.atleast_2d(x.T)  # one vector, or columns of several at once
        rest = np.column_stack([positions(one, given) - reading for one in columns])
        return [rest if x.ndim > 1 else rest[:, 0]], [], []

    best, result = sysid.optimize(parameters, residual, optimizer="scipy", verbose=False, max_iters=_MOST)
    sysid.calculate_intervals(residual(result.x, parameters)[0], result.jac)
    return dict(zip(_NAMES, np.asarray(best.as_vector(), float).tolist(), strict=True))


if __name__ == "__main__":
    main()
