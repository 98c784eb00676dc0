"""Starting points of a fit: values of another fit where known, else the starting values of each parameter."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from analytic.motion import FloatArray
from harness.identify.filter.run import deviance, deviance_of
from harness.identify.problem.hypothesis import Hypothesis, phase_key
from harness.identify.problem.problem import Problem

_PHASES = 2.0 * np.pi / 8 * np.arange(8)  # initial values of φ₀ [rad]: within 22.5° of the optimum
_SCREENED = 3  # largest number of starting points

Values = Mapping[tuple[str, str], float]
"""Values by (effect, parameter), and φ₀ of recordings by `phase_key`."""


def starting_points(
    problem: Problem, hypothesis: Hypothesis, initial: Values, process_noise: float
) -> list[FloatArray]:
    """Initial scaled parameters, shape (k,) each; of many, the three of lowest deviance.

    Args:
        initial: values that replace those of the catalogue.
        process_noise: density with which phases and starting values are compared [m²/s³].
    """
    choices = []
    for effect in hypothesis.effects:
        keys = [(effect.name, parameter.name) for parameter in effect.parameters]
        if all(key in initial for key in keys):
            choices.append([[initial[key] for key in keys]])
        else:
            values = (parameter.starts_on(problem.visited, problem.rig) for parameter in effect.parameters)
            choices.append([list(chosen) for chosen in itertools.product(*values)])
    phases, nodes = hypothesis.tail(problem)[0], list(hypothesis.spline.nodes) if hypothesis.spline else []
    starts = []
    for combination in itertools.product(*choices):
        theta = np.array([*itertools.chain(*combination), *[0.0] * phases, *nodes]) / hypothesis.scale(problem)
        starts.append(_with_phases(problem, hypothesis, theta, initial, process_noise))
    if len(starts) > _SCREENED:
        starts.sort(key=lambda theta: deviance(problem, hypothesis.terms(theta, problem), process_noise))
    return starts[:_SCREENED]


def attenuated(hypothesis: Hypothesis, theta: FloatArray, factor: float, initial: Values) -> FloatArray:
    """Scaled parameters with the strengths of effects without `initial` values multiplied by `factor`."""
    strengths = {(effect.name, name) for effect in hypothesis.effects for name in effect.strengths}
    factors = [factor if key in strengths and key not in initial else 1.0 for key in hypothesis.parameters]
    return theta * np.array(factors + [1.0] * (len(theta) - len(factors)))


def _with_phases(
    problem: Problem, hypothesis: Hypothesis, theta: FloatArray, initial: Values, process_noise: float
) -> FloatArray:
    """The parameters with the φ₀ given, or for each recording the one of lowest deviance among `_PHASES`."""
    at, first = hypothesis.terms(theta, problem), len(hypothesis.parameters)
    for n, recording in enumerate(problem.recordings[: hypothesis.tail(problem)[0]]):
        phase = initial.get(phase_key(recording.name))
        if phase is None:
            deviances = [deviance_of(problem, recording, at, process_noise, phase=float(phi)) for phi in _PHASES]
            phase = float(_PHASES[np.argmin(deviances)])
        theta[first + n] = phase
    return theta
