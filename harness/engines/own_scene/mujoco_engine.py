"""MuJoCo on the user's own MJCF.

The driven joint has its angle and its rate of half a step before set anew in every step, and a motor gives it the
acceleration of the recorded angle; so the contact meets a surface that moves as the beam does, in the joint that was
built, whatever else hangs on it. Contacts are those of the scene. The ball starts as deep in them as they let it sink.
"""

from __future__ import annotations

from collections.abc import Iterator

import mujoco
import numpy as np
from scipy.optimize import brentq

from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.engines.chord import Pose, Stepper, follow
from harness.engines.health import Failure
from harness.engines.leapfrog import Grid, Track, spin_angle_of
from harness.engines.mujoco import _quiet as quiet
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.engines.own_scene.checks import Check, Status, Use
from harness.engines.own_scene.engine import SceneEngine
from harness.engines.own_scene.frame import tilted
from harness.engines.own_scene.linkage import Linkage, linkage_of
from harness.engines.own_scene.measuring import Measured, measure
from harness.engines.own_scene.mujoco_checks import checks_of
from harness.engines.own_scene.mujoco_model import ARMATURE, MuJoCoModel
from harness.engines.own_scene.mujoco_parameters import MuJoCoSceneParameters
from harness.engines.protocol import Task
from harness.engines.watch import Samples
from harness.errors import EngineFailure

_SMALL_TURN = 0.1  # of the beam, to either side, where no recording says how far it turns [rad]
_HEALTH_INTERVAL = 0.01  # time over which contacts are gathered to one sample [s]
_LARGEST_SAG = 1e-5  # of the beam behind the recorded angle before it is told [rad]: 0.3 mm in a free run of 3 s


class MuJoCoScene(SceneEngine[MuJoCoSceneParameters]):
    """MuJoCo on a scene of the user's."""

    name = "mujoco"
    parameters = MuJoCoSceneParameters
    built_in = MuJoCoParameters

    def version(self) -> str:
        """Version of the installed package."""
        return str(mujoco.__version__)

    def load(self) -> MuJoCoModel:
        """The scene in MuJoCo.

        Raises:
            InputError: MuJoCo cannot load it, or it is no ball on a hinged beam.
        """
        with quiet():
            return MuJoCoModel(self.scene, self.file)

    def measure(self, rig: Rig) -> Measured:
        """What the scene is, by touch; all of it is in the file."""
        with quiet():
            return measure(self.load(), self.scene.rolls_at)

    def own_checks(self, rig: Rig, use: Use) -> Iterator[Check]:
        """Friction, what brakes, what drives, the start in the file, the linkage, the time step."""
        with quiet():
            loaded = self.load()
            yield from checks_of(loaded, self.measured(rig.with_(level_angle=0.0)), use)
            if loaded.scene.driven_joint is not None and loaded.names.driven_joint != loaded.names.beam_joint:
                low, high = use.angles or (-_SMALL_TURN, _SMALL_TURN)
                linkage = linkage_of(loaded, low, high)
                turn = float(linkage.slope(0.5 * (low + high))[0])
                yield Check(
                    "linkage", Status.OK, f"joint '{self.scene.driven_joint}' turns by {turn:.3g} rad per rad of α"
                )

    def drive(self, task: Task[MuJoCoSceneParameters]) -> tuple[Track, Samples]:
        """Steps through the grid; stops early if the run is invalid."""
        with quiet():
            running = _Running(self.load(), task)
            track, samples = follow(self.name, running, task, _HEALTH_INTERVAL)
        samples.extremes["warnings"] = running.remarks(samples)
        return track, samples


class _Running:
    """The scene while it is stepped; `harness.engines.chord.Scene`."""

    def __init__(self, loaded: MuJoCoModel, task: Task[MuJoCoSceneParameters]) -> None:
        self.loaded, self.model, self.data = loaded, loaded.model, loaded.data
        loaded.frame = loaded.frame.shifted(task.across)
        names, model, frame = loaded.names, loaded.model, loaded.frame
        task.settings.apply(model, [names.sphere, *names.beam_geoms], list(names.pairs))
        gravity = frame.direction_inside(np.array(model.opt.gravity))
        model.opt.gravity[:] = frame.direction_outside(tilted(gravity, task.rig.level_angle))
        self.dt, self.first = task.grid.time_step, float(task.grid.time[0])
        self.dof, self.at = int(model.jnt_dofadr[names.driven_joint]), int(model.jnt_qposadr[names.driven_joint])
        self.beam_at = int(model.jnt_qposadr[names.beam_joint])
        free = int(model.body_jntadr[names.ball])
        self.ball_at, self.ball_dof = int(model.jnt_qposadr[free]), int(model.jnt_dofadr[free])
        self.linkage = _linkage(loaded, task.grid)
        self.turn = self._driven_rate(float(task.grid.angle[0]), task.first.beam_rate)
        self.others: set[str] = set()
        self.seen = (0, 0.0)
        self._place(task)

    def pose(self) -> Pose:
        at = self.ball_at
        centre = self.loaded.frame.inside(self.data.qpos[at : at + 3]).tolist()
        return (*centre, *self.data.qpos[at + 3 : at + 7].tolist())

    def spin_angle(self, orientations: FloatArray) -> FloatArray:
        return spin_angle_of(orientations[:, 1:] @ self.loaded.frame.axes[1], orientations[:, 0])

    def push(self, pose: Pose, x: float, z: float) -> None:
        force = self.loaded.frame.direction_outside(np.array([x, 0.0, z]))
        self.data.xfrc_applied[self.loaded.names.ball, :3] = force

    def stepper(self) -> Stepper:
        return self._step

    def _step(self, angle: float, rate: float, x: float, z: float) -> Pose:
        begin, end, data = self._driven(angle), self._driven(angle + rate * self.dt), self.data
        after = (end - begin) / self.dt
        data.qpos[self.at], data.qvel[self.dof] = begin, self.turn
        data.qfrc_applied[self.dof] = ARMATURE * (after - self.turn) / self.dt
        clock = data.time
        mujoco.mj_step(self.model, data)
        if data.time - clock < 0.5 * self.dt:
            now = self.first + clock
            raise EngineFailure("mujoco", Failure.RESET, now, f"MuJoCo reset its state; {Failure.RESET.value}")
        self.turn = after
        self._look(angle)
        return self.pose()

    def contacts(self, angle: float) -> tuple[int, float]:
        """Most contacts and largest load of the steps since the last look."""
        seen, self.seen = self.seen, (0, 0.0)
        return seen

    def beam_angle(self) -> float:
        return float(self.data.qpos[self.beam_at] - self.loaded.scene.level_joint_angle) * self.loaded.scene.direction

    def ball_speed(self) -> float:
        return float(np.linalg.norm(self.data.qvel[self.ball_dof : self.ball_dof + 3]))

    def remarks(self, samples: Samples) -> tuple[str, ...]:
        """What the user should know of the run."""
        told = list(self.loaded.told)
        sag = max(samples.angle_error, default=0.0)
        if sag > _LARGEST_SAG:
            told.append(
                f"the linkage lets the beam depart from the recorded angle by up to {sag:.2g} rad: give its equality "
                "constraints a shorter time constant (solref) and a higher impedance (solimp)"
            )
        if self.others:
            told.append(f"the ball also touched {', '.join(sorted(self.others))}")
        kinds = [kind for kind in mujoco.mjtWarning.__members__.values() if kind != mujoco.mjtWarning.mjNWARNING]
        counts = [(kind.name.removeprefix("mjWARN_"), self.data.warning[int(kind)].number) for kind in kinds]
        return (*told, *(f"{name} × {count}" for name, count in counts if count))

    def _place(self, task: Task[MuJoCoSceneParameters]) -> None:
        """Initial state: positions at t₀, velocities at t₀ − dt/2, the ball as deep as its contacts let it sink."""
        angle, first, data, frame = float(task.grid.angle[0]), task.first, self.data, self.loaded.frame
        data.qvel[:] = 0.0
        self.loaded.turn_beam(angle)
        if self.linkage is not None:
            for joint, position, slope in zip(
                self.linkage.joints, self.linkage.at(angle), self.linkage.slope(angle), strict=True
            ):
                data.qpos[self.model.jnt_qposadr[joint]] = position
                data.qvel[self.model.jnt_dofadr[joint]] = slope * first.beam_rate
        data.qvel[self.model.jnt_dofadr[self.loaded.names.beam_joint]] = self.loaded.scene.direction * first.beam_rate
        up = np.array([np.sin(angle), 0.0, np.cos(angle)])
        centre = np.array(first.centre)
        sunk = self._sunk(centre, up, task)
        self.loaded.put_ball(tuple((centre - sunk * up).tolist()))
        dof = self.ball_dof
        data.qvel[dof : dof + 3] = frame.direction_outside(np.array(first.velocity))
        data.qvel[dof + 3 : dof + 6] = first.spin * frame.axes[1]
        data.time = 0.0

    def _sunk(self, centre: FloatArray, up: FloatArray, task: Task[MuJoCoSceneParameters]) -> float:
        """Depth at which the contacts carry the ball's weight on the beam at rest [m]."""
        data, model, frame = self.data, self.model, self.loaded.frame
        normal = frame.direction_outside(up)
        moving = data.qvel.copy()
        data.qvel[:] = 0.0

        def unbalanced(depth: float) -> float:
            self.loaded.put_ball(tuple((centre - depth * up).tolist()))
            mujoco.mj_forward(model, data)
            return float(data.qacc[self.ball_dof : self.ball_dof + 3] @ normal)

        deepest, depth = 0.1 * task.rig.rolling_radius, 1e-9
        while unbalanced(depth) <= 0.0:
            depth *= 3.0
            if depth > deepest:
                failure = Failure.LEFT_GROOVE
                text = f"the contacts of the scene are too soft to carry the ball; {failure.value}"
                raise EngineFailure("mujoco", failure, self.first, text)
        found = float(brentq(unbalanced, 0.0, depth, xtol=1e-13))
        data.qvel[:] = moving
        data.qacc_warmstart[:] = 0.0
        return found

    def _driven(self, angle: float) -> float:
        """Position of the driven joint for a beam at α [rad]."""
        return self.loaded.beam_position(angle) if self.linkage is None else float(self.linkage.at(angle)[0])

    def _driven_rate(self, angle: float, rate: float) -> float:
        """Its rate where the beam turned by `rate` [rad/s] half a step before it was at α = `angle` [rad]."""
        if self.linkage is None:
            return self.loaded.scene.direction * rate
        return float(self.linkage.slope(angle - 0.5 * self.dt * rate)[0]) * rate

    def _look(self, angle: float) -> None:
        """Gather the contacts of the step that began at α = `angle` [rad]."""
        names, count, load = self.loaded.names, 0, 0.0
        wrench, up = np.zeros(6), np.array([np.sin(angle), 0.0, np.cos(angle)])
        for number in range(self.data.ncon):
            contact = self.data.contact[number]
            first, second = int(contact.geom[0]), int(contact.geom[1])
            if names.sphere not in (first, second):
                continue
            mujoco.mj_contactForce(self.model, self.data, number, wrench)
            if wrench[0] <= 0.0:
                continue
            other, way = (second, -1.0) if first == names.sphere else (first, 1.0)
            if other not in names.beam_geoms:
                self.others.add(self.loaded.geom_name(other))
                continue
            normal = self.loaded.frame.direction_inside(way * np.array(contact.frame[:3]))
            count, load = count + 1, load + float(wrench[0] * (normal @ up))
        self.seen = max(self.seen[0], count), max(self.seen[1], load)


def _linkage(loaded: MuJoCoModel, grid: Grid) -> Linkage | None:
    if loaded.names.driven_joint == loaded.names.beam_joint:
        return None
    return linkage_of(loaded, float(grid.angle.min()), float(grid.angle.max()))
