"""Starting points of a fit: values known from another fit, or the few places that each law needs."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np

from analytic.motion import FloatArray
from harness.identify.filter.run import deviance, deviance_of
from harness.identify.problem.hypothesis import Hypothesis, phase_key
from harness.identify.problem.problem import Problem

_PHASES = 2.0 * np.pi / 8 * np.arange(8)  # of φ₀ that are tried [rad]: no further than 22° from the likeliest
_SCREENED = 3  # starting points that are screened: of many places, the likeliest

Known = Mapping[tuple[str, str], float]
"""Values by (effect, parameter), and phases by `phase_key` a recording."""


def starting_points(problem: Problem, hypothesis: Hypothesis, known: Known, process_noise: float) -> list[FloatArray]:
    """Scaled parameters to begin from, each of shape (k,); where there are many, the likeliest.

    Args:
        known: values to begin from, where there are any.
        density: of the process noise with which phases and places are searched [m²/s³].
    """
    choices = []
    for effect in hypothesis.effects:
        keys = [(effect.name, parameter.name) for parameter in effect.parameters]
        if all(key in known for key in keys):
            choices.append([[known[key] for key in keys]])
        else:
            each = (one.starts_on(problem.visited, problem.rig) for one in effect.parameters)
            choices.append([list(one) for one in itertools.product(*each)])
    phases, nodes = hypothesis.tail(problem)[0], list(hypothesis.spline.nodes) if hypothesis.spline else []
    starts = []
    for one in itertools.product(*choices):
        values = [value for each in one for value in each]
        theta = np.array([*values, *[0.0] * phases, *nodes]) / hypothesis.scale(problem)
        starts.append(_with_phases(problem, hypothesis, theta, known, process_noise))
    if len(starts) > _SCREENED:
        starts.sort(key=lambda theta: deviance(problem, hypothesis.terms(theta, problem), process_noise))
    return starts[:_SCREENED]


def attenuated(hypothesis: Hypothesis, theta: FloatArray, factor: float, known: Known) -> FloatArray:
    """Scaled parameters with the strengths of effects that are not `known` at `factor` of what they are."""
    strengths = {(effect.name, name) for effect in hypothesis.effects for name in effect.strengths}
    factors = [factor if key in strengths and key not in known else 1.0 for key in hypothesis.parameters]
    return theta * np.array(factors + [1.0] * (len(theta) - len(factors)))


def _with_phases(
    problem: Problem, hypothesis: Hypothesis, theta: FloatArray, known: Known, process_noise: float
) -> FloatArray:
    """The parameters with the phases that are known or, one recording at a time, the likeliest of a few."""
    at, first = hypothesis.terms(theta, problem), len(hypothesis.parameters)
    for n, recording in enumerate(problem.recordings[: hypothesis.tail(problem)[0]]):
        phase = known.get(phase_key(recording.name))
        if phase is None:
            tried = [deviance_of(problem, recording, at, process_noise, phase=float(one)) for one in _PHASES]
            phase = float(_PHASES[np.argmin(tried)])
        theta[first + n] = phase
    return theta
