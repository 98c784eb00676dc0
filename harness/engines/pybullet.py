"""PyBullet: the ball on the rails of a hinge that is set to the recorded angle every step.

What has to be right for the validated accuracy, each with a test in `tests/engines/test_pybullet.py`: no damping on any
body (0.04 a second by default), a hinge with the mean rate of the step as its surface velocity, ball velocities that
start half a step early, the velocity of the chord (see `chord`), a speed limit that is lifted (100 rad/s by default),
and a contact breaking threshold that is set for every run, because Bullet keeps it for the whole process, and set
higher.
"""

from __future__ import annotations

import contextlib
import math
import tempfile
import weakref
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path

from pydantic import Field, model_validator

from analytic.geometry import channel_of, rails_of, to_world
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.engines.chord import Pose, Stepper, follow
from harness.engines.leapfrog import Start, Track, spin_angle_of
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine, Task
from harness.engines.stderr import without_lines
from harness.engines.watch import Samples
from harness.errors import HarnessError
from urdf.scene import CHORD_X, CHORD_Z, PIVOT, ball_urdf, beam_urdf, iterations_for

with without_lines(b"pybullet build time"):  # a greeting, written from C at the first import
    import pybullet as pybullet

NO_SPEED_LIMIT = 1e6  # [rad/s, m/s]
FEWEST_ITERATIONS = 15  # leave nothing on the paper's rig


class PyBulletParameters(EngineParameters):
    """Settings of PyBullet under its own names. Coefficients of ball and rail are multiplied by the engine."""

    lateral_friction_ball: float = Field(1.0, ge=0.0, le=10.0, description="friction coefficient of the ball [1]")
    lateral_friction_rail: float = Field(
        0.5, ge=0.0, le=10.0, description="friction coefficient of the rails [1]; the pair has the product of both"
    )
    rolling_friction: float = Field(
        0.0, ge=0.0, le=0.01, description="rolling friction of the ball, a length [m]; brakes about 4 % too much"
    )
    spinning_friction: float = Field(
        0.0, ge=0.0, le=0.01, description="spinning friction of the ball, a length [m]; in a groove it brakes rolling"
    )
    restitution: float = Field(0.0, ge=0.0, le=1.0, description="coefficient of restitution of the pair [1]")
    restitution_velocity_threshold: float = Field(
        0.0, ge=0.0, le=10.0, description="approach velocity below which nothing rebounds [m/s]"
    )
    contact_stiffness: float | None = Field(
        None,
        gt=0.0,
        le=1e12,
        description="stiffness of a contact [N/m]; none: a rigid contact corrected by contact_erp",
    )
    contact_damping: float | None = Field(
        None, ge=0.0, le=1e9, description="damping of a contact [N s/m]; goes with contact_stiffness"
    )
    contact_erp: float = Field(0.2, ge=0.0, le=1.0, description="share of a penetration removed in a step [1]")
    friction_erp: float = Field(0.2, ge=0.0, le=1.0, description="the same of a friction anchor [1]")
    erp: float = Field(0.2, ge=0.0, le=1.0, description="the same of a joint [1]")
    global_cfm: float = Field(0.0, ge=0.0, le=1.0, description="softness mixed into every constraint [1]")
    contact_slop: float = Field(0.0, ge=0.0, le=1e-3, description="penetration that is left alone [m]")
    contact_breaking_threshold: float = Field(
        0.5,
        gt=0.0,
        le=2.0,
        description="distance at which a contact point is dropped, or not yet a new one, over the ball's radius [1]; "
        "Bullet's own 0.02 keeps stale points when the ball rolls some millimetres a step",
    )
    linear_damping: float = Field(
        0.0, ge=0.0, le=1.0, description="velocity lost in a second [1/s]; Bullet's own: 0.04"
    )
    angular_damping: float = Field(0.0, ge=0.0, le=1.0, description="spin lost in a second [1/s]; Bullet's own: 0.04")
    solver_iterations: int | None = Field(
        None, ge=1, le=1000, description="iterations of the contact solver [1]; none: as many as the groove needs"
    )
    solver_residual_threshold: float = Field(
        0.0, ge=0.0, le=1.0, description="squared residual at which the solver stops early [1]"
    )
    health_interval: float = Field(0.01, ge=0.0, le=0.1, description="time between two looks at the contacts [s]")

    @model_validator(mode="after")
    def _both_or_none(self) -> PyBulletParameters:
        if (self.contact_stiffness is None) != (self.contact_damping is None):
            raise ValueError("contact_stiffness and contact_damping are set together or not at all")
        return self


class PyBullet(Engine[PyBulletParameters]):
    """The rig in PyBullet."""

    name = "pybullet"
    parameters = PyBulletParameters

    def __init__(self) -> None:
        self._idle: list[int] = []  # physics servers that are connected and empty

    def version(self) -> str:
        """Version of the installed package."""
        return version("pybullet")

    def drive(self, task: Task[PyBulletParameters]) -> tuple[Track, Samples]:
        """Steps through the grid; stops early if the run is invalid."""
        with self._client() as client:
            scene = _load(task.rig, task.settings, client)
            scene.place(task.first)
            return follow(self.name, scene, task, task.settings.health_interval)

    @contextlib.contextmanager
    def _client(self) -> Iterator[int]:
        """An empty physics server. It is kept for the next run, as connecting takes as long as 700 steps, and goes with
        the engine."""
        if self._idle:
            client = self._idle.pop()
        else:
            client = pybullet.connect(pybullet.DIRECT)
            if client < 0:
                raise HarnessError("PyBullet opened no further physics server; end other simulations in this process")
            weakref.finalize(self, pybullet.disconnect, client)
        try:
            yield client
        finally:
            pybullet.resetSimulation(physicsClientId=client)
            self._idle.append(client)


@dataclass(frozen=True)
class _Scene:
    """What is loaded: the physics server, the ids of bodies and joints (pivot, sliding along x and z).

    The beam is so heavy that only gravity moves the sliding joints within a step; that velocity, `sag` along x and z
    [m/s], is taken off beforehand.
    """

    client: int
    beam: int
    ball: int
    joints: tuple[int, int, int]
    sag: tuple[float, float]

    def place(self, first: Start) -> None:
        """Put the ball where it starts."""
        pybullet.resetBasePositionAndOrientation(self.ball, first.centre, (0.0, 0.0, 0.0, 1.0), self.client)
        pybullet.resetBaseVelocity(self.ball, first.velocity, (0.0, first.spin, 0.0), physicsClientId=self.client)

    def pose(self) -> Pose:
        centre, turn = pybullet.getBasePositionAndOrientation(self.ball, self.client)
        return tuple(centre + turn)

    def spin_angle(self, orientations: FloatArray) -> FloatArray:
        return spin_angle_of(orientations[:, 1], orientations[:, 3])

    def push(self, pose: Pose, x: float, z: float) -> None:
        pybullet.applyExternalForce(self.ball, -1, (x, 0.0, z), pose[:3], pybullet.WORLD_FRAME, self.client)

    def stepper(self) -> Stepper:
        # What does not change in a run is looked up once: a tenth of a step's time.
        set_joints, simulate = pybullet.resetJointStatesMultiDof, pybullet.stepSimulation
        where, client, ball, beam, joints = (
            pybullet.getBasePositionAndOrientation,
            self.client,
            self.ball,
            self.beam,
            self.joints,
        )
        sag_x, sag_z = self.sag
        turned, turning, along_x, along_z = [0.0], [0.0], [0.0], [0.0]
        values, rates = [turned, [0.0], [0.0]], [turning, along_x, along_z]  # Bullet reads lists; tuples crash it

        def step(angle: float, rate: float, x: float, z: float) -> Pose:
            turned[0], turning[0], along_x[0], along_z[0] = angle, rate, x - sag_x, z - sag_z
            set_joints(beam, joints, values, rates, client)
            simulate(client)
            centre, turn = where(ball, client)
            return centre + turn

        return step

    def contacts(self, angle: float) -> tuple[int, float]:
        # In one pass: with lists and sums of its own, looking at the contacts took a fiftieth of a run.
        up_x, up_z = math.sin(angle), math.cos(angle)
        count, total = 0, 0.0
        for point in pybullet.getContactPoints(self.ball, self.beam, physicsClientId=self.client):
            load = point[9]
            if load > 0.0:
                normal = point[7]
                count += 1
                total += load * (normal[0] * up_x + normal[2] * up_z)
        return count, total

    def beam_angle(self) -> float:
        return float(pybullet.getJointState(self.beam, self.joints[0], self.client)[0])

    def ball_speed(self) -> float:
        return math.hypot(*pybullet.getBaseVelocity(self.ball, self.client)[0])


def _load(rig: Rig, settings: PyBulletParameters, client: int) -> _Scene:
    """Load beam and ball with every setting made explicit."""
    tilt = rig.level_angle
    pybullet.setGravity(rig.gravity * math.sin(tilt), 0.0, -rig.gravity * math.cos(tilt), physicsClientId=client)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=settings.time_step,
        numSubSteps=0,
        numSolverIterations=settings.solver_iterations or iterations_for(rig, FEWEST_ITERATIONS),
        solverResidualThreshold=settings.solver_residual_threshold,
        contactBreakingThreshold=settings.contact_breaking_threshold,
        contactSlop=settings.contact_slop,
        contactERP=settings.contact_erp,
        frictionERP=settings.friction_erp,
        erp=settings.erp,
        globalCFM=settings.global_cfm,
        restitutionVelocityThreshold=settings.restitution_velocity_threshold,
        deterministicOverlappingPairs=1,
        enableFileCaching=0,  # a later rig must not meet an earlier one's file
        physicsClientId=client,
    )
    with tempfile.TemporaryDirectory() as folder:
        beam_file, ball_file = Path(folder, "beam.urdf"), Path(folder, "ball.urdf")
        beam_file.write_text(beam_urdf(rig, rails_of(rig), driven=True), encoding="utf-8")
        ball_file.write_text(ball_urdf(rig), encoding="utf-8")
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        beam = pybullet.loadURDF(str(beam_file), useFixedBase=True, flags=flags, physicsClientId=client)
        ball = pybullet.loadURDF(str(ball_file), flags=flags, physicsClientId=client)
    joints = {
        pybullet.getJointInfo(beam, joint, physicsClientId=client)[1].decode(): joint
        for joint in range(pybullet.getNumJoints(beam, physicsClientId=client))
    }
    # A call on a link that names a damping or a speed limit drops everything else in it without a word, so what belongs
    # to a whole body (set through its base) and what belongs to a surface (set on its link) go separately.
    change = partial(pybullet.changeDynamics, physicsClientId=client)
    for body, linear, angular in ((ball, settings.linear_damping, settings.angular_damping), (beam, 0.0, 0.0)):
        change(body, -1, linearDamping=linear, angularDamping=angular, maxJointVelocity=NO_SPEED_LIMIT)
    change(beam, joints[PIVOT], lateralFriction=settings.lateral_friction_rail * channel_of(rig).grip, restitution=1.0)
    change(ball, -1, lateralFriction=settings.lateral_friction_ball, restitution=settings.restitution)
    change(ball, -1, rollingFriction=settings.rolling_friction, spinningFriction=settings.spinning_friction)
    if settings.contact_stiffness is not None:
        change(ball, -1, contactStiffness=settings.contact_stiffness, contactDamping=settings.contact_damping)
    for joint in joints.values():  # the motors that loadURDF leaves on
        pybullet.setJointMotorControl2(beam, joint, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
    sag_x, _, sag_z = to_world(0.0, 0.0, -rig.gravity * settings.time_step, -rig.level_angle)
    return _Scene(client, beam, ball, (joints[PIVOT], joints[CHORD_X], joints[CHORD_Z]), (sag_x, sag_z))
