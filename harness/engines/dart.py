"""DART (extra `dart`): the ball on two capsules attached to a hinge with prescribed velocity.

A VELOCITY joint follows its command exactly, independent of the load. The validated accuracy also requires:

* DART keeps a contact only while the shapes overlap; without overlap the ball loses contact and falls by g dt² in a
  step. The sphere is therefore larger by SINK g dt² and overlaps with its centre at the right height; a downward
  surface velocity balances the error reduction, which removes a hundredth of the overlap per step.
* The contact needs the velocity of the chord (`harness.engines.chord`), which a sliding joint adds whose position is
  held.
* Deactivation of resting bodies, on by default, is switched off.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from types import ModuleType
from typing import Any

import numpy as np
from pydantic import Field

from analytic.geometry import RAIL_REACH, rails_of, to_world
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.engines.chord import Pose, Stepper, follow
from harness.engines.leapfrog import Start, Track, spin_angle_of
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine, Task
from harness.engines.watch import Samples
from harness.errors import InputError
from urdf.scene import rail_axis

ERROR_REDUCTION = 0.01  # share of an overlap removed per step, fixed in DART
SINK = 0.03  # overlap in g dt²; the residual of the chord velocities is below a third of it, so contact is kept


class DartParameters(EngineParameters):
    """Settings of DART."""

    friction: float = Field(0.5, ge=0.0, le=10.0, description="friction coefficient of ball and rails [1]")
    restitution: float = Field(0.0, ge=0.0, le=1.0, description="restitution coefficient of ball and rails [1]")
    tube_radius: float = Field(0.001, gt=0.0, le=0.02, description="radius of the capsules along the edges [m]")
    health_interval: float = Field(0.01, ge=0.0, le=0.1, description="time between two samples of the contacts [s]")


class Dart(Engine[DartParameters]):
    """The rig in DART."""

    name = "dart"
    parameters = DartParameters

    def version(self) -> str:
        """Version of the installed package."""
        _dartpy()
        return version("dartpy")

    def drive(self, task: Task[DartParameters]) -> tuple[Track, Samples]:
        """Steps through the grid; stops early if the run is invalid."""
        scene = _Scene.build(_dartpy(), task.rig, task.settings)
        scene.place(task.first)
        down = ERROR_REDUCTION * _sink(task.rig, task.settings.time_step) / task.settings.time_step
        return follow(self.name, scene, task, task.settings.health_interval, down)


def _dartpy() -> ModuleType:
    try:
        import dartpy
    except ImportError as error:
        raise InputError(
            f"the engine dart needs the package dartpy, which is not installed or does not load ({error}); install it "
            "with pip install '.[dart]' in the harness's own folder, and the system library if one is named here"
        ) from error
    module: ModuleType = dartpy
    return module


@dataclass(frozen=True)
class _Scene:
    """The dartpy objects: world, the beam's two joints, the ball and its joint."""

    world: Any
    chord: Any
    pivot: Any
    ball: Any
    free: Any

    @classmethod
    def build(cls, dart: ModuleType, rig: Rig, settings: DartParameters) -> _Scene:
        world = dart.simulation.World("ball_beam")
        world.setTimeStep(settings.time_step)
        world.setGravity(np.array(to_world(0.0, 0.0, -rig.gravity, -rig.level_angle)))
        awake = world.getDeactivationOptions()
        awake.mEnabled = False
        world.setDeactivationOptions(awake)
        world.getConstraintSolver().setCollisionDetector(dart.collision.BulletCollisionDetector())

        beam = dart.dynamics.Skeleton("beam")
        chord, carriage = beam.createTranslationalJointAndBodyNodePair(None)
        pivot, body = beam.createRevoluteJointAndBodyNodePair(carriage)
        pivot.setAxis([0.0, 1.0, 0.0])
        for joint in (chord, pivot):
            joint.setActuatorType(dart.dynamics.ActuatorType.VELOCITY)
        channel = rails_of(rig)
        if channel.flat:
            plate = np.eye(4)
            plate[2, 3] = channel.floor_top - 0.5 * channel.floor_thickness
            size = [channel.length, 2 * channel.half_width, channel.floor_thickness]
            _solid(body, dart.dynamics.BoxShape(size), settings, channel.grip).setRelativeTransform(plate)
        across, height = rail_axis(rig, settings.tube_radius)
        for y in () if channel.flat else (across, -across):
            rail = dart.dynamics.CapsuleShape(settings.tube_radius, 2 * RAIL_REACH)
            along_x = np.array(
                [[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, y], [-1.0, 0.0, 0.0, height], [0.0, 0.0, 0.0, 1.0]]
            )
            _solid(body, rail, settings).setRelativeTransform(along_x)
        world.addSkeleton(beam)

        skeleton = dart.dynamics.Skeleton("ball")
        free, ball = skeleton.createFreeJointAndBodyNodePair(None)
        inertia = dart.dynamics.Inertia()
        inertia.setMass(rig.mass)
        inertia.setMoment(rig.inertia * np.eye(3))
        ball.setInertia(inertia)
        overlap = _sink(rig, settings.time_step) * rig.rolling_radius / channel.ball_radius  # along the contact normal
        _solid(ball, dart.dynamics.SphereShape(channel.ball_radius + overlap), settings, channel.grip)
        world.addSkeleton(skeleton)
        return cls(world, chord, pivot, ball, free)

    def place(self, first: Start) -> None:
        """Sets the initial state of the ball."""
        pose = np.eye(4)
        pose[:3, 3] = first.centre
        self.free.setTransform(pose)
        self.free.setLinearVelocity(np.array(first.velocity))
        self.free.setAngularVelocity(np.array([0.0, first.spin, 0.0]))

    def pose(self) -> Pose:
        rotation_and_centre = self.free.getPositions().tolist()
        return (*rotation_and_centre[3:], *rotation_and_centre[:3])

    def spin_angle(self, orientations: FloatArray) -> FloatArray:
        half = 0.5 * np.linalg.norm(orientations, axis=1)
        sine = 0.5 * orientations[:, 1] * np.sinc(half / np.pi)  # y part of the quaternion
        return spin_angle_of(sine, np.cos(half))

    def push(self, pose: Pose, x: float, z: float) -> None:
        self.ball.addExtForce(np.array([x, 0.0, z]))

    def stepper(self) -> Stepper:
        return self._step

    def _step(self, angle: float, rate: float, x: float, z: float) -> Pose:
        self.pivot.setPosition(0, angle)
        self.pivot.setCommand(0, rate)
        self.chord.setPositions(np.zeros(3))
        self.chord.setCommands([x, 0.0, z])
        self.world.step(True)
        return self.pose()

    def contacts(self, angle: float) -> tuple[int, float]:
        up = np.array(to_world(0.0, 0.0, 1.0, angle))
        found = self.world.getLastCollisionResult().getContacts()
        loads = [(float(contact.force @ contact.normal), abs(float(contact.normal @ up))) for contact in found]
        return sum(load > 0.0 for load, _ in loads), sum(load * lean for load, lean in loads)

    def beam_angle(self) -> float:
        return float(self.pivot.getPosition(0))

    def ball_speed(self) -> float:
        return float(np.linalg.norm(self.ball.getLinearVelocity()))


def _sink(rig: Rig, time_step: float) -> float:
    """Overlap of ball and rails [m]."""
    return SINK * rig.gravity * time_step**2


def _solid(body: Any, shape: Any, settings: DartParameters, grip: float = 1.0) -> Any:
    """Attaches a collision shape to `body`."""
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    surface = node.createDynamicsAspect()
    surface.setFrictionCoeff(settings.friction * grip)
    surface.setRestitutionCoeff(settings.restitution)
    return node
