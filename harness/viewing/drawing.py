"""The scene that is drawn by MuJoCo: the rig of `mjcf.scene`, the engine's ball in it, the recorded ball as a ghost.

Nothing is simulated here: beam and ball are put where a run has them.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np

from harness.viewing.playback import Instant, Playback, centre_of, turned_by
from mjcf.scene import make_scene

ENGINE_COLOUR = (0.95, 0.45, 0.10)
GHOST_COLOUR = (0.10, 0.35, 0.95)
GHOST_OPACITY = 0.3
# So that the ghost is a shell around the engine's ball where both are at one place.
GHOST_SIZE = 1.06
FOVY = 20.0  # [deg]: small, so that lengths along the beam look alike everywhere
AZIMUTH, ELEVATION = 85.0, -12.0  # of the direction of view, almost across the beam [deg]
# What carries the beam, and how it is drawn where it would hide a ball above the pivot.
STAND = ("cheek_left", "cheek_right", "bracket_left", "bracket_right", "axle")
STAND_OPACITY = 0.1
# Side of the picture of shadows [pixels]; with 4096 a processor without graphics takes a third as long again. What of
# the light's cone it covers is no more than the beam, or its pixels are so large that the walls shade themselves.
SHADOWS = 2048
SHADOW_MARGIN = 1.1  # of the angle covered over that under which the light sees the beam
STRIP = 2.5  # aspect beyond which the beam is put into the lower half, below what is written above it
NARROWEST = 30.0  # width of the picture, in radii of the ball
MARGIN = 1.06  # of the width of the picture over the length of the beam


class Drawing:
    """MuJoCo's model of what is shown, with the balls where they are at an instant."""

    def __init__(self, playback: Playback) -> None:
        """Make the scene of the playback's rig."""
        self.playback = playback
        self.model = mujoco.MjModel.from_xml_string(make_scene(playback.runs[0].rig, channel=playback.channel))
        self.model.vis.global_.fovy = FOVY
        self.model.vis.quality.shadowsize = SHADOWS
        self.model.mat("steel").rgba[:3] = ENGINE_COLOUR  # of the ball alone; its cross stays dark
        self._see_through_stand()
        self._shadow_the_beam_alone()
        self.data = mujoco.MjData(self.model)
        self._instant: Instant | None = None
        self._ball = self.model.geom("ball").id

    def _see_through_stand(self) -> None:
        """Make what carries the beam translucent if it is higher than the walls between which the ball rolls."""
        cheek = self.model.geom(STAND[0])
        if cheek.pos[2] + cheek.size[2] <= self.playback.channel.wall_top:
            return
        for name in STAND:
            geom = self.model.geom(name)
            geom.rgba[:] = *self.model.mat_rgba[geom.matid[0], :3], STAND_OPACITY
            geom.matid[0] = -1

    def _shadow_the_beam_alone(self) -> None:
        """Narrow the cone in which the key light casts shadows to the beam, which it sees from a given place."""
        light, channel = int(np.flatnonzero(self.model.light_castshadow)[0]), self.playback.channel
        ends = np.array([(x, 0.0, channel.ball_height) for x in (channel.x_from, channel.x_to)])
        ways = ends - self.model.light_pos[light]
        towards = self.model.light_dir[light] / np.linalg.norm(self.model.light_dir[light])
        widest = np.degrees(np.arccos(np.min(ways @ towards / np.linalg.norm(ways, axis=1))))
        share = SHADOW_MARGIN * float(widest) / float(self.model.light_cutoff[light])
        self.model.vis.map.shadowscale = min(self.model.vis.map.shadowscale, share)

    def place(self, run: int, time: float) -> Instant:
        """Put beam and ball where they are in a run at `time` [s]; what is shown now."""
        self._instant = now = self.playback.at(run, time)
        rig = self.playback.runs[run].rig
        known = math.isfinite(now.position)
        self.model.geom_rgba[self._ball, 3] = self.model.mat("steel").rgba[3] = float(known)
        self.data.qpos[0] = now.angle
        self.data.qpos[1:4] = centre_of(rig, now.position if known else 0.0, now.angle)
        self.data.qpos[4:8] = turned_by(now.spin)
        self.data.qvel[:] = 0.0
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)
        return now

    def add_ghost(self, scene: mujoco.MjvScene) -> None:
        """Add the recorded ball of the instant to what `scene` draws, where it is known."""
        now = self._instant
        if now is None or not math.isfinite(now.recorded) or scene.ngeom >= scene.maxgeom:
            return
        rig = self.playback.runs[0].rig
        radius = GHOST_SIZE * float(self.model.geom_size[self._ball, 0])
        mujoco.mjv_initGeom(
            scene.geoms[scene.ngeom],
            mujoco.mjtGeom.mjGEOM_SPHERE,
            np.array([radius, 0.0, 0.0]),
            np.array(centre_of(rig, now.recorded, now.angle)),
            np.eye(3).ravel(),
            np.array([*GHOST_COLOUR, GHOST_OPACITY], dtype=np.float32),
        )
        scene.ngeom += 1

    def aim(self, camera: mujoco.MjvCamera, aspect: float) -> None:
        """Let a free camera see the whole beam, almost from the side.

        Args:
            camera: to be set.
            aspect: width of the picture over its height.
        """
        channel = self.playback.channel
        camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        width = MARGIN * max(channel.length, NARROWEST * channel.ball_radius)
        height = width / aspect
        camera.lookat[:] = channel.centre, 0.0, channel.edge_height + (0.12 * height if aspect > STRIP else 0.0)
        camera.distance = 0.5 * height / math.tan(math.radians(0.5 * FOVY))
        camera.azimuth, camera.elevation = AZIMUTH, ELEVATION
