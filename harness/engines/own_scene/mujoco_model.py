"""A user's MJCF as a model that a recorded angle can drive: names found, the joint made heavy, servos switched off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from analytic.motion import FloatArray
from analytic.naming import did_you_mean
from harness.engines.leapfrog import Vector
from harness.engines.own_scene.frame import Frame, frame_of
from harness.engines.own_scene.measuring import BallFacts, Touch
from harness.errors import InputError
from harness.scene import Scene

# Inertia that the driven joint is given [kg m²]. Its angle is set anew before every step, so that nothing adds up; what
# is left is the velocity that the ball's and the beam's weight (some N m) give it within a step, 1e-9 rad/s.
ARMATURE = 1e6
TOLERANCE = 1e-16  # of the solver, as of the built-in scene: relative to the inertia
_ROUND = 0.01  # by which a ball's moments of inertia may differ
_CENTRED = 1e-6  # by which the ball's sphere may lie off the body's origin and centre of mass [m]


@dataclass(frozen=True, eq=False)
class Names:
    """Indices of what matters in a model.

    Attributes:
        beam_joint, driven_joint: the hinge of the beam, and the joint that is driven.
        ball, sphere: body and geometry of the ball.
        beam_geoms: what moves with the beam.
        pairs: explicit pairs of ball and beam.
    """

    beam_joint: int
    driven_joint: int
    ball: int
    sphere: int
    beam_geoms: frozenset[int]
    pairs: tuple[int, ...]


class MuJoCoModel:
    """A loaded scene, in which the ball can be put anywhere.

    Attributes:
        place: file, for messages.
        model: prepared to be driven.
        data: of this object's own.
        names: indices.
        frame: of the harness in the scene's world.
        ball: as the file has it.
        gravity: g [m/s²].
        limits: of the beam's joint as the file has them [rad]; `None` without.
        time_step: as the file has it [s].
        told: what was changed in order to drive the scene, in words.
    """

    def __init__(self, scene: Scene, file: Path) -> None:
        """Load and check.

        Raises:
            InputError: MuJoCo cannot load the file, or it is no ball on a hinged beam.
        """
        self.place = str(file)
        try:
            self.model = mujoco.MjModel.from_xml_path(str(file))
        except (ValueError, mujoco.FatalError) as error:
            text = " ".join(str(error).split())
            raise InputError(f"{file}: MuJoCo cannot load it: {text}. Correct the file.") from None
        self.names = _names(self.model, scene, file)
        hinge = self.names.beam_joint
        self.limits = tuple(self.model.jnt_range[hinge].tolist()) if self.model.jnt_limited[hinge] else None
        self.time_step = float(self.model.opt.timestep)
        self.scene, self.data = scene, mujoco.MjData(self.model)
        self.told = _release(self.model, self.names)
        up = -self.model.opt.gravity
        self.gravity = float(np.linalg.norm(up))
        if self.gravity == 0.0:
            raise InputError(f'{file}: there is no gravity. Write <option gravity="0 0 -9.81"/>.')
        self.turn_beam(0.0)
        self.frame: Frame = frame_of(
            f"{file}: joint '{scene.beam_joint}'",
            self.data.xanchor[hinge].copy(),
            self.data.xaxis[hinge].copy(),
            up,
            scene.direction,
        )
        self.ball = self._ball_facts()

    def beam_position(self, angle: float) -> float:
        """Of the beam's joint at α [rad]."""
        return self.scene.level_joint_angle + self.scene.direction * angle

    def turn_beam(self, angle: float) -> None:
        """Set the beam's joint to α [rad]; a linkage is left as it is."""
        self.data.qpos[self.model.jnt_qposadr[self.names.beam_joint]] = self.beam_position(angle)
        mujoco.mj_kinematics(self.model, self.data)

    def put_ball(self, centre: Vector) -> None:
        """Put the ball's centre there, in the harness's frame [m], with no rotation."""
        first = self.model.jnt_qposadr[self.model.body_jntadr[self.names.ball]]
        self.data.qpos[first : first + 3] = self.frame.outside(np.array(centre))
        self.data.qpos[first + 3 : first + 7] = (1.0, 0.0, 0.0, 0.0)

    def touches(self, centre: Vector) -> list[Touch]:
        """What the ball touches or penetrates with its centre there, in the harness's frame [m]."""
        self.put_ball(centre)
        mujoco.mj_fwdPosition(self.model, self.data)
        found = []
        for number in range(self.data.ncon):
            contact = self.data.contact[number]
            first, second = int(contact.geom[0]), int(contact.geom[1])
            if self.names.sphere not in (first, second) or contact.dist > 0.0:
                continue
            other, way = (second, -1.0) if first == self.names.sphere else (first, 1.0)
            normal = self.frame.direction_inside(way * np.array(contact.frame[:3]))
            found.append(Touch(tuple(normal.tolist()), other in self.names.beam_geoms, self.geom_name(other)))
        return found

    def geom_name(self, geom: int) -> str:
        """Name of a geometry, or of its body."""
        own = mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_GEOM, geom)
        body = mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_BODY, self.model.geom_bodyid[geom])
        return own or body or f"geom {geom}"

    def _ball_facts(self) -> BallFacts:
        model, body = self.model, self.names.ball
        moments: FloatArray = np.array(model.body_inertia[body])
        if np.ptp(moments) > _ROUND * moments.mean():
            raise InputError(
                f"{self.place}: body '{self.scene.ball}' has the moments of inertia {_numbers(moments)} kg m². A ball "
                "has three equal ones."
            )
        mujoco.mj_kinematics(model, self.data)
        start = self.frame.inside(np.array(self.data.xpos[body]))
        radius = float(model.geom_size[self.names.sphere, 0])
        return BallFacts(float(model.body_mass[body]), float(moments.mean()), radius, tuple(start.tolist()))


def _names(model: mujoco.MjModel, scene: Scene, file: Path) -> Names:
    hinge = _hinge(model, scene.beam_joint, file)
    driven = hinge if scene.driven_joint is None else _hinge(model, scene.driven_joint, file)
    ball, sphere = _ball(model, scene.ball, file)
    beam = int(model.jnt_bodyid[hinge])
    _refuse_moving_base(model, beam, scene, file)
    parents = model.body_parentid
    under = {beam}
    for body in range(beam + 1, model.nbody):  # parents come before their children
        if int(parents[body]) in under:
            under.add(body)
    if ball in under:
        raise InputError(f"{file}: body '{scene.ball}' is part of the beam. Let it be a child of <worldbody>.")
    geoms = frozenset(geom for geom in range(model.ngeom) if int(model.geom_bodyid[geom]) in under)
    pairs = tuple(
        pair
        for pair in range(model.npair)
        if {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])} & {sphere}
        and {int(model.pair_geom1[pair]), int(model.pair_geom2[pair])} & geoms
    )
    return Names(hinge, driven, ball, sphere, geoms, pairs)


def _hinge(model: mujoco.MjModel, name: str, file: Path) -> int:
    joint = _find(model, mujoco.mjtObj.mjOBJ_JOINT, model.njnt, name, "joint", file)
    kind = mujoco.mjtJoint(int(model.jnt_type[joint]))
    if kind != mujoco.mjtJoint.mjJNT_HINGE:
        word = kind.name.removeprefix("mjJNT_").lower()
        raise InputError(f"{file}: joint '{name}' is of type {word}. Name the hinge, or make it one: type=\"hinge\".")
    return joint


def _ball(model: mujoco.MjModel, name: str, file: Path) -> tuple[int, int]:
    body = _find(model, mujoco.mjtObj.mjOBJ_BODY, model.nbody, name, "body", file)
    joint = int(model.body_jntadr[body])
    if model.body_jntnum[body] != 1 or model.jnt_type[joint] != int(mujoco.mjtJoint.mjJNT_FREE):
        raise InputError(f"{file}: body '{name}' is not free. Give it a <freejoint/>, and nothing else to move it.")
    first = int(model.body_geomadr[body])
    geoms = range(first, first + int(model.body_geomnum[body]))
    paired = {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()}
    solid = [one for one in geoms if model.geom_contype[one] or model.geom_conaffinity[one] or one in paired]
    if len(solid) != 1 or model.geom_type[solid[0]] != int(mujoco.mjtGeom.mjGEOM_SPHERE):
        kinds = [mujoco.mjtGeom(int(model.geom_type[one])).name.removeprefix("mjGEOM_").lower() for one in solid]
        raise InputError(
            f"{file}: body '{name}' collides as {', '.join(kinds) or 'nothing'}. Give it one sphere that collides, "
            'and contype="0" conaffinity="0" for all that is only seen.'
        )
    off = max(float(np.linalg.norm(model.geom_pos[solid[0]])), float(np.linalg.norm(model.body_ipos[body])))
    if off > _CENTRED:
        raise InputError(
            f"{file}: body '{name}': sphere or centre of mass lies {1e3 * off:.3g} mm off the body's origin. Put both "
            "there."
        )
    return body, solid[0]


def _refuse_moving_base(model: mujoco.MjModel, beam: int, scene: Scene, file: Path) -> None:
    """The hinge has to turn about an axis that stays where it is."""
    if model.body_jntnum[beam] != 1:
        raise InputError(f"{file}: joint '{scene.beam_joint}' is not the only joint of its body. Keep the hinge only.")
    body = int(model.body_parentid[beam])
    while body:
        if model.body_jntnum[body] or model.body_mocapid[body] >= 0:
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
            raise InputError(f"{file}: body '{name}', which bears the beam, can move. Fix it to the world.")
        body = int(model.body_parentid[body])


def _find(model: mujoco.MjModel, kind: mujoco.mjtObj, count: int, name: str, word: str, file: Path) -> int:
    found = mujoco.mj_name2id(model, kind, name)
    if found >= 0:
        return int(found)
    names = [one for one in (mujoco.mj_id2name(model, kind, index) for index in range(count)) if one]
    key = "ball" if word == "body" else "beam_joint or driven_joint"
    raise InputError(
        f"{file}: there is no {word} '{name}'.{did_you_mean(name, names)} There is {', '.join(names) or 'none'}. Name "
        f"one in [scene], {key}."
    )


def _release(model: mujoco.MjModel, names: Names) -> tuple[str, ...]:
    """Let nothing but the drive act on the driven joint; what had to be changed, in words."""
    told = []
    if model.nu:
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_ACTUATION
        told.append(
            f"{model.nu} {'actuator is' if model.nu == 1 else 'actuators are'} switched off: the recorded angle drives"
        )
    for joint in {names.beam_joint, names.driven_joint}:
        dof = int(model.jnt_dofadr[joint])
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, joint)
        if model.jnt_stiffness[joint] or model.dof_frictionloss[dof] or _damped(model, dof):
            model.jnt_stiffness[joint] = model.dof_frictionloss[dof] = 0.0
            model.dof_damping[dof] = 0.0
            told.append(
                f"stiffness, damping and friction of joint '{name}' are switched off: the recorded angle drives"
            )
    # Limits are told by the checks.
    model.jnt_limited[[names.beam_joint, names.driven_joint]] = 0
    model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
    if model.opt.integrator == int(mujoco.mjtIntegrator.mjINT_RK4):
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        told.append("the integrator is Euler in place of RK4, whose velocities belong to whole steps")
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    model.opt.tolerance = TOLERANCE
    model.dof_armature[model.jnt_dofadr[names.driven_joint]] = ARMATURE
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return tuple(told)


def _damped(model: mujoco.MjModel, dof: int) -> bool:
    return bool(np.any(model.dof_damping[dof]))


def _numbers(values: Sequence[float] | FloatArray) -> str:
    return ", ".join(f"{float(value):.4g}" for value in values)
