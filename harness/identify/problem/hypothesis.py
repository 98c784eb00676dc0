"""A hypothesis: effects and possibly a spline term beside the known effects, as a vector of parameters to fit."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.effects import CATALOGUE, Acting, Effect, Parameter
from analytic.motion import FloatArray
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import SplineTerm

# Standard deviation of the difference of neighbouring nodes in scaled parameters, for a force (False) and for a
# friction coefficient (True), which may jump where the surface changes.
_NODE_DIFFERENCE = {False: 1.0, True: 3.0}


def phase_key(recording: str) -> tuple[str, str]:
    """Key of a recording's φ₀ in a mapping of known values."""
    return "", f"phase of {recording}"


@dataclass(frozen=True)
class Terms:
    """A hypothesis with parameter values: effects, φ₀ of each recording [rad], and the spline term."""

    recordings: tuple[str, ...]
    effects: tuple[Acting, ...]
    phases: FloatArray
    spline: SplineTerm | None

    def phase_of(self, recording: str) -> float:
        """φ₀ of a recording by name [rad]; 0 for a recording that was not fitted."""
        return float(self.phases[self.recordings.index(recording)]) if recording in self.recordings else 0.0


NOTHING = Terms((), (), np.zeros(0), None)


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, in the order in which they were found, and possibly a spline term.

    The scaled parameters θ, each divided by its typical size, are those of the effects, then φ₀ of each recording
    if the hypothesis depends on the rolled angle, then the nodes of the spline term.
    """

    names: tuple[str, ...]
    spline: SplineTerm | None = None

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The catalogue's entries."""
        return tuple(CATALOGUE[name] for name in self.names)

    @cached_property
    def parameters(self) -> list[tuple[str, str]]:
        """(effect, parameter) of every parameter of an effect, in the order of θ."""
        return [(effect.name, parameter.name) for effect in self.effects for parameter in effect.parameters]

    @cached_property
    def _effect_parameters(self) -> list[Parameter]:
        return [parameter for effect in self.effects for parameter in effect.parameters]

    @property
    def turning(self) -> bool:
        """Whether a law depends on the rolled angle, so that φ₀ of each recording is a parameter."""
        return any(effect.turning for effect in self.effects) or (self.spline is not None and self.spline.turning)

    def tail(self, problem: Problem) -> tuple[int, int]:
        """Number of phases φ₀ and number of nodes of the spline term: the parameters after those of the effects."""
        return len(problem.recordings) if self.turning else 0, len(self.spline.nodes) if self.spline else 0

    def size(self, problem: Problem) -> int:
        """Number of parameters k."""
        return len(self._effect_parameters) + sum(self.tail(problem))

    def scale(self, problem: Problem) -> FloatArray:
        """Typical size of each parameter in its unit, shape (k,): value = θ · scale."""
        phases, nodes = self.tail(problem)
        node = 0.0 if self.spline is None else 0.003 if self.spline.friction else 0.03
        sizes = [parameter.size(problem.rig) for parameter in self._effect_parameters]
        return np.array(sizes + [1.0] * phases + [node] * nodes)

    def bounds(self, problem: Problem) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest scaled parameters, shape (k,) each."""
        free = sum(self.tail(problem))
        limits = [parameter.bounds_on(problem.visited, problem.rig) for parameter in self._effect_parameters]
        low, high = np.array([*limits, *[(-np.inf, np.inf)] * free]).reshape(-1, 2).T
        scale = self.scale(problem)
        return low / scale, high / scale

    def smoothness(self, problem: Problem) -> FloatArray:
        """Matrix of the smoothness penalty: differences of neighbouring nodes over their standard deviation from θ.

        It determines nodes where there are hardly any readings. Shape (r, k), r = 0 without a spline term.
        """
        if self.spline is None:
            return np.zeros((0, self.size(problem)))
        count = len(self.spline.nodes)
        steps = np.roll(np.eye(count), 1, axis=1) - np.eye(count)
        steps = steps if self.spline.turning else steps[:-1]
        penalty = steps / _NODE_DIFFERENCE[self.spline.friction]
        return np.hstack((np.zeros((len(steps), self.size(problem) - count)), penalty))

    def terms(self, theta: FloatArray, problem: Problem) -> Terms:
        """Effects, phases and spline term with the values of the scaled parameters, shape (k,)."""
        values = theta * self.scale(problem)
        acting, at = [], 0
        for effect in self.effects:
            acting.append(Acting(effect, {p.name: float(values[at + i]) for i, p in enumerate(effect.parameters)}))
            at += len(effect.parameters)
        phases = values[at : at + len(problem.recordings)] if self.turning else np.zeros(len(problem.recordings))
        spline = replace(self.spline, nodes=values[-len(self.spline.nodes) :]) if self.spline else None
        return Terms(tuple(recording.name for recording in problem.recordings), tuple(acting), phases, spline)
