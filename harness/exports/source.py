"""What templates of source code are filled with: constants, expressions, stages; the same for C and Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic.effects import parameters_with
from analytic.models import CAM
from analytic.slots import QUADRATIC, VISCOUS
from harness.exports.model import LONGEST_STEP, Constant, ExportModel, refuse_own_effects
from harness.identify.problem.spline_term import Regressor

_ARGUMENT = {
    Regressor.POSITION: "s",
    Regressor.VELOCITY: "v",
    Regressor.ANGLE: "angle",
    Regressor.ROLL_ANGLE: "phi",
    Regressor.TIME: "t",
}


@dataclass(frozen=True)
class StageText:
    """A stage between the measured angle and the beam's: its kind, number, and the names of its constants."""

    kind: str
    number: int
    names: tuple[str, ...]

    @property
    def square(self) -> str:
        """q of a lag q b'' + T b' + b = a, 0 where it is of first order."""
        if self.kind != "servo":
            return "0.0"
        lag, damping = self.names
        return f"0.25 * {lag} * {lag} / ({damping} * {damping})"


def constants_of(model: ExportModel) -> list[Constant]:
    """Every named number: the rig's, the effects', the sensor's."""
    rig, sensor = model.rig, model.sensor
    told = [
        Constant("MASS", rig.mass, "kg", "m, ball mass"),
        Constant("INERTIA", rig.inertia, "kg m²", "J, moment of inertia of the ball"),
        Constant("RADIUS", rig.radius, "m", "R, ball radius"),
        Constant("ROLLING_RADIUS", rig.rolling_radius, "m", "r, height of the ball's centre above the edges"),
        Constant("ECCENTRICITY", rig.eccentricity, "m", "h, from the pivot up to the edges"),
        Constant("GRAVITY", rig.gravity, "m/s²", "g"),
        Constant("LEVEL_ANGLE", rig.level_angle, "rad", "α₀ of the rig, added to the angle that gravity sees"),
    ]
    for one in model.effects:
        for constant in one.constants:
            part = "estimated" if one.found else "declared"
            told.append(replace(constant, meaning=f"{one.acting.effect.name} ({part}): {constant.meaning}"))
    return [
        *told,
        Constant("SENSOR_GAIN", sensor.gain, "1", "recorded position per position, of all effects on the sensor"),
        Constant("SENSOR_SQUARE", sensor.square, "1/m", "its curve: gain (s + square s² + cube s³)"),
        Constant("SENSOR_CUBE", sensor.cube, "1/m²", "its curve"),
        Constant("SENSOR_LAG", sensor.lag, "s", "T of T y' + y = s"),
        Constant("SENSOR_DELAY", sensor.delay, "s", "the position at t is recorded at t + delay; negative: angle late"),
        Constant("LONGEST_STEP", LONGEST_STEP, "s", "of the integration between two rows"),
    ]


def context_of(model: ExportModel, what: str) -> Mapping[str, Any]:
    """What the templates are filled with.

    Args:
        model: the model.
        what: the format, for messages.

    Raises:
        InputError: an effect cannot be written as source code.
    """
    refuse_own_effects(model, what)
    tilt, force, plus, minus = ["angle", "LEVEL_ANGLE"], [], [], []
    stages: list[StageText] = []
    inner: dict[str, tuple[str, ...]] = {}
    falling, lever = False, "ECCENTRICITY + ROLLING_RADIUS + INERTIA / (MASS * ROLLING_RADIUS)"
    for one in model.effects:
        code, names = one.acting.effect.code, one.names
        if code is None:
            continue
        tilt += [code.tilt.format(**names)] if code.tilt else []
        lever = code.lever.format(**names) or lever
        force += [code.force.format(**names)] if code.force else []
        if code.dry is not None:
            plus.append(code.dry[0].format(**names))
            minus.append(code.dry[1].format(**names))
        falling = falling or code.falling
        if code.stage is not None:
            stages.append(StageText(code.stage, len(stages), tuple(names.values())))
        if code.inner is not None:
            inner[code.inner] = tuple(names.values())
    spline = model.spline
    if spline is not None and not (spline.friction or spline.sensor or spline.depends is Regressor.TIME):
        force.append(f"spline({_ARGUMENT[spline.depends]})")
    dry = bool(plus) or (spline is not None and spline.friction)
    # A tilt of the whole rig comes after all that turns the beam, in which order ever they act.
    stages.sort(key=lambda one: one.kind == "drift")
    return {
        "model": model,
        "constants": constants_of(model),
        "tilt": " + ".join(tilt),
        "lever": lever,
        "force": " + ".join(force),
        "plus": " + ".join(plus) or "0.0",
        "minus": " + ".join(minus) or "0.0",
        "dry": dry,
        "lost": dry and "slip" not in inner and _feels_velocity(model),
        "falling": falling,
        "stages": [replace(one, number=number) for number, one in enumerate(stages)],
        "history": any(one.kind == "hold" for one in stages),
        "slip": inner.get("slip"),
        "dahl": inner.get("dahl"),
        "spline": spline,
        "argument": "" if spline is None else _ARGUMENT[spline.depends],
        "time_force": spline is not None and spline.depends is Regressor.TIME and not spline.friction,
        "nodes": [] if spline is None else [float(one) for one in spline.nodes],
    }


def _feels_velocity(model: ExportModel) -> bool:
    """Whether a smooth force on the ball depends on its velocity, but for what turns it about the pivot."""
    p = parameters_with(CAM, model.declared_rig, model.acting)
    spline = model.spline
    of_velocity = spline is not None and spline.depends is Regressor.VELOCITY and not spline.friction
    return of_velocity or p[VISCOUS] != 0.0 or p[QUADRATIC] != 0.0


@lru_cache
def environment() -> Environment:
    """The template environment of source code; undefined names are errors."""
    made = Environment(
        loader=PackageLoader("harness.exports"),
        autoescape=False,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters["exact"] = lambda value: repr(float(value))
    made.filters["line"] = lambda text: " ".join(str(text).split()).replace("*/", "* /").replace("\\", "/")
    return made


def render(template: str, context: Mapping[str, Any]) -> str:
    """A template of harness/exports/templates, filled."""
    return environment().get_template(template).render(context)
