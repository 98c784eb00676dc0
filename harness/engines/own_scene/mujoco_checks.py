"""Checks of what only an MJCF has: friction, what else acts on ball and joint, where the file puts the ball."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from harness.engines.own_scene.checks import Check, Status, Use, joint_limits
from harness.engines.own_scene.measuring import Measured
from harness.engines.own_scene.mujoco_model import MuJoCoModel
from harness.engines.parameters import EngineParameters

_LEAST_FRICTION = 0.05  # a ball on a flat beam at 6° needs (1 − K) tan 6° = 0.03 not to slide
# A constraint of impedance d and time constant τ gives way by (1 − d) τ² times the acceleration that it holds back.
# Of a beam behind a crank that is some 10 rad/s²: 9 in the scene of the tests, over a range of 1e-10 to 4e-5 s².
_HELD_BACK = 10.0  # [rad/s²]
_LARGEST_SAG = 1e-5  # [rad]: 0.3 mm after three seconds
_PRESS = 2e-6  # depth at which the contacts are looked at [m]


def checks_of(loaded: MuJoCoModel, seen: Measured, use: Use) -> Iterator[Check]:
    """The checks of a loaded scene.

    Args:
        loaded: the scene.
        seen: what was measured in it.
        use: what the recordings ask for.
    """
    model, scene = loaded.model, loaded.scene
    yield _friction(loaded, seen)
    for text in loaded.told:
        yield Check("what acts on the joint", Status.WARNING, f"{text}, and does so alone.")
    dof = int(model.jnt_dofadr[model.body_jntadr[loaded.names.ball]])
    if np.any(model.dof_damping[dof : dof + 6]) or np.any(model.dof_frictionloss[dof : dof + 6]):
        yield Check(
            "what brakes the ball",
            Status.WARNING,
            f"the joint of body '{scene.ball}' has damping or frictionloss, which no track has. Delete them, or "
            "declare the effect that they stand for.",
        )
    if model.opt.density or model.opt.viscosity:
        yield Check(
            "what brakes the ball",
            Status.WARNING,
            "the scene has a medium (density, viscosity), which brakes the ball. Delete it, or declare air drag.",
        )
    sag = _sag(loaded)
    if sag > _LARGEST_SAG:
        yield Check(
            "stiffness of the linkage",
            Status.WARNING,
            f"its equality constraints give way: the beam will depart from the recorded angle by some {sag:.0e} rad. "
            'Give them solref="0.002 1" solimp="0.9999 0.9999 0.001".',
        )
    if loaded.limits is not None:
        low, high = sorted(scene.direction * (one - scene.level_joint_angle) for one in loaded.limits)
        wide = joint_limits(low, high, use)
        if wide is not None:
            yield wide
    start, (begin, end) = loaded.ball.start[0], use.positions or seen.track
    if use.positions is not None and not begin <= start <= end and begin <= -start <= end:
        yield Check(
            "direction",
            Status.WARNING,
            f"the file has the ball at s = {start:.3f} m, and in the recordings it rolls from {begin:.3f} to "
            f"{end:.3f} m. If that is one end of the beam, write direction = {-scene.direction}.",
        )
    else:
        yield Check("direction", Status.OK, _direction(loaded))
    default = EngineParameters.model_fields["time_step"].default
    yield Check(
        "time step",
        Status.OK,
        f"{loaded.time_step:g} s in the file; {default:g} s is used unless --set mujoco.time_step says otherwise",
    )


def _sag(loaded: MuJoCoModel) -> float:
    """By about how much the softest equality constraint lets the beam depart [rad]; 0 without any."""
    model = loaded.model
    soft = [
        (1.0 - float(impedance[0])) * float(reference[0]) ** 2
        for reference, impedance in zip(model.eq_solref, model.eq_solimp, strict=True)
        if reference[0] > 0.0  # below, a stiffness is given and no time constant
    ]
    return _HELD_BACK * max(soft, default=0.0)


def _direction(loaded: MuJoCoModel) -> str:
    """Which end goes down, in the words of the scene's own axes."""
    end = loaded.frame.axes[0]
    named = max(range(3), key=lambda axis: abs(end[axis]))
    sign = "+" if end[named] > 0 else "−"
    turn = "positive" if loaded.scene.direction > 0 else "negative"
    return (
        f"a {turn} angle of joint '{loaded.scene.beam_joint}' is a positive α: it lowers the end towards "
        f"{sign}{'xyz'[named]}, where s is positive"
    )


def _friction(loaded: MuJoCoModel, seen: Measured) -> Check:
    """Of the contacts that carry the ball."""
    loaded.turn_beam(0.0)
    loaded.touches((seen.at, seen.across, seen.height - _PRESS))
    data, names = loaded.data, loaded.names
    found = [
        (int(one.dim), float(np.max(one.friction[:2])))
        for one in (data.contact[number] for number in range(data.ncon))
        if names.sphere in one.geom and not names.beam_geoms.isdisjoint(int(geom) for geom in one.geom)
    ]
    if any(dim == 1 for dim, _ in found):
        return Check(
            "friction", Status.ERROR, 'the contact has condim="1": no friction, the ball slides. Write condim="3".'
        )
    least = min(friction for _, friction in found)
    if least < _LEAST_FRICTION:
        return Check(
            "friction",
            Status.WARNING,
            f"the friction coefficient of ball and beam is {least:g}; below {_LEAST_FRICTION:g} the ball "
            "slides. Raise it.",
        )
    return Check("friction", Status.OK, f"the friction coefficient of ball and beam is {least:g}")
