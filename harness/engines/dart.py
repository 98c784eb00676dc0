"""DART as a third opinion (extra `dart`): the ball between two capsules of a hinge whose velocity is prescribed.

A VELOCITY joint follows its command exactly, whatever the ball does. Three things have to be right besides:

* DART holds a contact only while the shapes overlap: a ball that just touches misses steps and falls by g dt² in each.
  The sphere is drawn a trifle too large, by SINK g dt², so that it overlaps where its centre is at the right height; a
  downward surface velocity balances the error reduction, which takes away a hundredth of the overlap a step.
* A joint lends the contact its tangential velocity, but in a step the beam moves along a chord. A sliding joint that
  stays in place adds the difference: −½ s α̇² dt along the beam, −(α̇ ṡ + ½ (h + r) α̇²) dt across. See `pybullet.py`.
* Bodies fall asleep by default.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.metadata import version
from types import ModuleType
from typing import Any

import numpy as np
from pydantic import Field

from analytic.geometry import RAIL_REACH, to_world
from analytic.motion import BallForce, BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.engines.leapfrog import Grid, Start, Track, grid_of, sample, spin_angle_of, start_of, track_of
from harness.engines.protocol import EngineParameters, EngineRun
from harness.engines.watch import STANDSTILL, Limits, Samples, finite_force, judge, limits_of
from harness.errors import InputError
from urdf.scene import rail_axis

ERROR_REDUCTION = 0.01  # share of an overlap removed in a step, fixed in DART
SINK = 0.03  # of g dt²; what the chord velocities leave over is below a third of it, so the contact never opens


class DartParameters(EngineParameters):
    """Settings of DART."""

    friction: float = Field(0.5, ge=0.0, le=10.0, description="friction coefficient of ball and rails [1]")
    restitution: float = Field(0.0, ge=0.0, le=1.0, description="restitution coefficient of ball and rails [1]")
    tube_radius: float = Field(0.001, gt=0.0, le=0.02, description="radius of the capsules along the edges [m]")
    slip_limit: float = Field(
        0.01, gt=0.0, le=100.0, description="slip velocity beyond which a run counts as sliding [m/s]"
    )
    health_interval: float = Field(0.01, ge=0.0, le=0.1, description="time between two looks at the contacts [s]")


class Dart:
    """The rig in DART; see `harness.engines.protocol.Engine`."""

    name: str = "dart"
    parameters: type[EngineParameters] = DartParameters

    def version(self) -> str:
        """Version of the installed package.

        Raises:
            InputError: dartpy is not installed.
        """
        _dartpy()
        return version("dartpy")

    def run(
        self,
        rig: Rig,
        motion: BeamMotion,
        start: State,
        time: FloatArray,
        *,
        parameters: EngineParameters | None = None,
        force: BallForce | None = None,
    ) -> EngineRun:
        """Drive the beam and follow the ball; arguments as in `Engine.run`.

        Raises:
            EngineFailure: the run cannot be trusted.
            InputError: dartpy is not installed, or stamps, motion, settings or groove cannot be worked with.
        """
        settings = parameters if parameters is not None else DartParameters()
        if not isinstance(settings, DartParameters):
            raise InputError(f"dart needs DartParameters, not {type(settings).__name__}")
        scene = _Scene.build(_dartpy(), rig, settings)
        limits = limits_of(rig, reach=RAIL_REACH, slip=settings.slip_limit)
        grid = grid_of(motion, time, settings.time_step)
        first = start_of(rig, motion, grid, start, force)
        scene.place(first)
        track, samples = _drive(scene, rig, grid, first, force, limits, settings.health_interval)
        health = judge(self.name, rig, grid, track, samples, limits)
        trajectory, rolled = sample(self.name, rig, grid, track, start, time)
        return EngineRun(trajectory, rolled, health)


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
    """What is built: world, the beam's two joints, the ball and its joint (dartpy objects)."""

    world: Any
    chord: Any
    pivot: Any
    ball: Any
    free: Any

    @classmethod
    def build(cls, dart: ModuleType, rig: Rig, settings: DartParameters) -> _Scene:
        """Beam and ball in a world of their own."""
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
        across, height = rail_axis(rig, settings.tube_radius)
        for y in (across, -across):
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
        overlap = _sink(rig, settings.time_step) * rig.rolling_radius / rig.radius  # along the contact normal
        _solid(ball, dart.dynamics.SphereShape(rig.radius + overlap), settings)
        world.addSkeleton(skeleton)
        return cls(world, chord, pivot, ball, free)

    def place(self, first: Start) -> None:
        """Put the ball where it starts."""
        pose = np.eye(4)
        pose[:3, 3] = first.centre
        self.free.setTransform(pose)
        self.free.setLinearVelocity(np.array(first.velocity))
        self.free.setAngularVelocity(np.array([0.0, first.spin, 0.0]))

    def contacts(self, angle: float) -> tuple[int, float]:
        """Contacts that carry a force, and the sum of their normal forces across the edge plane at α [rad]."""
        up = np.array(to_world(0.0, 0.0, 1.0, angle))
        found = self.world.getLastCollisionResult().getContacts()
        loads = [(float(contact.force @ contact.normal), abs(float(contact.normal @ up))) for contact in found]
        return sum(load > 0.0 for load, _ in loads), sum(load * lean for load, lean in loads)


def _sink(rig: Rig, time_step: float) -> float:
    """How far the ball would have to rise to part from the rails [m]."""
    return SINK * rig.gravity * time_step**2


def _solid(body: Any, shape: Any, settings: DartParameters) -> Any:
    """A shape that collides, on `body`."""
    node = body.createShapeNode(shape)
    node.createCollisionAspect()
    surface = node.createDynamicsAspect()
    surface.setFrictionCoeff(settings.friction)
    surface.setRestitutionCoeff(settings.restitution)
    return node


def _drive(
    scene: _Scene, rig: Rig, grid: Grid, first: Start, force: BallForce | None, limits: Limits, health_interval: float
) -> tuple[Track, Samples]:
    """Step through the grid; stops early where `judge` will raise."""
    dt, height = grid.time_step, rig.eccentricity + rig.rolling_radius
    world, chord, pivot, ball, free = scene.world, scene.chord, scene.pivot, scene.ball, scene.free
    angles, rates, times = grid.angle.tolist(), grid.rate.tolist(), grid.time.tolist()
    cosines, sines = np.cos(grid.angle).tolist(), np.sin(grid.angle).tolist()
    down = ERROR_REDUCTION * _sink(rig, dt) / dt
    at_rest = np.zeros(3)
    every = max(1, round(health_interval / dt))
    state = free.getPositions()  # rotation vector, then position
    states, samples = [state], Samples()
    s, speed = state[3] * cosines[0] - state[5] * sines[0], first.velocity_along
    speed_before = speed - dt * first.acceleration_along
    for n in range(grid.steps):
        cos, sin, rate, now = cosines[n], sines[n], rates[n], 1.5 * speed - 0.5 * speed_before  # ṡ carried on to t_n
        along = -0.5 * s * rate * rate * dt
        normal = -(rate * now + 0.5 * height * rate * rate) * dt - down
        pivot.setPosition(0, angles[n])
        pivot.setCommand(0, rate)
        chord.setPositions(at_rest)
        chord.setCommands([along * cos + normal * sin, 0.0, normal * cos - along * sin])
        if force is not None:
            push = finite_force("dart", force, s, now, angles[n], times[n])
            ball.addExtForce(np.array([push * cos, 0.0, -push * sin]))
        world.step(True)
        before, state = state, free.getPositions()
        states.append(state)
        moved = state[3] * cosines[n + 1] - state[5] * sines[n + 1]
        speed_before, speed, s = speed, (moved - s) / dt, moved
        if n % every == 0:
            count, load = scene.contacts(angles[n])
            samples.add(n, count, load, abs(pivot.getPosition(0) - angles[n + 1]))
            turned = abs(angles[n + 1] - angles[n])
            if np.array_equal(state, before) and (turned > STANDSTILL or ball.getLinearVelocity().any()):
                samples.frozen = n
            off = state[5] * cosines[n + 1] + state[3] * sines[n + 1] - height
            if samples.frozen is not None or limits.broken(s, state[4], off):
                break
    path = np.array(states)
    half = 0.5 * np.linalg.norm(path[:, :3], axis=1)
    sine = 0.5 * path[:, 1] * np.sinc(half / np.pi)  # y part of the quaternion
    return track_of(rig, grid, path[:, 3:], spin_angle_of(sine, np.cos(half))), samples
