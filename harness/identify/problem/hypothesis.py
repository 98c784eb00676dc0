"""A hypothesis: effects and possibly a spline term beside the known effects, as a vector of parameters to fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from analytic.effects import CATALOGUE, Acting, Effect, Parameter, SensorLaw
from analytic.motion import FloatArray
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import SplineTerm

# Typical size of a spline term's nodes, of a force [m/s²], a friction coefficient [1], an error of the sensor [m].
_FORCE, _COEFFICIENT, _READING = 0.03, 0.003, 0.002
# Standard deviation of the difference of neighbouring nodes in scaled parameters; a friction coefficient may jump where
# the surface changes.
_NODE_DIFFERENCE, _FRICTION_DIFFERENCE = 1.0, 3.0
# Standard deviation of the mean of a sensor's error [m]: one that is alike all along the beam shifts the origin of
# positions, which readings hardly tell; what differs along it is an error.
_SHIFT = 1e-4

# How well the period of a force that repeats itself along the beam is known at first, and where a fit ends [m].
_PERIOD, _SHORTEST, _LONGEST = 1e-3, 0.01, 10.0
OWN_DEVIATION = 0.02  # prior standard deviation of a recording's own level [rad]: a hundred times what readings leave
PHASE = "phase"


def own_key(name: str, recording: str) -> tuple[str, str]:
    """Key of a recording's own value in a mapping of known values: φ₀ (`PHASE`), or that of an effect by name."""
    return "", f"{name} of {recording}"


@dataclass(frozen=True)
class Own:
    """What a recording has of its own: φ₀ [rad], and the value of each effect whose parameter differs between them."""

    phase: float = 0.0
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Terms:
    """A hypothesis with parameter values: effects, φ₀ of each recording [rad], and the spline term.

    `own` holds the values of each effect whose parameter differs between recordings, by its name, shape (recordings,).
    """

    recordings: tuple[str, ...]
    effects: tuple[Acting, ...]
    phases: FloatArray
    spline: SplineTerm | None
    own: Mapping[str, FloatArray] = field(default_factory=dict)

    def sensor_in(self, problem: Problem) -> SensorLaw:
        """The position sensor with the known effects, these, and the spline term if it is an error of the sensor."""
        law = problem.sensor(self.effects)
        return law if self.spline is None or not self.spline.sensor else replace(law, error=self.spline)

    def own_at(self, number: int) -> Own:
        """What the recording of this number has of its own."""
        return Own(float(self.phases[number]), {name: float(values[number]) for name, values in self.own.items()})

    def own_of(self, recording: str) -> Own:
        """What a recording has of its own, by its name; zeros for a recording that was not fitted."""
        if recording in self.recordings:
            return self.own_at(self.recordings.index(recording))
        return Own(0.0, dict.fromkeys(self.own, 0.0))

    def effects_in(self, own: Own) -> tuple[Acting, ...]:
        """The effects as they act in a recording that has this of its own."""
        return tuple(
            Acting(one.effect, {one.effect.parameters[0].name: own.values[one.effect.name]})
            if one.effect.name in own.values
            else one
            for one in self.effects
        )


NOTHING = Terms((), (), np.zeros(0), None)


@dataclass(frozen=True)
class Hypothesis:
    """Effects by name, in the order in which they were found, and possibly a spline term.

    The scaled parameters θ, each divided by its typical size, are those of the effects that are alike in all
    recordings, then what each recording has of its own, then the numbers of the spline term.
    """

    names: tuple[str, ...]
    spline: SplineTerm | None = None

    def __reduce__(self) -> tuple[type[Hypothesis], tuple[Any, ...]]:
        """From process to process go the fields alone: what follows from them holds laws, which are functions."""
        return Hypothesis, (self.names, self.spline)

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The catalogue's entries."""
        return tuple(CATALOGUE[name] for name in self.names)

    @cached_property
    def parameters(self) -> list[tuple[str, str]]:
        """(effect, parameter) of every parameter of an effect that all recordings share, in the order of θ."""
        return [
            (effect.name, parameter.name)
            for effect in self.effects
            for parameter in effect.parameters
            if not parameter.by_recording
        ]

    @cached_property
    def _effect_parameters(self) -> list[Parameter]:
        return [one for effect in self.effects for one in effect.parameters if not one.by_recording]

    @cached_property
    def own(self) -> tuple[str, ...]:
        """What each recording has of its own, in the order of θ: φ₀ (`PHASE`), effects by name."""
        differing = tuple(effect.name for effect in self.effects if effect.by_recording is not None)
        return (PHASE, *differing) if self.turning else differing

    def own_slice(self, name: str, problem: Problem) -> slice:
        """Where the values of the recordings are in θ, for `PHASE` or an effect."""
        count = len(problem.recordings)
        begin = len(self.parameters) + self.own.index(name) * count
        return slice(begin, begin + count)

    def recording_of(self, problem: Problem) -> list[int | None]:
        """Number of the recording that each of θ alone concerns, `None` for what concerns all; k entries."""
        count = len(problem.recordings)
        of_own: list[int | None] = [*range(count)] * len(self.own)
        return [None] * len(self.parameters) + of_own + [None] * self.tail(problem)[1]

    @property
    def turning(self) -> bool:
        """Whether a law depends on the rolled angle, so that φ₀ of each recording is a parameter."""
        return any(effect.turning for effect in self.effects) or (self.spline is not None and self.spline.turning)

    def tail(self, problem: Problem) -> tuple[int, int]:
        """Number of values that recordings have of their own and of the spline term's: θ after the effects'."""
        return len(problem.recordings) * len(self.own), len(self.spline.numbers) if self.spline else 0

    def size(self, problem: Problem) -> int:
        """Number of parameters k."""
        return len(self._effect_parameters) + sum(self.tail(problem))

    def scale(self, problem: Problem) -> FloatArray:
        """Typical size of each parameter in its unit, shape (k,): value = θ · scale."""
        sizes = [parameter.size(problem.rig) for parameter in self._effect_parameters]
        own = [size for name in self.own for size in [_own_size(name)] * len(problem.recordings)]
        return np.array(sizes + own + self._spline_sizes())

    def _spline_sizes(self) -> list[float]:
        if self.spline is None:
            return []
        size = _COEFFICIENT if self.spline.friction else _READING if self.spline.sensor else _FORCE
        nodes = [size] * self.spline.basis.shape[1]
        return [_PERIOD, *nodes] if self.spline.periodic else nodes

    def bounds(self, problem: Problem) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest scaled parameters, shape (k,) each."""
        limits = [parameter.bounds_on(problem.visited, problem.rig) for parameter in self._effect_parameters]
        limits += [(-np.inf, np.inf)] * sum(self.tail(problem))
        if self.spline is not None and self.spline.periodic:
            limits[-len(self.spline.numbers)] = _SHORTEST, _LONGEST
        low, high = np.array(limits).reshape(-1, 2).T
        scale = self.scale(problem)
        return low / scale, high / scale

    def smoothness(self, problem: Problem) -> FloatArray:
        """Matrix of the penalty: values over their prior standard deviations, as functions of θ, shape (r, k).

        Differences of neighbouring nodes of the spline term, which determine nodes where there are hardly any readings;
        and values of effects that differ between recordings, which would else not be distinct from one that all share.
        """
        own = np.zeros((0, self.size(problem)))
        scale = self.scale(problem)
        for name in self.own:
            if name != PHASE:
                own = np.vstack((own, np.diag(scale / OWN_DEVIATION)[self.own_slice(name, problem)]))
        if self.spline is None:
            return own
        count = len(self.spline.nodes)
        steps = np.roll(np.eye(count), 1, axis=1) - np.eye(count)
        steps = steps if self.spline.closed else steps[:-1]
        penalty = steps @ self.spline.basis / (_FRICTION_DIFFERENCE if self.spline.friction else _NODE_DIFFERENCE)
        if self.spline.sensor:
            penalty = np.vstack((penalty, np.full((1, count), _READING / count / _SHIFT)))
        return np.vstack((own, np.hstack((np.zeros((len(penalty), self.size(problem) - penalty.shape[1])), penalty))))

    def terms(self, theta: FloatArray, problem: Problem) -> Terms:
        """Effects, phases and spline term with the values of the scaled parameters, shape (k,)."""
        values = theta * self.scale(problem)
        each = {name: values[self.own_slice(name, problem)] for name in self.own}
        shared = dict(zip(self.parameters, map(float, values), strict=False))
        acting = tuple(
            Acting(
                effect,
                {effect.parameters[0].name: float(np.std(each[effect.name]))}
                if effect.by_recording is not None
                else {one.name: shared[effect.name, one.name] for one in effect.parameters},
            )
            for effect in self.effects
        )
        phases = each.pop(PHASE, np.zeros(len(problem.recordings)))
        spline = self.spline.with_numbers(values[-len(self.spline.numbers) :]) if self.spline else None
        return Terms(tuple(recording.name for recording in problem.recordings), acting, phases, spline, each)


def _own_size(name: str) -> float:
    """Typical size of what a recording has of its own: 1 rad of φ₀, that of the effect's parameter."""
    return 1.0 if name == PHASE else abs(CATALOGUE[name].parameters[0].typical)
