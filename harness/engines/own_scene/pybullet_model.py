"""A user's URDF in PyBullet, in which the ball can be put anywhere."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from analytic.naming import did_you_mean
from analytic.rig import Rig
from harness.engines.leapfrog import Vector
from harness.engines.own_scene.frame import Frame, frame_of
from harness.engines.own_scene.measuring import BallFacts, Touch
from harness.engines.pybullet import NO_SPEED_LIMIT, pybullet
from harness.engines.stderr import without_output
from harness.errors import HarnessError, InputError
from harness.scene import Scene
from urdf.scene import ball_urdf

BEAM_INERTIA = 1e6  # mass [kg] and inertia [kg m²] that the driven beam is given, so that the ball does not turn it
_WORLD_BASE = -1
_ROUND = 0.01  # by which a ball's moments of inertia may differ
_CENTRED = 1e-6  # by which the centre of mass may lie off the middle [m]


@contextlib.contextmanager
def loaded(scene: Scene, file: Path, rig: Rig) -> Iterator[PyBulletModel]:
    """A physics server with the scene in it, for as long as the context lasts.

    Raises:
        InputError: PyBullet cannot load a file, or it is no ball and hinged beam.
    """
    client = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise HarnessError("PyBullet opened no further physics server; end other simulations in this process")
    try:
        yield PyBulletModel(client, scene, file, rig)
    finally:
        pybullet.disconnect(client)


class PyBulletModel:
    """A loaded scene.

    Attributes:
        place: file, for messages.
        client, beam, joint, body: server; ids of the beam's body, of its joint and of the ball.
        frame: of the harness in the scene's world.
        ball: as its file has it.
        gravity: g of the rig [m/s²]; a URDF has none.
        told: what was changed in order to drive the scene, in words.
    """

    def __init__(self, client: int, scene: Scene, file: Path, rig: Rig) -> None:
        """Load and check; exceptions as of `loaded`."""
        self.client, self.scene, self.place, self.gravity = client, scene, str(file), rig.gravity
        self.change = partial(pybullet.changeDynamics, physicsClientId=client)
        self.beam = self._load(file, fixed=True)
        self.joint = self._joint(file)
        self.links = self._under(self.joint)
        self.told = self._release()
        self.turn_beam(0.0)
        _, _, _, _, position, turn = pybullet.getLinkState(
            self.beam, self.joint, computeForwardKinematics=1, physicsClientId=client
        )[:6]
        axis = np.array(pybullet.getMatrixFromQuaternion(turn)).reshape(3, 3) @ self._info(self.joint)[13]
        place = f"{file}: joint '{scene.beam_joint}'"
        self.frame: Frame = frame_of(place, np.array(position), axis, np.array([0.0, 0.0, 1.0]), scene.direction)
        self.body = self._load_ball(rig)
        self.ball = self._ball_facts(rig)

    def beam_position(self, angle: float) -> float:
        """Of the beam's joint at α [rad]."""
        return self.scene.level_joint_angle + self.scene.direction * angle

    def turn_beam(self, angle: float, rate: float = 0.0) -> None:
        """Set the beam's joint to α [rad] and α̇ [rad/s]."""
        turn = self.scene.direction * rate
        pybullet.resetJointState(self.beam, self.joint, self.beam_position(angle), turn, physicsClientId=self.client)

    def put_ball(self, centre: Vector) -> None:
        """Put the ball's centre there, in the harness's frame [m], with no rotation."""
        place = self.frame.outside(np.array(centre)).tolist()
        pybullet.resetBasePositionAndOrientation(self.body, place, (0.0, 0.0, 0.0, 1.0), self.client)

    def touches(self, centre: Vector) -> list[Touch]:
        """What the ball touches or penetrates with its centre there, in the harness's frame [m]."""
        self.put_ball(centre)
        points = pybullet.getClosestPoints(self.body, self.beam, 0.0, physicsClientId=self.client)
        return [self.touch(point) for point in points if point[8] <= 0.0]

    def touch(self, point: tuple[Any, ...]) -> Touch:
        """A contact of PyBullet's between the ball, first, and the beam."""
        normal = self.frame.direction_inside(np.array(point[7]))
        link = int(point[4])
        name = self._info(link)[12].decode() if link >= 0 else pybullet.getBodyInfo(self.beam, self.client)[0].decode()
        return Touch(tuple(normal.tolist()), link in self.links, name)

    def _load(self, file: Path, *, fixed: bool) -> int:
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        said: list[str] = []
        try:
            with without_output() as said:
                return int(pybullet.loadURDF(str(file), useFixedBase=fixed, flags=flags, physicsClientId=self.client))
        except pybullet.error as error:
            told = " ".join("".join(said).split())
            raise InputError(f"{file}: PyBullet cannot load it: {error} {told} Correct the file.") from None

    def _info(self, joint: int) -> tuple[Any, ...]:
        return tuple(pybullet.getJointInfo(self.beam, joint, physicsClientId=self.client))

    @property
    def _joints(self) -> range:
        return range(pybullet.getNumJoints(self.beam, physicsClientId=self.client))

    def _joint(self, file: Path) -> int:
        names = {self._info(joint)[1].decode(): joint for joint in self._joints}
        name = self.scene.beam_joint
        if name not in names:
            raise InputError(
                f"{file}: there is no joint '{name}'.{did_you_mean(name, names)} There is "
                f"{', '.join(names) or 'none'}. Name one in [scene], beam_joint."
            )
        joint = names[name]
        if self._info(joint)[2] != pybullet.JOINT_REVOLUTE:
            raise InputError(
                f'{file}: joint \'{name}\' is no hinge. Name the hinge, or write type="revolute" or "continuous".'
            )
        parent = self._info(joint)[16]
        while parent >= 0:
            if self._info(parent)[2] != pybullet.JOINT_FIXED:
                moving = self._info(parent)[1].decode()
                raise InputError(f"{file}: joint '{moving}', which bears the beam, can move. Make it fixed.")
            parent = self._info(parent)[16]
        return joint

    def _under(self, joint: int) -> frozenset[int]:
        """Links that move with the beam."""
        under = {joint}
        for other in self._joints:  # parents come before their children
            if self._info(other)[16] in under:
                under.add(other)
        return frozenset(under)

    def _release(self) -> tuple[str, ...]:
        """Let nothing but the drive act on the beam's joint."""
        for joint in self._joints:  # the motors that loadURDF leaves on
            if self._info(joint)[2] != pybullet.JOINT_FIXED:
                pybullet.setJointMotorControl2(
                    self.beam, joint, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=self.client
                )
        self.change(self.beam, self.joint, mass=BEAM_INERTIA, localInertiaDiagonal=[BEAM_INERTIA] * 3)
        info = self._info(self.joint)
        self.limits = float(info[8]), float(info[9])  # of the joint as the file has them [rad]
        damped = info[6] != 0.0 or info[7] != 0.0
        self.change(self.beam, self.joint, jointDamping=0.0)
        self.change(self.beam, self.joint, jointLowerLimit=-1e3, jointUpperLimit=1e3)
        self.change(self.beam, _WORLD_BASE, linearDamping=0.0, angularDamping=0.0, maxJointVelocity=NO_SPEED_LIMIT)
        return (
            (f"damping and friction of joint '{self.scene.beam_joint}' are switched off: the recorded angle drives",)
            if damped
            else ()
        )

    def _load_ball(self, rig: Rig) -> int:
        if self.scene.ball_urdf is not None:
            return self._load(self.scene.ball_urdf, fixed=False)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "ball.urdf")
            # A rig that rolls on edges has a contact sphere of radius R, whatever its track is here.
            file.write_text(ball_urdf(rig.with_(rolling_radius=0.5 * rig.radius)), encoding="utf-8")
            return self._load(file, fixed=False)

    def _ball_facts(self, rig: Rig) -> BallFacts:
        file = self.scene.ball_urdf or "ball"
        self.change(self.body, _WORLD_BASE, linearDamping=0.0, angularDamping=0.0, maxJointVelocity=NO_SPEED_LIMIT)
        shapes = pybullet.getCollisionShapeData(self.body, _WORLD_BASE, physicsClientId=self.client)
        moving = pybullet.getNumJoints(self.body, physicsClientId=self.client)
        if moving or len(shapes) != 1 or shapes[0][2] != pybullet.GEOM_SPHERE:
            raise InputError(f"{file}: is no ball. Give it one link with one <sphere> to collide.")
        mass, _, moments, offset = pybullet.getDynamicsInfo(self.body, _WORLD_BASE, physicsClientId=self.client)[:4]
        inertia: FloatArray = np.array(moments)
        if (
            mass <= 0.0
            or inertia.min() <= 0.0
            or np.ptp(inertia) > _ROUND * inertia.mean()
            or np.any(np.abs(offset) > 1e-6)
        ):
            raise InputError(
                f"{file}: a ball has a mass, three equal moments of inertia, and its centre of mass in its middle. "
                "Correct <inertial>."
            )
        return BallFacts(float(mass), float(inertia.mean()), float(shapes[0][3][0]), (0.0, 0.0, 0.0))
