"""What may be tuned: settings of an engine and quantities of its scene, with bounds, scale, and values to try."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, get_args

from pydantic.fields import FieldInfo

from analytic.naming import did_you_mean
from analytic.rig import Rig
from harness.engines.parameters import EngineParameters
from harness.engines.protocol import Engine
from harness.errors import InputError
from harness.recording.known_rig import UNITS

LEVEL = "level_angle_rad"
"""Name of the level angle, which is fitted in any case: without it every other parameter would stand in for it."""
_LEVEL_TRIED = 0.01  # [rad]
_DECADES = 1.5  # bounds that are further apart than so many decades ask for a logarithmic scale
_SHARES = (0.2, 0.4, 0.6, 0.8)  # of the range, tried where nothing better is known
_SCENE: dict[
    str, tuple[str, tuple[float, ...]]
] = {  # quantities of `Rig` by their keys in rig.toml, and by which factors they are tried
    "rolling_radius_m": ("rolling_radius", (0.9, 0.97)),
    "inertia_kg_m2": ("inertia", (0.8, 1.25)),
    "eccentricity_m": ("eccentricity", (0.5, 2.0)),
    "gravity_m_s2": ("gravity", (0.97, 1.03)),
}
_REACH = 3.0  # a quantity of the scene may become so many times as large or small
# Values that are tried: where a ball grips depends on the beam's motion, so that no derivative at the default tells.
_TRIED: dict[str, tuple[float, ...]] = {
    "mujoco.friction": (0.005, 0.01, 0.02, 0.04, 0.08),
    "mujoco.rolling_friction": (3e-5, 1e-4, 3e-4, 1e-3),
    "mujoco.torsional_friction": (3e-5, 1e-4, 3e-4, 1e-3),
    "mujoco.solref_timeconst": (0.005, 0.02, 0.05),
    "mujoco.solref_dampratio": (0.3, 3.0, 10.0),
    "pybullet.lateral_friction_rail": (0.005, 0.01, 0.02, 0.04, 0.08),
    "pybullet.lateral_friction_ball": (0.01, 0.02, 0.04, 0.08, 0.16),
    "pybullet.rolling_friction": (3e-5, 1e-4, 3e-4, 1e-3),
    "pybullet.spinning_friction": (3e-5, 1e-4, 3e-4, 1e-3),
    "pybullet.linear_damping": (0.02, 0.1, 0.4),
    "pybullet.angular_damping": (0.02, 0.1, 0.4),
    "dart.friction": (0.005, 0.01, 0.02, 0.04, 0.08),
}
_LEAST = 1e-6  # lower end of a logarithmic scale whose bound is 0; less friction than that moves no ball
_LOGARITHMIC = {"friction", "rolling_friction", "torsional_friction", "spinning_friction", "lateral_friction_rail",
                "lateral_friction_ball", "linear_damping", "angular_damping"}  # fmt: skip
# What a parameter needs beside it to act at all, or not to be taken for a failure of the engine.
_SLIDING = {"slip_limit": 10.0}
_BESIDE: dict[str, dict[str, Any]] = {
    "mujoco.friction": _SLIDING,
    "mujoco.rolling_friction": {**_SLIDING, "condim": 6, "torsional_friction": 1e-5},
    "mujoco.torsional_friction": {**_SLIDING, "condim": 4},
    "pybullet.lateral_friction_rail": _SLIDING,
    "pybullet.lateral_friction_ball": _SLIDING,
    "dart.friction": _SLIDING,
}
# MuJoCo removes a share of the slip per step, by default almost twice the slip, with which a ball slides as by
# Coulomb's law. With rolling friction that throws it off its rails: a low share is given as a rate, so that the ball
# creeps alike at any step [1/s].
_RELAXATION_RATE = {"mujoco.rolling_friction": 10.0, "mujoco.torsional_friction": 10.0}
DEFAULT_FREE: Mapping[str, tuple[str, ...]] = {
    "mujoco": ("friction", "rolling_friction", "solref_timeconst", "rolling_radius_m"),
    "pybullet": ("lateral_friction_rail", "rolling_friction", "linear_damping", "rolling_radius_m"),
    "dart": ("friction", "rolling_radius_m"),
}
"""What is tuned unless the user says otherwise."""
ON_FLAT_RAIL = {"rolling_radius_m": "inertia_kg_m2"}
"""On a plane the rolling radius is the ball's own; what remains open is how its mass is distributed."""


@dataclass(frozen=True)
class Free:
    """A parameter that may be tuned.

    Attributes:
        name: a setting of the engine, or a quantity of the rig under its key in rig.toml.
        unit: of its value.
        default: its value when it is not tuned; `None` where the engine derives it.
        low, high: bounds.
        logarithmic: whether it is fitted on a logarithmic scale.
        tried: values of the screening, from which fits begin as well.
        beside: settings of the engine that it needs beside it.
        quantity: attribute of `Rig`; empty for a setting of the engine.
    """

    name: str
    unit: str
    default: float | None
    low: float
    high: float
    logarithmic: bool
    tried: tuple[float, ...]
    beside: Mapping[str, Any] = field(default_factory=dict)
    quantity: str = ""

    def scaled(self, value: float) -> float:
        """The value on the scale of the fit [1]: its logarithm, or the value over the range."""
        return math.log(value) if self.logarithmic else value / (self.high - self.low)

    def value(self, scaled: float) -> float:
        """The value of a number on the scale of the fit, within the bounds."""
        value = math.exp(scaled) if self.logarithmic else scaled * (self.high - self.low)
        return min(max(value, self.low), self.high)

    @property
    def step(self) -> float:
        """Step of a difference quotient, on the scale of the fit."""
        return 0.02 if self.logarithmic else 2e-3


@dataclass(frozen=True)
class Named:
    """What `--free` says of one parameter: its name, and bounds in its unit where the user gives some."""

    name: str
    bounds: tuple[float, float] | None = None

    @classmethod
    def of(cls, text: str) -> Named:
        """Read `NAME` or `NAME=LOW:HIGH`.

        Raises:
            InputError: what stands after the `=` is no pair of numbers, the smaller one first.
        """
        name, given, ends = (part.strip() for part in text.partition("="))
        if not given:
            return cls(name)
        low, _, high = ends.partition(":")
        try:
            bounds = float(low), float(high)
        except ValueError:
            bounds = math.nan, math.nan
        if not (math.isfinite(bounds[0]) and math.isfinite(bounds[1]) and bounds[0] < bounds[1]):
            raise InputError(f"--free {text.strip()}: bounds are two numbers, the smaller one first: {name}=LOW:HIGH")
        return cls(name, bounds)


def level_of(rig: Rig, names: Sequence[str] | None = None) -> Free:
    """The level angle α₀ of this rig, within bounds if `names` give it some.

    Raises:
        InputError: these bounds cannot be used.
    """
    limit = math.radians(20.0)
    tried = (rig.level_angle - _LEVEL_TRIED, rig.level_angle + _LEVEL_TRIED)
    level = Free(LEVEL, "rad", rig.level_angle, -limit, limit, False, tried, quantity="level_angle")
    given = [one.bounds for one in map(Named.of, names or ()) if one.name == LEVEL and one.bounds]
    return _within(level, given[0]) if given else level


def free_of(engine: Engine, rig: Rig, settings: EngineParameters, names: Sequence[str] | None) -> tuple[Free, ...]:
    """The parameters with these names, beside the level angle.

    Args:
        engine: whose settings they are, or whose scene.
        rig: of the scene.
        settings: that the user has set; what is free is not among them.
        names: `NAME` or `NAME=LOW:HIGH` each; `None` for the default set.

    Raises:
        InputError: a name is none, stands there twice, is set as well, or is of a parameter that cannot be fitted; or
            its bounds reach beyond those of the engine or the scene.
    """
    flat = rig.rolling_radius >= rig.radius * (1.0 - 1e-9)
    if names is None:
        chosen = [ON_FLAT_RAIL.get(name, name) if flat else name for name in DEFAULT_FREE[engine.name]]
        chosen = [name for name in chosen if name not in settings.model_fields_set and _there(engine, name)]
        return tuple(_free(engine, rig, settings, name, flat) for name in chosen)
    given = [(one.name.removeprefix(f"{engine.name}."), one.bounds) for one in map(Named.of, names)]
    chosen = [name for name, _ in given]
    twice = [name for name in chosen if chosen.count(name) > 1]
    if twice:
        raise InputError(f"--free names {twice[0]} twice; name it once")
    made = ((_free(engine, rig, settings, name, flat), bounds) for name, bounds in given if name != LEVEL)
    return tuple(one if bounds is None else _within(one, bounds) for one, bounds in made)


def _within(one: Free, bounds: tuple[float, float]) -> Free:
    """The parameter within the user's bounds, with values to try among those between them."""
    low, high = bounds
    if low < one.low or high > one.high:
        raise InputError(
            f"--free {one.name}={low:g}:{high:g}: its bounds are {one.low:.4g} to {one.high:.4g} [{one.unit}]; "
            "give narrower ones"
        )
    tried = tuple(value for value in one.tried if low <= value <= high)
    narrowed = replace(one, low=low, high=high)
    ends = narrowed.scaled(low), narrowed.scaled(high)
    spread = (narrowed.value(ends[0] + share * (ends[1] - ends[0])) for share in _SHARES)
    return replace(narrowed, tried=tried or tuple(value for value in spread if value != one.default))


def _free(engine: Engine, rig: Rig, settings: EngineParameters, name: str, flat: bool) -> Free:
    fields = engine.parameters.model_fields
    if name in _SCENE:
        if engine.scene_file:
            raise InputError(f"--free {name}: it is fixed in {engine.scene_file}; change it there")
        if flat and name in ON_FLAT_RAIL:
            raise InputError(f"--free {name}: on a flat track it is the ball's radius; free {ON_FLAT_RAIL[name]}")
        return _of_scene(rig, name)
    if name not in fields:
        known = [one for one, info in fields.items() if _number(info)]
        hint = did_you_mean(name, (*known, *_SCENE, LEVEL))
        raise InputError(
            f"--free {name}: no parameter of {engine.name} or its scene that can be fitted has this name.{hint} "
            f"Parameters are: {', '.join(known)}. Quantities of the scene are: {', '.join((*_SCENE, LEVEL))}."
        )
    if name in settings.model_fields_set:
        raise InputError(f"--free {name}: it is set to {getattr(settings, name)} as well; set it or free it")
    if not _number(fields[name]) or name in ("time_step", "slip_limit", "health_interval"):
        raise InputError(f"--free {name}: this is a choice of the method, not a number to be fitted; use --set")
    return _of_engine(engine, settings, name, fields[name])


def _there(engine: Engine, name: str) -> bool:
    """Whether an engine has a parameter of its default set: a user's scene has fewer, and none of the built-in one."""
    return name in engine.parameters.model_fields or (name in _SCENE and not engine.scene_file)


def _of_scene(rig: Rig, name: str) -> Free:
    quantity, factors = _SCENE[name]
    value = float(getattr(rig, quantity))
    if value == 0.0:
        raise InputError(f"--free {name}: it is 0 in this rig, from which no scale follows; give a value in rig.toml")
    high = _REACH * abs(value)
    if quantity == "rolling_radius":  # no ball's centre lies higher above the edges than one radius
        high, factors = rig.radius, (*factors, min(1.03, rig.radius / value))
    low = abs(value) / _REACH
    low, high = (low, high) if value > 0.0 else (-high, -low)
    tried = tuple(value * factor for factor in factors if factor != 1.0)
    return Free(name, UNITS[quantity], value, low, high, value > 0.0, tried, quantity=quantity)


def _of_engine(engine: Engine, settings: EngineParameters, name: str, info: FieldInfo) -> Free:
    key = f"{engine.name}.{name}"
    low, high = _bounds(key, info)
    if name == "solref_timeconst":
        low = 2.0 * settings.time_step  # MuJoCo would take it for shorter ones
    logarithmic = name in _LOGARITHMIC or (low > 0.0 and math.log10(high / low) > _DECADES)
    low = max(low, _LEAST) if logarithmic else low
    if key in ("mujoco.rolling_friction", "mujoco.torsional_friction"):
        low = max(low, 1e-5)  # smaller ones are raised to this
    ends = (math.log(low), math.log(high)) if logarithmic else (low, high)
    spread = [ends[0] + share * (ends[1] - ends[0]) for share in _SHARES]
    tried = _TRIED.get(key, tuple(math.exp(one) for one in spread) if logarithmic else tuple(spread))
    default = getattr(settings, name)
    kept = tuple(value for value in tried if low <= value <= high and value != default)
    beside = dict(_BESIDE.get(key, {}))
    if key in _RELAXATION_RATE:
        beside["friction_relaxation"] = _RELAXATION_RATE[key] * settings.time_step
    beside = {one: value for one, value in beside.items() if one in engine.parameters.model_fields}
    return Free(name, engine.parameters.unit_of(name), default, low, high, logarithmic, kept, beside)


def _number(info: FieldInfo) -> bool:
    """Whether a field is a real number, possibly none."""
    kinds = get_args(info.annotation) or (info.annotation,)
    return float in kinds


def _bounds(key: str, info: FieldInfo) -> tuple[float, float]:
    """Bounds of a field, as its validation states them."""
    ends = {
        name: getattr(one, name) for one in info.metadata for name in ("gt", "ge", "lt", "le") if hasattr(one, name)
    }
    low, high = ends.get("ge", ends.get("gt")), ends.get("le", ends.get("lt"))
    if low is None or high is None:
        raise InputError(f"--free {key}: it has no bounds, so that no fit of it can be kept within any")
    span = high - low
    low = low + 1e-6 * span if "gt" in ends else low
    return float(low), float(high - 1e-6 * span if "lt" in ends else high)
