"""What is exported: the rig, the effects with named constants and intervals, the spline term, the sensor."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.effects import CATALOGUE, Acting, SensorLaw, rig_with, sensor_with
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.errors import InputError
from harness.identify.model_file import read_terms
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.record import DiagnosisRecord
from harness.numerics import TWO_SIDED

LONGEST_STEP = 1e-2  # of the integration in exported code, that of `harness predict` [s]


@dataclass(frozen=True)
class Constant:
    """A named number of exported code.

    Attributes:
        name: in capitals, unique in a model.
        value, unit: as in results.
        low, high: 95 % interval; `None` for what was not estimated.
        meaning: one line.
    """

    name: str
    value: float
    unit: str
    meaning: str
    low: float | None = None
    high: float | None = None

    @property
    def told(self) -> str:
        """Unit, interval and meaning in one line."""
        interval = "" if self.low is None or self.high is None else f", 95 % interval {self.low:.6g} to {self.high:.6g}"
        return f"[{self.unit}] {self.meaning}{interval}"


@dataclass(frozen=True)
class Exported:
    """An effect of the model, with the constant of each of its parameters in their order."""

    acting: Acting
    constants: tuple[Constant, ...]
    found: bool

    @property
    def names(self) -> dict[str, str]:
        """Name of the constant, by parameter."""
        return {one.name: c.name for one, c in zip(self.acting.effect.parameters, self.constants, strict=True)}


@dataclass(frozen=True)
class ExportModel:
    """An identified model.

    Attributes:
        origin: the file that it comes from.
        sentence: the verdict in words.
        declared_rig: the rig before effects altered it.
        effects: the declared ones, then those found.
        spline: a law that no catalogue lists, with its values.
        theta, covariance: of the parameters found, in their units, shape (k,) and (k, k).
        keys: (number of the effect in `effects`, parameter) of the first of `theta`; what follows are own values of the
            recordings, and nodes.
        visited: lowest and highest position of the recordings that the diagnosis tells, but for outliers [m]; `None`
            if it tells none.
    """

    origin: str
    sentence: str
    declared_rig: Rig
    effects: tuple[Exported, ...]
    spline: SplineTerm | None
    theta: FloatArray
    covariance: FloatArray
    keys: tuple[tuple[int, str], ...]
    visited: tuple[float, float] | None = None

    @cached_property
    def acting(self) -> tuple[Acting, ...]:
        """The effects with their values."""
        return tuple(one.acting for one in self.effects)

    @cached_property
    def rig(self) -> Rig:
        """The rig as it is with the effects."""
        return rig_with(self.declared_rig, self.acting)

    @cached_property
    def sensor(self) -> SensorLaw:
        """The position sensor."""
        return self.sensor_of(self.acting)

    def sensor_of(self, effects: Sequence[Acting]) -> SensorLaw:
        """The position sensor, with these values of the effects."""
        law = sensor_with(effects)
        return law if self.spline is None or not self.spline.sensor else replace(law, error=self.spline)

    @property
    def turning(self) -> bool:
        """Whether a law depends on how the ball lies at the start."""
        return any(one.effect.turning for one in self.acting) or (self.spline is not None and self.spline.turning)

    def with_theta(self, theta: FloatArray) -> tuple[Acting, ...]:
        """The effects with other values of the parameters found, shape (k,), in their units."""
        values: list[dict[str, float]] = [dict(one.acting.values) for one in self.effects]
        for (number, name), value in zip(self.keys, theta, strict=False):
            values[number][name] = float(value)
        return tuple(Acting(one.acting.effect, each) for one, each in zip(self.effects, values, strict=True))


def export_model(record: DiagnosisRecord, origin: str) -> ExportModel:
    """The model of a diagnosis.

    Args:
        record: the diagnosis.
        origin: its file, for messages.

    Raises:
        InputError: its content is not what this version writes, or an effect is not in the catalogue.
    """
    problem, found = read_terms(record.model, origin)
    covariance = found.covariance
    hypothesis, terms = found.hypothesis, found.terms
    theta = found.theta * hypothesis.scale(problem)
    count = len(problem.declared)
    shared = hypothesis.parameters
    keys = tuple((count + hypothesis.names.index(effect), name) for effect, name in shared)
    told = {one.name: one.parameters for one in record.effects}
    reach = {
        key: TWO_SIDED * math.sqrt(max(covariance[i, i], 0.0)) if math.isfinite(covariance[i, i]) else None
        for i, key in enumerate(keys)
    }
    taken: set[str] = set()
    effects = []
    for number, one in enumerate((*problem.declared, *terms.effects)):
        intervals: dict[str, tuple[float | None, float | None]] = {}
        for name, value in one.values.items():
            half = reach.get((number, name))
            if number >= count and name in told.get(one.effect.name, {}):
                intervals[name] = told[one.effect.name][name].interval
            elif half is not None:
                intervals[name] = value - half, value + half
        effects.append(_exported(one, intervals, taken, found=number >= count))
    visited = _visited(record, terms.spline)
    return ExportModel(
        origin, record.sentence, problem.rig, tuple(effects), terms.spline, theta, covariance, keys, visited
    )


def _visited(record: DiagnosisRecord, spline: SplineTerm | None) -> tuple[float, float] | None:
    """Range of the recorded positions [m]; in an older diagnosis, of a proposed experiment and of a law over it."""
    if record.model.visited_m is not None:
        return record.model.visited_m
    known = [] if record.next_experiment is None else [record.next_experiment.limits.ball_position_m]
    if spline is not None and spline.depends is Regressor.POSITION and not spline.closed:
        known.append((float(spline.places[0]), float(spline.places[-1])))
    return (min(low for low, _ in known), max(high for _, high in known)) if known else None


def of_effects(rig: Rig, effects: Sequence[Acting], spline: SplineTerm | None = None) -> ExportModel:
    """A model that was not identified: the rig with these effects, without intervals."""
    taken: set[str] = set()
    kept = tuple(_exported(one, {}, taken, found=False) for one in effects)
    return ExportModel("", "", rig, kept, spline, np.zeros(0), np.zeros((0, 0)), ())


def _exported(
    one: Acting, intervals: Mapping[str, tuple[float | None, float | None]], taken: set[str], *, found: bool
) -> Exported:
    """An effect with unique names of its constants, which join `taken`."""
    constants, values = [], dict(one.values)
    own = one.effect.by_recording
    for parameter in one.effect.parameters:
        base = name = f"{one.effect.name}_{parameter.name}".upper()
        if own is not None:
            base = name = f"{one.effect.name}_here".upper()
        number = 1
        while name in taken:
            number += 1
            name = f"{base}_{number}"
        taken.add(name)
        value, meaning = one.values[parameter.name], one.effect.law
        low, high = intervals.get(parameter.name, (None, None))
        if own is not None:  # each recording has its own, and of the next one nothing is known but the spread
            meaning = f"{meaning} (0 for a recording of which nothing is known; standard deviation {value:.6g})"
            value, low, high = 0.0, None, None
            values[parameter.name] = 0.0
        constants.append(Constant(name, value, parameter.unit, meaning, low, high))
    return Exported(Acting(one.effect, values), tuple(constants), found)


def refuse_own_effects(model: ExportModel, what: str) -> None:
    """Refuse a model with effects that cannot be written as source code.

    Args:
        what: the format, for the message.

    Raises:
        InputError: there is one.
    """
    for one in model.acting:
        if one.effect.name not in CATALOGUE or not one.effect.exportable:
            raise InputError(
                f"{model.origin}: the effect {one.effect.name} is a law in Python of the user's own, which cannot be "
                f"written as {what}; diagnose without it, or predict with `harness predict --effects`"
            )
