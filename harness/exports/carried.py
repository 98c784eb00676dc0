"""What of each effect a format carries, and how, and what to do about the rest: nothing is left out silently."""

from __future__ import annotations

from dataclasses import dataclass

from analytic.effects import Acting, Effect, sensor_with
from harness.exports.model import Exported, ExportModel
from harness.identify.problem.spline_term import Regressor, SplineTerm

_CODE = ("c", "python", "fmu")
_UNLISTED = "a law that no catalogue lists"


@dataclass(frozen=True)
class Carried:
    """What became of one effect.

    Attributes:
        name: of the effect.
        carried: whether the files have it.
        how: where it is in the files, or why it is not and what to do.
        parts: its constants in words.
    """

    name: str
    carried: bool
    how: str
    parts: tuple[str, ...]


def in_source(model: ExportModel, to: str) -> list[Carried]:
    """All effects, as source code has them: each one, but an FMU no negative delay.

    Args:
        model: the model.
        to: "c", "python" or "fmu".
    """
    return [Carried(one.acting.effect.name, *_source_answer(one, to), told(one)) for one in model.effects]


def told(one: Exported) -> tuple[str, ...]:
    """Its parameters in words."""
    return tuple(
        f"{parameter.name} = {constant.value:.6g} {constant.told}"
        for parameter, constant in zip(one.acting.effect.parameters, one.constants, strict=True)
    )


def _source_answer(one: Exported, to: str) -> tuple[bool, str]:
    """Whether source code has an effect, and how, or what to do."""
    effect, names = one.acting.effect, ", ".join(constant.name for constant in one.constants)
    if effect.alter is not None:
        return True, "in the rig's constants, which are what they are with it"
    if effect.sensor is None:
        return True, f"in the equations, by {names}"
    delay = sensor_with([one.acting]).delay
    if to == "fmu" and delay < 0.0:
        return False, (
            f"an angle that is late by {-delay:.6g} s asks for angles of the future, which no FMU has; feed the inputs "
            f"{-delay:.6g} s early, at t those of t + {-delay:.6g} s: `position` at t is then what is recorded at t"
        )
    if delay == 0.0:
        return True, "in the constants SENSOR_…"
    if to == "fmu":
        return True, "in the constants SENSOR_…; `position` comes later by the delay"
    last = f"; the last {-delay:.6g} s, which need angles after the last row, are left blank" if delay < 0.0 else ""
    return True, f"in the constants SENSOR_…; the delay shifts what is printed{last}"


def in_linear(model: ExportModel) -> list[Carried]:
    """All effects, as a linear model has them."""
    return [Carried(one.acting.effect.name, *_linear_answer(one.acting.effect), told(one)) for one in model.effects]


def spline_in(model: ExportModel, to: str) -> list[Carried]:
    """What became of a law that no catalogue lists, as the only item; none without one."""
    spline = model.spline
    return [] if spline is None else [Carried(spline.name, *_spline_answer(spline, to), ())]


def _spline_answer(spline: SplineTerm, to: str) -> tuple[bool, str]:
    """Whether a format has a law that no catalogue lists, and how, or why not."""
    if to in _CODE and spline.sensor:
        return True, f"{_UNLISTED}, in what is recorded, as NODES"
    if to in _CODE and spline.depends is Regressor.TIME:
        low, high = float(spline.places[0]), float(spline.places[-1])
        begin = "; begin the simulation at the recording's time" if to == "fmu" else ""
        return True, (
            f"{_UNLISTED}, in the equations, as NODES; its t is the time of the recordings, from {low:.6g} to "
            f"{high:.6g} s, beyond which the law is constant: it does not tell what another run has{begin}"
        )
    if to in _CODE:
        return True, f"{_UNLISTED}, in the equations, as NODES"
    if to == "statespace" and not spline.friction:
        return True, f"{_UNLISTED}, by its slope at the operating point"
    if to == "statespace":
        return False, f"{_UNLISTED}; a dry friction has no derivative at rest; --to python has it as source"
    if spline.sensor:
        return False, f"{_UNLISTED}; a scene has no sensor; --to python has it as source"
    return False, f"{_UNLISTED}; apply it as a force on the ball in every step; --to python has it as source"


def _linear_answer(effect: Effect) -> tuple[bool, str]:
    """Whether a linear model has an effect, and how, or why not."""
    code = effect.code
    if effect.sensor is not None:
        return True, "in the output, a lag as a state, a delay as a number of its own"
    if effect.alter is not None or code is None:
        return True, "in the rig's quantities"
    if effect.dry or code.inner is not None:
        return False, "it has no derivative at rest; the linear model is that of a ball without it"
    if code.stage in ("play", "drift"):
        return False, "no linear time-invariant model has it; apply it to the angle"
    if code.stage == "hold":
        return True, "as a lag of half its interval, which is right to first order in frequency"
    if code.stage == "lag":
        return True, "as a state"
    if code.stage == "servo":
        return True, "as two states"
    if effect.turning:
        return True, "by its slope for a ball whose rolled angle is 0 at position 0"
    return True, "by its derivatives at the operating point"


def in_scene(model: ExportModel, *, slips: bool) -> list[Carried]:
    """All effects, as a scene has them.

    Args:
        model: the model.
        slips: whether the scene has the engine's friction, so that a ball that slides is in it.
    """
    return [_in_scene(one, slips) for one in model.effects]


def scene_effects(model: ExportModel, *, slips: bool) -> tuple[Acting, ...]:
    """The effects that a scene carries."""
    return tuple(
        one.acting for one, kept in zip(model.effects, in_scene(model, slips=slips), strict=True) if kept.carried
    )


def _in_scene(one: Exported, slips: bool) -> Carried:
    carried, how = _scene_answer(one.acting.effect, slips)
    return Carried(one.acting.effect.name, carried, how, told(one))


def _scene_answer(effect: Effect, slips: bool) -> tuple[bool, str]:
    """Whether a scene has an effect, and how, or why not."""
    code = effect.code
    if effect.alter is not None or places_pivot(effect):
        return True, "in the geometry"
    if levels(effect):
        return True, "in the direction of gravity, which acts along the beam as g sin(angle + level)"
    if effect.engine.settings and slips:
        return True, "in the friction of the contacts"
    if effect.engine.settings:
        return (
            False,
            "URDF has no friction that engines agree on; set the engine's own friction coefficient of the ball",
        )
    if effect.sensor is not None:
        return (
            False,
            "a scene has no sensor; apply it to the position that you read (README of --to python has the law)",
        )
    if effect.moves_beam:
        return (
            False,
            "a scene has no law between the recorded angle and the beam; apply it to the angle before you drive "
            "the joint",
        )
    if (code is not None and code.inner == "dahl") or effect.dry:
        return False, (
            "engines regularise friction against rolling and let a ball at rest creep; apply the force on the ball in "
            "every step, as `harness run` does"
        )
    if code is not None and code.tilt:
        return False, (
            "gravity is the same everywhere in a scene, and this tilt depends on the position; apply the force m "
            "g times "
            "it along the beam in every step"
        )
    return False, "no element of the format is this law; apply the force on the ball in every step"


def places_pivot(effect: Effect) -> bool:
    """Whether it says where the pivot is."""
    return effect.relations.stands_for == "lever"


def levels(effect: Effect) -> bool:
    """Whether an effect is a constant tilt of gravity."""
    return effect.code is not None and effect.code.tilt == "{" + effect.parameters[0].name + "}"
