"""A beam that a crank moves through links: the angles of crank and links at which the beam has the angle α.

The loop is closed by equality constraints of the scene (`<connect>`, `<weld>`, `<joint>`). At a given α their residuals
vanish at the angles looked for, which Newton's method finds from the neighbouring α on. Angles between are interpolated
by a quintic spline; over 10° a crank's angle is so smooth that its error is far below a nanoradian.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from analytic.motion import FloatArray
from harness.engines.own_scene.mujoco_model import MuJoCoModel
from harness.errors import InputError

_NODES = 65
_CLOSED = 1e-9  # residual of the closed loop [m, rad]
_LONGEST = 0.3  # of a step of Newton's method [rad, m]
_MOST = 50  # steps of Newton's method
_DEAD = 1e-3  # change of the beam's angle over the crank's, below which the linkage is at a dead centre
_STEP = math.radians(1.0)  # from the angle at which the file has the beam to the first one looked for


@dataclass(frozen=True, eq=False)
class Linkage:
    """Angles of the joints of a linkage over α.

    Attributes:
        joints: indices of all joints that follow the beam, the driven one first.
        positions: spline of their positions over α, shape (…, k) [rad, m].
        low, high: range of α [rad].
    """

    joints: tuple[int, ...]
    positions: BSpline
    low: float
    high: float

    def at(self, angle: float) -> FloatArray:
        """Positions of the joints at α [rad], shape (k,)."""
        return np.asarray(self.positions(angle), dtype=np.float64)

    def slope(self, angle: float) -> FloatArray:
        """Their derivatives with respect to α, shape (k,)."""
        return np.asarray(self.positions(angle, 1), dtype=np.float64)


def linkage_of(loaded: MuJoCoModel, low: float, high: float) -> Linkage:
    """The linkage of a scene whose driven joint is not the beam's.

    Args:
        loaded: the scene.
        low, high: range of α that is needed [rad].

    Raises:
        InputError: no linkage connects both joints, or it cannot turn the beam that far.
    """
    model, names = loaded.model, loaded.names
    place = f"{loaded.place}: driven_joint '{loaded.scene.driven_joint}'"
    scalar = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
    others = [
        joint
        for joint in range(model.njnt)
        if joint not in (names.beam_joint, names.driven_joint) and int(model.jnt_type[joint]) in scalar
    ]
    joints = (names.driven_joint, *others)
    data = mujoco.MjData(model)
    begin = (data.qpos[model.jnt_qposadr[names.beam_joint]] - loaded.scene.level_joint_angle) * loaded.scene.direction
    margin = 0.05 * (high - low) + 1e-3
    low, high = low - margin, high + margin
    nodes = np.linspace(low, high, _NODES)
    solved = np.empty((_NODES, len(joints)))
    for way in (1, -1):
        _close(loaded, data, joints, begin, place)
        towards = nodes[nodes >= begin] if way > 0 else nodes[nodes < begin][::-1]
        # From the file's own angle to the nearest one that is needed, in small steps.
        first = towards[0] if len(towards) else begin
        for angle in np.linspace(begin, first, max(2, math.ceil(abs(first - begin) / _STEP) + 1)):
            _close(loaded, data, joints, float(angle), place)
        for angle in towards:
            _close(loaded, data, joints, float(angle), place)
            solved[np.searchsorted(nodes, angle)] = data.qpos[model.jnt_qposadr[list(joints)]]
    crank = np.diff(solved[:, 0]) / np.diff(nodes)
    if np.any(np.abs(crank) * _DEAD > 1.0) or np.any(crank[1:] * crank[:-1] <= 0.0):
        raise InputError(
            f"{place}: the linkage passes a dead centre between α = {math.degrees(low):.1f}° and "
            f"{math.degrees(high):.1f}°, where the crank does not decide the beam's angle. Correct its lengths."
        )
    return Linkage(joints, make_interp_spline(nodes, solved, k=5), low, high)


def _close(loaded: MuJoCoModel, data: mujoco.MjData, joints: tuple[int, ...], angle: float, place: str) -> None:
    """Set the beam to α = `angle` [rad] and the other joints so that the loop is closed."""
    model, names = loaded.model, loaded.names
    places, dofs = model.jnt_qposadr[list(joints)], model.jnt_dofadr[list(joints)]
    data.qpos[model.jnt_qposadr[names.beam_joint]] = loaded.beam_position(angle)
    residual = math.inf
    for _ in range(_MOST):
        mujoco.mj_fwdPosition(model, data)
        rows = np.flatnonzero(data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY))
        if not len(rows):
            raise InputError(
                f"{place}: no equality constraint connects it with the beam. Close the loop with "
                "<equality><connect …/>, or leave driven_joint out."
            )
        error = data.efc_pos[rows]
        residual = float(np.abs(error).max())
        if residual < _CLOSED:
            return
        jacobian = data.efc_J.reshape(-1, model.nv)[np.ix_(rows, dofs)]
        step = np.linalg.lstsq(jacobian, error, rcond=1e-9)[0]
        data.qpos[places] -= step * min(1.0, _LONGEST / max(float(np.abs(step).max()), 1e-12))
    raise InputError(
        f"{place}: the linkage cannot turn the beam to α = {math.degrees(angle):.2f}° (its loop stays open by "
        f"{1e3 * residual:.3g} mm). Correct its lengths, direction or level_joint_angle_rad."
    )
