"""Factors: what one key of `sweep.toml` sets or varies, checked against the engine, the rig and the catalogue."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
from pydantic import ValidationError

from analytic.effects import CATALOGUE
from analytic.motion import FloatArray
from analytic.naming import did_you_mean
from analytic.rig import Rig, RigError
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.parameters import EngineParameters
from harness.errors import InputError
from harness.recording.rig_file import TABLES
from harness.sweeps.ranges import Range, Value

CAM_SOURCE = "cam"
TIME_STEP, RIG, EFFECTS = "time_step", "rig", "effects"
RIG_KEYS = {
    field.alias or name: name
    for table in ("ball", "beam", "environment")
    for name, field in TABLES[table].model_fields.items()
    if name != "length"
}
"""Quantities of a rig by the keys of `rig.toml`."""


@dataclass(frozen=True)
class Factor:
    """One quantity that a sweep sets or varies.

    Attributes:
        name: column of the results, as in `time_step`, `mujoco.friction`, `rig.mass_kg`,
            `effects.rolling_resistance.coefficient`.
        values: that are crossed with those of all other factors; a single one is set in every run.
        range: that is sampled instead; then there are no values.
    """

    name: str
    values: tuple[Value, ...] = ()
    range: Range | None = None

    @property
    def unit(self) -> str:
        """Its unit, "1" for a number; empty where it is part of the name, as in `rig.mass_kg`."""
        table, _, key = self.name.partition(".")
        if table == RIG:
            return ""
        if table == EFFECTS:
            effect, _, parameter = key.partition(".")
            return next(one.unit for one in CATALOGUE[effect].parameters if one.name == parameter)
        return engine_of(table).parameters.unit_of(key) if key else EngineParameters.unit_of(TIME_STEP)

    @property
    def varied(self) -> bool:
        """Whether runs differ in it."""
        return self.range is not None or len(self.values) > 1

    @property
    def extremes(self) -> tuple[Value, ...]:
        """Values that are to be possible for all to be."""
        return self.values if self.range is None else (self.range.low, self.range.high)

    @property
    def levels(self) -> tuple[Value, ...]:
        """The values of a grid."""
        if self.range is None:
            return self.values
        return tuple(self.at(np.linspace(0.0, 1.0, self.range.levels or 2)).tolist())

    def at(self, share: FloatArray) -> FloatArray:
        """Values at shares 0 … 1 of the range, same shape; both ends exact."""
        if self.range is None:
            raise ValueError(f"{self.name} has no range")
        low, high = self.range.low, self.range.high
        if self.range.scale == "log":
            inside = np.exp(np.log(low) + share * (np.log(high) - np.log(low)))
        else:
            inside = low + share * (high - low)
        return np.where(share == 0.0, low, np.where(share == 1.0, high, inside))


def factors_of(
    path: Path,
    source: str,
    time_step: Any,
    settings: Mapping[str, Any],
    rig: Mapping[str, Any],
    effects: Mapping[str, Mapping[str, Any]],
) -> tuple[Factor, ...]:
    """All factors of one source.

    Args:
        path: of the spec, for messages.
        source: a model or an engine.
        time_step: of all engines.
        settings: the engine's own table.
        rig, effects: tables of these names.

    Raises:
        InputError: an unknown name, or a value that cannot be.
    """
    made = []
    if source != CAM_SOURCE:
        engine = engine_of(source)
        own = {TIME_STEP: engine.parameters().time_step if time_step is None else time_step, **settings}
        for key, varied in own.items():
            factor = _factor(path, TIME_STEP if key == TIME_STEP else f"{source}.{key}", varied)
            _check_setting(path, engine, key, factor)
            made.append(factor)
    for key, varied in rig.items():
        if key not in RIG_KEYS:
            raise InputError(
                f"{path}: [rig] {key} is unknown.{did_you_mean(key, RIG_KEYS)} Keys are {', '.join(RIG_KEYS)}."
            )
        made.append(_of_rig(path, key, varied))
    for name, parameters in effects.items():
        if name not in CATALOGUE:
            hint = did_you_mean(name, CATALOGUE)
            raise InputError(f"{path}: [effects.{name}]: no such effect.{hint} There are {', '.join(CATALOGUE)}.")
        made += _effect(path, name, parameters)
    return tuple(made)


def _factor(path: Path, name: str, varied: Any) -> Factor:
    if isinstance(varied, Range):
        return Factor(name, range=varied)
    if not isinstance(varied, list):
        return Factor(name, (varied,))
    if not varied:
        raise InputError(f"{path}: {name} is an empty list; give values, or leave it out.")
    if len(set(varied)) < len(varied):
        raise InputError(f"{path}: {name} lists a value twice; list each once.")
    if len({isinstance(one, str) for one in varied}) > 1:
        raise InputError(f"{path}: {name} mixes text and numbers; give one of them.")
    return Factor(name, tuple(varied))


def _numbers(path: Path, factor: Factor) -> Factor:
    for value in factor.extremes:
        if isinstance(value, bool | str):
            raise InputError(f"{path}: {factor.name} = {value!r} is not a number.")
    return factor


def _of_rig(path: Path, key: str, varied: Any) -> Factor:
    """Refuse what no rig could have; what only some combinations cannot have fails in these runs, by name."""
    factor = _numbers(path, _factor(path, f"{RIG}.{key}", varied))
    (table,) = (one for one in TABLES.values() if RIG_KEYS[key] in one.model_fields)
    for value in factor.extremes:
        try:
            table.model_validate({key: float(value)})
        except ValidationError as error:
            raise InputError(f"{path}: {factor.name} = {value!r}: {error.errors()[0]['msg']}.") from None
        if RIG_KEYS[key] == "level_angle":
            try:
                Rig(level_angle=float(value))
            except RigError as error:
                raise InputError(f"{path}: {factor.name} = {value!r}: {error}.") from None
    return factor


def _check_setting(path: Path, engine: Any, key: str, factor: Factor) -> None:
    """Refuse what no run could have; what only some combinations cannot have fails in these runs, by name."""
    fields = engine.parameters.model_fields
    if key not in fields:
        try:
            parameters_of(engine, {key: 0.0})
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
    types = get_args(fields[key].annotation) or (fields[key].annotation,)
    if factor.range is not None and float not in types:
        raise InputError(f"{path}: {factor.name} takes single values, not a range; list them, as in {key} = [1, 2].")
    for value in factor.extremes:
        try:
            engine.parameters(**{key: value})
        except ValidationError as error:
            own = [one for one in error.errors() if one["loc"] and one["loc"][0] == key]
            if own:
                raise InputError(f"{path}: {factor.name} = {value!r}: {own[0]['msg']}.") from None


def _effect(path: Path, name: str, parameters: Mapping[str, Any]) -> list[Factor]:
    effect = CATALOGUE[name]
    needed = {one.name: one for one in effect.parameters}
    if effect.by_recording is not None:
        raise InputError(f"{path}: [effects.{name}]: has a value of its own in each recording and cannot be swept.")
    for key in parameters:
        if key not in needed:
            hint = did_you_mean(key, needed)
            raise InputError(f"{path}: [effects.{name}] {key} is unknown.{hint} It has {', '.join(needed)}.")
    absent = [key for key in needed if key not in parameters]
    if absent:
        raise InputError(f"{path}: [effects.{name}] {absent[0]} is missing; give a value, a list or a range.")
    made = [_numbers(path, _factor(path, f"{EFFECTS}.{name}.{key}", varied)) for key, varied in parameters.items()]
    for key, factor in zip(parameters, made, strict=True):
        low, high = needed[key].low, needed[key].high
        for value in factor.extremes:
            if not low <= float(value) <= high:
                raise InputError(
                    f"{path}: {factor.name} = {value:g} must lie between {low:g} and {high:g} {needed[key].unit}."
                )
    return made
