"""The identified rig as MJCF and URDF, with the effects that the format carries."""

from __future__ import annotations

import math

from analytic.rig import Rig
from harness.engines.injection import engine_settings
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.exports.beam import channel_in, start_of
from harness.exports.carried import levels, places_pivot, scene_effects
from harness.exports.model import ExportModel
from harness.exports.source import render
from mjcf.scene import make_scene
from urdf.scene import ball_urdf, beam_urdf, iterations_for

MJCF_FILE, BEAM_FILE, BALL_FILE, LOADER_FILE = "ball_beam.xml", "ball_beam.urdf", "ball.urdf", "load_in_pybullet.py"

_FEWEST = 100  # iterations of Bullet's solver: for a user's own steps and motions


def scene_rig(model: ExportModel, *, slips: bool) -> Rig:
    """The rig of the scene: with the effects that change it, and all constant tilts in its level angle."""
    kept = scene_effects(model, slips=slips)
    tilt = math.fsum(one.values[one.effect.parameters[0].name] for one in kept if levels(one.effect))
    rig = model.rig.with_(level_angle=model.rig.level_angle + tilt)
    for one in kept:
        if places_pivot(one.effect):
            rig = rig.with_(eccentricity=one.values["eccentricity"])
    return rig


def mjcf_files(model: ExportModel) -> dict[str, str]:
    """Text by name of the scene for MuJoCo, its viewer included: a servo turns the beam, stops end the track."""
    rig = scene_rig(model, slips=True)
    settings = engine_settings(scene_effects(model, slips=True), "mujoco")
    contact = MuJoCoParameters(**settings) if settings else None
    scene = make_scene(
        rig,
        channel=channel_in(model, rig),
        option=None if contact is None else contact.option(rig),
        pair=None if contact is None else contact.pair(rig),
        start=start_of(model),
    )
    return {MJCF_FILE: scene}


def urdf_files(model: ExportModel) -> dict[str, str]:
    """Text by name of beam, ball, and a loader for PyBullet, which has what URDF has not: gravity and the start."""
    rig = scene_rig(model, slips=False)
    gravity = (rig.gravity * math.sin(rig.level_angle), 0.0, -rig.gravity * math.cos(rig.level_angle))
    loader = render(
        "load_in_pybullet.py.jinja",
        {
            "beam": BEAM_FILE,
            "ball": BALL_FILE,
            "gravity": gravity,
            "iterations": iterations_for(rig, _FEWEST),
            "height": rig.eccentricity + rig.rolling_radius,
            "start": start_of(model),
        },
    )
    return {BEAM_FILE: beam_urdf(rig, channel_in(model, rig)), BALL_FILE: ball_urdf(rig), LOADER_FILE: loader}
