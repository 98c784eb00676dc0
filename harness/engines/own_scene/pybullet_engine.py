"""PyBullet on the user's own URDF: the beam's joint is set to the recorded angle and its mean rate in every step.

The built-in scene lends its beam the velocity of the chord by two more joints (`harness.engines.chord`), which a user's
URDF does not have: the error falls with the first order of the step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from importlib.metadata import version

import numpy as np
from pydantic import Field, model_validator

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.engines.chord import Pose, Stepper, follow
from harness.engines.leapfrog import Track, spin_angle_of
from harness.engines.own_scene.checks import Check, Status, Use, joint_limits
from harness.engines.own_scene.engine import SceneEngine
from harness.engines.own_scene.frame import tilted
from harness.engines.own_scene.measuring import Measured, measure
from harness.engines.own_scene.pybullet_model import PyBulletModel, loaded
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Task
from harness.engines.pybullet import PyBulletParameters, pybullet
from harness.engines.watch import Samples

_BASE = -1
_PRESSED = (
    1e-7  # depth at which the ball starts [m]: Bullet does not find the contact of a ball that just touches a box
)
_LOAD = 9  # place of the normal force [N] in what PyBullet says of a contact


class PyBulletSceneParameters(EngineParameters):
    """Of a user's scene, under the names of the built-in one; what is not set stays as the file has it.

    What Bullet needs in order not to lose energy or contacts has the values of the built-in scene.
    """

    lateral_friction_ball: float | None = Field(
        None, ge=0.0, le=10.0, description="friction coefficient of the ball [1]"
    )
    lateral_friction_rail: float | None = Field(
        None, ge=0.0, le=10.0, description="friction coefficient of the beam [1]; the pair has the product of both"
    )
    rolling_friction: float | None = Field(None, ge=0.0, le=0.01, description="rolling friction of the ball [m]")
    spinning_friction: float | None = Field(None, ge=0.0, le=0.01, description="spinning friction of the ball [m]")
    restitution: float | None = Field(None, ge=0.0, le=1.0, description="coefficient of restitution of the ball [1]")
    contact_stiffness: float | None = Field(None, gt=0.0, le=1e12, description="stiffness of a contact [N/m]")
    contact_damping: float | None = Field(None, ge=0.0, le=1e9, description="damping of a contact [N s/m]")
    contact_erp: float = Field(0.2, ge=0.0, le=1.0, description="share of a penetration removed in a step [1]")
    contact_slop: float = Field(0.0, ge=0.0, le=1e-3, description="penetration that is left alone [m]")
    contact_breaking_threshold: float = Field(
        0.5, gt=0.0, le=2.0, description="distance at which a contact is dropped, over the ball's radius [1]"
    )
    linear_damping: float = Field(0.0, ge=0.0, le=1.0, description="velocity of the ball lost in a second [1/s]")
    angular_damping: float = Field(0.0, ge=0.0, le=1.0, description="spin of the ball lost in a second [1/s]")
    solver_iterations: int = Field(150, ge=1, le=1000, description="iterations of the contact solver [1]")
    health_interval: float = Field(0.01, ge=0.0, le=0.1, description="time between two looks at the contacts [s]")

    @model_validator(mode="after")
    def _both_or_none(self) -> PyBulletSceneParameters:
        if (self.contact_stiffness is None) != (self.contact_damping is None):
            raise ValueError("contact_stiffness and contact_damping are set together or not at all")
        return self


class PyBulletScene(SceneEngine[PyBulletSceneParameters]):
    """PyBullet on a scene of the user's."""

    name = "pybullet"
    parameters = PyBulletSceneParameters
    built_in = PyBulletParameters

    def version(self) -> str:
        """Version of the installed package."""
        return version("pybullet")

    def measure(self, rig: Rig) -> Measured:
        """What the scene is, by touch; g is that of `rig`, and the ball too unless it has a file."""
        with loaded(self.scene, self.file, rig) as model:
            return measure(model, self.scene.rolls_at)

    def own_checks(self, rig: Rig, use: Use) -> Iterator[Check]:
        """Limits of the joint, and what was changed in order to drive it."""
        with loaded(self.scene, self.file, rig) as model:
            yield Check("gravity", Status.OK, "a URDF has none; that of rig.toml acts, against the world's z axis")
            low, high = sorted(self.scene.direction * (one - self.scene.level_joint_angle) for one in model.limits)
            wide = joint_limits(low, high, use)
            if model.limits[0] < model.limits[1] and wide is not None:
                yield wide
            for text in model.told:
                yield Check("what acts on the joint", Status.WARNING, f"{text}, and does so alone.")

    def drive(self, task: Task[PyBulletSceneParameters]) -> tuple[Track, Samples]:
        """Steps through the grid; stops early if the run is invalid."""
        with loaded(self.scene, self.file, task.rig) as model:
            running = _Running(model, task)
            track, samples = follow(self.name, running, task, task.settings.health_interval)
            samples.extremes["warnings"] = model.told + running.remarks()
        return track, samples


class _Running:
    """The scene while it is stepped; `harness.engines.chord.Scene`."""

    def __init__(self, model: PyBulletModel, task: Task[PyBulletSceneParameters]) -> None:
        self.model, self.client = model, model.client
        model.frame = model.frame.shifted(task.across)
        self.others: set[str] = set()
        self.seen = (0, 0.0)
        _set_up(model, task)
        first = task.first
        model.turn_beam(float(task.grid.angle[0]), first.beam_rate)
        angle = float(task.grid.angle[0])
        up = np.array([math.sin(angle), 0.0, math.cos(angle)])
        model.put_ball(tuple((np.array(first.centre) - _PRESSED * up).tolist()))
        velocity = model.frame.direction_outside(np.array(first.velocity)).tolist()
        spin = (first.spin * model.frame.axes[1]).tolist()
        pybullet.resetBaseVelocity(model.body, velocity, spin, physicsClientId=self.client)

    def pose(self) -> Pose:
        centre, turn = pybullet.getBasePositionAndOrientation(self.model.body, self.client)
        return (*self.model.frame.inside(np.array(centre)).tolist(), *turn)

    def spin_angle(self, orientations: FloatArray) -> FloatArray:
        return spin_angle_of(orientations[:, :3] @ self.model.frame.axes[1], orientations[:, 3])

    def push(self, pose: Pose, x: float, z: float) -> None:
        frame, body = self.model.frame, self.model.body
        force = frame.direction_outside(np.array([x, 0.0, z])).tolist()
        centre, _ = pybullet.getBasePositionAndOrientation(body, self.client)
        pybullet.applyExternalForce(body, _BASE, force, centre, pybullet.WORLD_FRAME, self.client)

    def stepper(self) -> Stepper:
        return self._step

    def _step(self, angle: float, rate: float, x: float, z: float) -> Pose:
        self.model.turn_beam(angle, rate)
        pybullet.stepSimulation(self.client)
        self._look(angle)
        return self.pose()

    def contacts(self, angle: float) -> tuple[int, float]:
        """Most contacts and largest load of the steps since the last look: Bullet misses a large box now and then."""
        seen, self.seen = self.seen, (0, 0.0)
        return seen

    def _look(self, angle: float) -> None:
        """Gather the contacts of the step that began at α = `angle` [rad]."""
        points = pybullet.getContactPoints(self.model.body, physicsClientId=self.client)
        up, count, load = np.array([math.sin(angle), 0.0, math.cos(angle)]), 0, 0.0
        for point in points:
            if point[_LOAD] <= 0.0:
                continue
            touch = self.model.touch(point)
            if touch.beam:
                count, load = count + 1, load + point[_LOAD] * float(np.array(touch.normal) @ up)
            else:
                self.others.add(touch.name)
        self.seen = max(self.seen[0], count), max(self.seen[1], load)

    def beam_angle(self) -> float:
        position = pybullet.getJointState(self.model.beam, self.model.joint, self.client)[0]
        return float(position - self.model.scene.level_joint_angle) * self.model.scene.direction

    def ball_speed(self) -> float:
        return math.hypot(*pybullet.getBaseVelocity(self.model.body, self.client)[0])

    def remarks(self) -> tuple[str, ...]:
        """What the user should know of the run."""
        return (f"the ball also touched {', '.join(sorted(self.others))}",) if self.others else ()


def _set_up(model: PyBulletModel, task: Task[PyBulletSceneParameters]) -> None:
    """Gravity, solver and contacts."""
    settings, frame = task.settings, model.frame
    gravity = frame.direction_outside(tilted(np.array([0.0, 0.0, -task.rig.gravity]), task.rig.level_angle))
    pybullet.setGravity(*gravity.tolist(), physicsClientId=model.client)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=settings.time_step,
        numSubSteps=0,
        numSolverIterations=settings.solver_iterations,
        solverResidualThreshold=0.0,
        contactBreakingThreshold=settings.contact_breaking_threshold,  # global to the process: set for every run
        contactSlop=settings.contact_slop,
        contactERP=settings.contact_erp,
        restitutionVelocityThreshold=0.0,
        deterministicOverlappingPairs=1,
        enableFileCaching=0,
        physicsClientId=model.client,
    )
    # Damping goes separately: a call that names it drops the rest without a word.
    model.change(model.body, _BASE, linearDamping=settings.linear_damping, angularDamping=settings.angular_damping)
    ball = {
        "lateralFriction": settings.lateral_friction_ball,
        "rollingFriction": settings.rolling_friction,
        "spinningFriction": settings.spinning_friction,
        "restitution": settings.restitution,
        "contactStiffness": settings.contact_stiffness,
        "contactDamping": settings.contact_damping,
    }
    given = {name: value for name, value in ball.items() if value is not None}
    if given:
        model.change(model.body, _BASE, **given)
    if settings.lateral_friction_rail is not None:
        for link in model.links:
            model.change(model.beam, link, lateralFriction=settings.lateral_friction_rail)
