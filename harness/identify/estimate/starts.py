"""Starting points of a fit: values of another fit where known, else the starting values of each parameter."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.filter.run import deviance, deviance_of
from harness.identify.problem.hypothesis import PHASE, Hypothesis, own_key
from harness.identify.problem.problem import Problem

_PHASES = 2.0 * np.pi / 8 * np.arange(8)  # initial values of φ₀ [rad]: within 22.5° of the optimum
_SCREENED = 3  # largest number of starting points

Values = Mapping[tuple[str, str], float]
"""Values by (effect, parameter), and what recordings have of their own by `own_key`."""


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
        if effect.by_recording is not None:
            continue
        keys = [(effect.name, parameter.name) for parameter in effect.parameters]
        if all(key in initial for key in keys):
            choices.append([[initial[key] for key in keys]])
        else:
            values = (parameter.starts_on(problem.visited, problem.rig) for parameter in effect.parameters)
            choices.append([list(chosen) for chosen in itertools.product(*values)])
    own, nodes = hypothesis.tail(problem)[0], list(hypothesis.spline.numbers) if hypothesis.spline else []
    starts = []
    for combination in itertools.product(*choices):
        theta = np.array([*itertools.chain(*combination), *[0.0] * own, *nodes]) / hypothesis.scale(problem)
        starts.append(_with_own(problem, hypothesis, theta, initial, process_noise))
    if len(starts) > _SCREENED:
        starts.sort(key=lambda theta: deviance(problem, hypothesis.terms(theta, problem), process_noise))
    return starts[:_SCREENED]


def attenuated(hypothesis: Hypothesis, theta: FloatArray, factor: float, initial: Values) -> FloatArray:
    """Scaled parameters with the strengths of effects without `initial` values multiplied by `factor`."""
    strengths = {(effect.name, name) for effect in hypothesis.effects for name in effect.strengths}
    factors = [factor if key in strengths and key not in initial else 1.0 for key in hypothesis.parameters]
    return theta * np.array(factors + [1.0] * (len(theta) - len(factors)))


def _with_own(
    problem: Problem, hypothesis: Hypothesis, theta: FloatArray, initial: Values, process_noise: float
) -> FloatArray:
    """The parameters with what is given of the recordings' own, or for each the φ₀ of lowest deviance in `_PHASES`."""
    scale = hypothesis.scale(problem)
    for name in hypothesis.own:
        if name != PHASE:
            given = [initial.get(own_key(name, recording.name), 0.0) for recording in problem.recordings]
            at = hypothesis.own_slice(name, problem)
            theta[at] = given / scale[at]
    if PHASE not in hypothesis.own:
        return theta
    terms, first = hypothesis.terms(theta, problem), hypothesis.own_slice(PHASE, problem).start
    for n, recording in enumerate(problem.recordings):
        phase = initial.get(own_key(PHASE, recording.name))
        if phase is None:
            tried = [replace(terms.own_at(n), phase=float(phi)) for phi in _PHASES]
            deviances = [deviance_of(problem, recording, terms, process_noise, own=own) for own in tried]
            phase = float(_PHASES[np.argmin(deviances)])
        theta[first + n] = phase
    return theta
