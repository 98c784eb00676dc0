"""A hypothesis: which effects act beside those declared, as a vector of numbers that can be fitted."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.effects import CATALOGUE, Acting, Effect, Parameter
from analytic.motion import FloatArray
from analytic.rig import Rig
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Shape

IMBALANCE, BUMP = "ball_imbalance", "track_bump"
_PHASES = 8  # tried around a turn: no further than 22° from the likeliest


# Parameters with which an effect vanishes.
_SIZES = {
    ("viscous_damping", "coefficient"),
    ("quadratic_drag", "coefficient"),
    ("rolling_resistance", "coefficient"),
    ("directional_resistance", "coefficient_plus"),
    ("directional_resistance", "coefficient_minus"),
    ("stribeck_friction", "static_coefficient"),
    ("stribeck_friction", "kinetic_coefficient"),
    ("presliding_hysteresis", "coefficient"),
    ("track_curvature", "curvature"),
    ("track_bump", "height"),
    ("ball_imbalance", "offset"),
    ("linkage_backlash", "width"),
    ("position_lag", "time_constant"),
}


_WIDEST = 0.1  # bump [m]
# Typical sizes by which neighbouring nodes of a curve differ, standard deviation: of a force, and of a friction, which
# begins at an edge where a surface does.
_UNEVEN = {False: 1.0, True: 3.0}
_STARTS = 3  # that are looked at: of many places, the likeliest
_PLACE = 0.03  # how well a place along the beam can be guessed [m]
_FACTOR_OFF = 0.05  # how far a factor or a radius is typically off, relative to what it should be [1]


def neutral(key: tuple[str, str], rig: Rig) -> float:
    """Value of an (effect, parameter) at which the effect does nothing, in the parameter's unit."""
    return 1.0 if key[1] == "gain" else rig.rolling_radius if key[0] == "rolling_radius" else 0.0


def size(key: tuple[str, str], parameter: Parameter, rig: Rig) -> float:
    """How far a parameter typically is from doing nothing, in its unit."""
    nothing = neutral(key, rig)
    if key[1] == "centre":
        return _PLACE
    return _FACTOR_OFF * nothing if nothing else abs(parameter.typical)


def phase_of(record: str) -> tuple[str, str]:
    """Key of φ₀ of a recording among known values."""
    return IMBALANCE, f"phase of {record}"


@dataclass(frozen=True)
class Values:
    """A hypothesis with numbers: effects, φ₀ of each recording [rad], and the curve."""

    records: tuple[str, ...]
    effects: tuple[Acting, ...]
    phases: FloatArray
    shape: Shape | None


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, in the order in which they were found, and possibly a curve of unknown law.

    Numbers are scaled by each parameter's typical size. After the effects' come the angles φ₀ at which the
    ball lies at the start, one a recording, where they matter, then the nodes of the curve.
    """

    names: tuple[str, ...]
    shape: Shape | None = None

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The catalogue's entries."""
        return tuple(CATALOGUE[name] for name in self.names)

    @cached_property
    def parameters(self) -> list[tuple[str, str]]:
        """(effect, parameter) of every number but the phases."""
        return [(effect.name, parameter.name) for effect in self.effects for parameter in effect.parameters]

    @cached_property
    def _each(self) -> list[Parameter]:
        return [parameter for effect in self.effects for parameter in effect.parameters]

    @property
    def turning(self) -> bool:
        """Whether it matters how the ball lies at the start of each recording."""
        return IMBALANCE in self.names or (self.shape is not None and self.shape.turning)

    def _tail(self, problem: Problem) -> tuple[int, int]:
        """How many phases and how many nodes of a curve."""
        return len(problem.records) if self.turning else 0, len(self.shape.nodes) if self.shape else 0

    def size(self, problem: Problem) -> int:
        """How many numbers are fitted."""
        return len(self._each) + sum(self._tail(problem))

    def scale(self, problem: Problem) -> FloatArray:
        """What one unit of each number is worth."""
        phases, nodes = self._tail(problem)
        node = 0.0 if self.shape is None else 0.003 if self.shape.friction else 0.03
        sizes = [size(key, one, problem.rig) for key, one in zip(self.parameters, self._each, strict=True)]
        return np.array(sizes + [1.0] * phases + [node] * nodes)

    def bounds(self, problem: Problem) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest scaled numbers."""
        free = sum(self._tail(problem))
        low = np.array([one.low for one in self._each] + [-np.inf] * free)
        high = np.array([one.high for one in self._each] + [np.inf] * free)
        for at, key in enumerate(self.parameters):
            # A ball cannot roll on more than its radius, nor deep in a groove that it falls through.
            if key == ("rolling_radius", "radius"):
                low[at], high[at] = 0.2 * problem.rig.radius, problem.rig.radius
            # A bump where the ball has not been, or as wide as the track, is any curve at all.
            elif key == (BUMP, "centre"):
                readings = [one.reading[np.isfinite(one.reading)] for one in problem.records]
                first, last = np.percentile(np.concatenate(readings), [0.5, 99.5])
                low[at], high[at] = first - _WIDEST, last + _WIDEST
            elif key == (BUMP, "width"):
                high[at] = _WIDEST
        scale = self.scale(problem)
        return low / scale, high / scale

    def evenness(self, problem: Problem) -> FloatArray:
        """What neighbouring nodes of the curve differ by, in what they typically do, as a matrix on the scaled numbers.

        Where hardly a reading falls nodes would be anything at all; so they follow their neighbours, as the curve keeps
        its last value beyond the last node. Shape (r, k), r = 0 without a curve.
        """
        if self.shape is None:
            return np.zeros((0, self.size(problem)))
        count = len(self.shape.nodes)
        steps = np.roll(np.eye(count), 1, axis=1) - np.eye(count)
        steps = steps if self.shape.turning else steps[:-1]
        return np.hstack((np.zeros((len(steps), self.size(problem) - count)), steps / _UNEVEN[self.shape.friction]))

    def read(self, numbers: FloatArray, problem: Problem) -> Values:
        """The effects with their values, the phases of the recordings and the curve."""
        values = numbers * self.scale(problem)
        acting, at = [], 0
        for effect in self.effects:
            each = {p.name: float(values[at + i]) for i, p in enumerate(effect.parameters)}
            acting.append(Acting(effect, each))
            at += len(effect.parameters)
        phases = values[at : at + len(problem.records)] if self.turning else np.zeros(len(problem.records))
        shape = replace(self.shape, nodes=values[-len(self.shape.nodes) :]) if self.shape else None
        return Values(tuple(record.name for record in problem.records), tuple(acting), phases, shape)

    def starts(self, problem: Problem, known: Mapping[tuple[str, str], float], density: float) -> list[FloatArray]:
        """Where fits begin: from `known` values where there are any, else from the few places each law needs.

        Args:
            density: of the process noise with which phases and places are looked for [m²/s³].
        """
        choices = []
        for effect in self.effects:
            keys = [(effect.name, parameter.name) for parameter in effect.parameters]
            if all(key in known for key in keys):
                choices.append([[known[key] for key in keys]])
            else:
                choices.append(_starts(effect, problem))
        nodes = list(self.shape.nodes) if self.shape else []
        starts = []
        for one in itertools.product(*choices):
            values = [value for each in one for value in each]
            numbers = np.array([*values, *[0.0] * self._tail(problem)[0], *nodes]) / self.scale(problem)
            starts.append(self._phased(numbers, problem, known, density))
        if len(starts) <= _STARTS:
            return starts

        def deviance(numbers: FloatArray) -> float:
            at = self.read(numbers, problem)
            return problem.deviance(at.effects, at.phases, density, at.shape)

        return sorted(starts, key=deviance)[:_STARTS]

    def weaker(self, numbers: FloatArray, factor: float, known: Mapping[tuple[str, str], float]) -> FloatArray:
        """`numbers` with the effects that are not `known` at `factor` of their size."""
        # Of an effect of the user's own, the first parameter is the strength.
        sizes = _SIZES | {(one.name, one.parameters[0].name) for one in self.effects if one.force is not None}
        factors = [factor if key in sizes and key not in known else 1.0 for key in self.parameters]
        return numbers * np.array(factors + [1.0] * (len(numbers) - len(factors)))

    def _phased(
        self, numbers: FloatArray, problem: Problem, known: Mapping[tuple[str, str], float], density: float
    ) -> FloatArray:
        """`numbers` with the phases that are known or, one recording at a time, the likeliest of a few."""
        at = self.read(numbers, problem)
        for n, record in enumerate(problem.records[: self._tail(problem)[0]]):
            phase = known.get(phase_of(record.name))
            if phase is None:
                phase = min(
                    2.0 * np.pi / _PHASES * np.arange(_PHASES),
                    key=lambda x, r=record: problem.deviance_of(r, at.effects, x, density, at.shape),  # type: ignore[misc]
                )
            numbers[len(self._each) + n] = phase
        return numbers


def _starts(effect: Effect, problem: Problem) -> list[list[float]]:
    """Start values of one effect: at no effect where the law is smooth there, else at sizes that are felt."""
    readings = np.concatenate([record.reading[np.isfinite(record.reading)] for record in problem.records])
    low, middle, high = np.percentile(readings, [2, 50, 98])
    rig = problem.rig
    match effect.name:
        case "stribeck_friction":
            return [[0.004, 0.002, 0.01], [0.004, 0.002, 0.05]]
        case "rolling_resistance" | "viscous_damping" | "quadratic_drag":
            return [[0.3 * effect.parameters[0].typical]]
        case "directional_resistance":
            return [[0.001, 0.001]]
        case "presliding_hysteresis":
            return [[0.002, 10.0], [0.002, 100.0], [0.002, 1000.0]]
        case "track_curvature":
            return [[curvature, float(middle)] for curvature in (0.005, -0.02, 0.02)]
        case "track_bump":
            heights, widths = (1e-4, -1e-4), (0.015, 0.04)
            return [[h, float(c), w] for c in np.linspace(low, high, 13) for h in heights for w in widths]
        case "ball_imbalance":
            return [[2e-5]]
        case "eccentric_pivot":
            return [[rig.eccentricity]]
        case "contact_slip":
            return [[0.004], [0.008], [0.015], [0.03]]
        case "linkage_backlash":
            return [[0.002], [0.008]]
        case "position_lag":
            return [[0.01]]
        case _:
            nothing = [neutral((effect.name, one.name), rig) for one in effect.parameters]
            starts = [one.starts or (at or one.typical,) for one, at in zip(effect.parameters, nothing, strict=True)]
            return [list(one) for one in itertools.product(*starts)]
