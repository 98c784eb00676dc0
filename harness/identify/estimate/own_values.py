"""Estimate of what a recording has of its own: the roll phase φ₀, and effects that differ between recordings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from analytic.effects import CATALOGUE
from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.filter.run import deviance_of
from harness.identify.problem.hypothesis import OWN_DEVIATION, PHASE, Own
from harness.identify.problem.problem import PreparedRecording, Problem

_TURN = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)  # grid of the first search for φ₀ [rad]
_REACHES = (1.0, 0.1)  # of the search for a value, in the catalogue's largest: first all, then near the first


def own_of(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray) -> Own:
    """What a recording has of its own: as fitted, or else of maximum likelihood for `reading`, shape (n,) [m].

    Values of effects have the prior of the fit, as a ball that friction holds at rest says nothing of them.
    """
    own = found.terms.own_of(recording.name)
    if recording.name in found.terms.recordings or not found.hypothesis.own:
        return own

    def deviance(at: Own) -> float:
        prior = sum((value / OWN_DEVIATION) ** 2 for value in at.values.values())
        return deviance_of(problem, recording, found.terms, found.process_noise, own=at, reading=reading) + prior

    for reach in _REACHES:
        for name in own.values:
            own = _with_value(deviance, own, name, reach)
        if PHASE in found.hypothesis.own:
            own = _with_phase(deviance, own)
        if len(found.hypothesis.own) == 1 and PHASE in found.hypothesis.own:
            break
    return own


def _with_value(deviance: Callable[[Own], float], own: Own, name: str, reach: float) -> Own:
    """The same with the value of one effect of lowest deviance, at most `reach` times its bound away."""
    parameter, here = CATALOGUE[name].parameters[0], own.values[name]
    width = reach * parameter.high

    def at(value: float) -> Own:
        return replace(own, values={**own.values, name: value})

    places = here + width * np.linspace(-1.0, 1.0, 17)
    start = min(places, key=lambda value: deviance(at(float(value))))
    step = places[1] - places[0]
    optimum = minimize_scalar(
        lambda value: deviance(at(float(value))),
        bounds=(start - step, start + step),
        method="bounded",
        options={"xatol": 1e-6},
    )
    return at(float(optimum.x))


def _with_phase(deviance: Callable[[Own], float], own: Own) -> Own:
    start = min(_TURN, key=lambda phase: deviance(replace(own, phase=float(phase))))
    optimum = minimize_scalar(
        lambda phase: deviance(replace(own, phase=float(phase))),
        bounds=(start - _TURN[1], start + _TURN[1]),
        method="bounded",
    )
    return replace(own, phase=float(optimum.x))
