"""A hypothesis: which effects act beside those declared, as a vector of numbers that can be fitted."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.effects import CATALOGUE, Acting, Effect, Parameter
from analytic.models import NODES
from analytic.motion import FloatArray
from harness.identify.problem import Problem
from harness.identify.shape import Shape

IMBALANCE = "ball_imbalance"


@dataclass(frozen=True)
class Values:
    """A hypothesis with numbers: effects, φ₀ of each recording [rad], and the curve."""

    effects: tuple[Acting, ...]
    phases: FloatArray
    shape: Shape | None


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, in the order in which they were found, and possibly a curve of unknown law.

    Numbers are scaled by each parameter's typical size. After the effects' come the angles φ₀ of a ball out of
    balance, one a recording, then the nodes of the curve.
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

    def _tail(self, problem: Problem) -> tuple[int, int]:
        """How many phases and how many nodes of a curve."""
        return len(problem.records) if IMBALANCE in self.names else 0, NODES if self.shape else 0

    def size(self, problem: Problem) -> int:
        """How many numbers are fitted."""
        return len(self._each) + sum(self._tail(problem))

    def scale(self, problem: Problem) -> FloatArray:
        """What one unit of each number is worth."""
        phases, nodes = self._tail(problem)
        node = 0.0 if self.shape is None else 0.003 if self.shape.friction else 0.03
        return np.array([abs(one.typical) for one in self._each] + [1.0] * phases + [node] * nodes)

    def bounds(self, problem: Problem) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest scaled numbers."""
        free = sum(self._tail(problem))
        low = np.array([one.low for one in self._each] + [-np.inf] * free)
        high = np.array([one.high for one in self._each] + [np.inf] * free)
        for at, (_, name) in enumerate(self.parameters):
            if (
                name == "radius"
            ):  # a ball cannot roll on more than its radius, nor deep in a groove that it falls through
                low[at], high[at] = 0.2 * problem.rig.radius, problem.rig.radius
        scale = self.scale(problem)
        return low / scale, high / scale

    def read(self, numbers: FloatArray, problem: Problem) -> Values:
        """The effects with their values, the phases of the recordings and the curve."""
        values = numbers * self.scale(problem)
        acting, at = [], 0
        for effect in self.effects:
            each = {p.name: float(values[at + i]) for i, p in enumerate(effect.parameters)}
            acting.append(Acting(effect, each))
            at += len(effect.parameters)
        phases = values[at : at + len(problem.records)] if IMBALANCE in self.names else np.zeros(len(problem.records))
        shape = replace(self.shape, nodes=values[-NODES:]) if self.shape else None
        return Values(tuple(acting), phases, shape)

    def starts(self, problem: Problem, known: Mapping[tuple[str, str], float]) -> Iterator[FloatArray]:
        """Where fits begin: from `known` values where there are any, else from the few places each law needs."""
        choices = []
        for effect in self.effects:
            keys = [(effect.name, parameter.name) for parameter in effect.parameters]
            if all(key in known for key in keys):
                choices.append([[known[key] for key in keys]])
            else:
                choices.append(_starts(effect, problem))
        rest = [0.0] * self._tail(problem)[0]
        rest += list(self.shape.nodes) if self.shape else []
        for one in itertools.product(*choices):
            yield np.array([value for each in one for value in each] + rest) / self.scale(problem)


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
            return [[0.005, float(middle)]]
        case "track_bump":
            width = 0.1 * (high - low)
            return [[sign * 1e-4, float(c), float(width)] for c in np.linspace(low, high, 7) for sign in (1.0, -1.0)]
        case "ball_imbalance":
            return [[2e-5]]
        case "rolling_radius":
            return [[rig.rolling_radius]]
        case "eccentric_pivot":
            return [[rig.eccentricity]]
        case "contact_slip":
            return [[0.015], [0.03]]
        case "angle_gain" | "position_gain":
            return [[1.0]]
        case "linkage_backlash":
            return [[0.002], [0.008]]
        case "position_lag":
            return [[0.01]]
        case _:
            return [[0.0] * len(effect.parameters)]
