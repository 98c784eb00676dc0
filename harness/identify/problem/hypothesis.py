"""A hypothesis: which effects act beside those declared, as a vector of numbers that can be fitted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.effects import CATALOGUE, Acting, Effect, Parameter
from analytic.motion import FloatArray
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import SplineTerm

# Typical sizes by which neighbouring nodes of a curve differ, standard deviation: of a force, and of a friction, which
# begins at an edge where a surface does.
_UNEVEN = {False: 1.0, True: 3.0}


def phase_key(recording: str) -> tuple[str, str]:
    """Key of φ₀ of a recording among known values."""
    return "", f"phase of {recording}"


@dataclass(frozen=True)
class Terms:
    """A hypothesis with numbers: effects, φ₀ of each recording [rad], and the curve."""

    recordings: tuple[str, ...]
    effects: tuple[Acting, ...]
    phases: FloatArray
    spline: SplineTerm | None

    def phase_of(self, recording: str) -> float:
        """φ₀ of a recording by name [rad]; 0 of one that these values are not of."""
        return float(self.phases[self.recordings.index(recording)]) if recording in self.recordings else 0.0


NOTHING = Terms((), (), np.zeros(0), None)


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, in the order in which they were found, and possibly a curve of unknown law.

    Numbers are scaled by each parameter's typical size. After the effects' come the angles φ₀ at which the
    ball lies at the start, one a recording, where they matter, then the nodes of the curve.
    """

    names: tuple[str, ...]
    spline: SplineTerm | None = None

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
        return any(one.turning for one in self.effects) or (self.spline is not None and self.spline.turning)

    def tail(self, problem: Problem) -> tuple[int, int]:
        """How many phases and how many nodes of a curve."""
        return len(problem.recordings) if self.turning else 0, len(self.spline.nodes) if self.spline else 0

    def size(self, problem: Problem) -> int:
        """How many numbers are fitted."""
        return len(self._each) + sum(self.tail(problem))

    def scale(self, problem: Problem) -> FloatArray:
        """What one unit of each number is worth."""
        phases, nodes = self.tail(problem)
        node = 0.0 if self.spline is None else 0.003 if self.spline.friction else 0.03
        sizes = [one.size(problem.rig) for one in self._each]
        return np.array(sizes + [1.0] * phases + [node] * nodes)

    def bounds(self, problem: Problem) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest scaled numbers."""
        free = sum(self.tail(problem))
        limits = [one.bounds_on(problem.visited, problem.rig) for one in self._each]
        low, high = np.array([*limits, *[(-np.inf, np.inf)] * free]).reshape(-1, 2).T
        scale = self.scale(problem)
        return low / scale, high / scale

    def smoothness(self, problem: Problem) -> FloatArray:
        """What neighbouring nodes of the curve differ by, in what they typically do, as a matrix on the scaled numbers.

        Where hardly a reading falls nodes would be anything at all; so they follow their neighbours, as the curve keeps
        its last value beyond the last node. Shape (r, k), r = 0 without a curve.
        """
        if self.spline is None:
            return np.zeros((0, self.size(problem)))
        count = len(self.spline.nodes)
        steps = np.roll(np.eye(count), 1, axis=1) - np.eye(count)
        steps = steps if self.spline.turning else steps[:-1]
        return np.hstack((np.zeros((len(steps), self.size(problem) - count)), steps / _UNEVEN[self.spline.friction]))

    def terms(self, theta: FloatArray, problem: Problem) -> Terms:
        """The effects with their values, the phases of the recordings and the curve."""
        values = theta * self.scale(problem)
        acting, at = [], 0
        for effect in self.effects:
            each = {p.name: float(values[at + i]) for i, p in enumerate(effect.parameters)}
            acting.append(Acting(effect, each))
            at += len(effect.parameters)
        phases = values[at : at + len(problem.recordings)] if self.turning else np.zeros(len(problem.recordings))
        spline = replace(self.spline, nodes=values[-len(self.spline.nodes) :]) if self.spline else None
        return Terms(tuple(recording.name for recording in problem.recordings), tuple(acting), phases, spline)
