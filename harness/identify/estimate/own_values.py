"""Estimate of what a recording has of its own: the roll phase φ₀, and effects that differ between recordings."""

from __future__ import annotations

import math
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
_UNKNOWN_PHASE = np.pi / np.sqrt(3.0)  # standard deviation of a phase of which nothing is known [rad]
_WIDTHS = 3  # of the differences that tell a deviation, each of the size that the one before tells
_LEAST_SPREAD = 1e-5  # of values that recordings have of their own [rad]: less than any reading tells
_REACHES = (1.0, 0.1)  # of the search for a value, in the catalogue's largest: first all, then near the first


def estimates_own(found: Fit, recording: PreparedRecording) -> bool:
    """Whether a recording has values of its own that the fit does not have, so that its readings have to give them."""
    return bool(found.hypothesis.own) and recording.name not in found.terms.recordings


def own_of(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray) -> Own:
    """What a recording has of its own: as fitted, or else of maximum likelihood for `reading`, shape (n,) [m].

    Values of effects have as prior what the recordings of the fit say of a further one: a ball that friction holds at
    rest tells nothing of them, and a few seconds little.
    """
    own = found.terms.own_of(recording.name)
    if not estimates_own(found, recording):
        return own
    deviance = _deviance(problem, found, recording, reading)
    for reach in _REACHES:
        for name in own.values:
            own = _with_value(deviance, own, name, reach)
        if PHASE in found.hypothesis.own:
            own = _with_phase(deviance, own)
        if len(found.hypothesis.own) == 1 and PHASE in found.hypothesis.own:
            break
    return own


def own_deviations(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray, own: Own) -> Own:
    """Standard deviation of each value of `own_of`, by the curvature of the deviance; 0 where it was fitted."""
    if not estimates_own(found, recording):
        return Own(0.0, dict.fromkeys(own.values, 0.0))
    deviance = _deviance(problem, found, recording, reading)

    def deviation(at: Callable[[float], Own], most: float) -> float:
        width = 0.1 * most
        for _ in range(_WIDTHS):
            bend = deviance(at(width)) + deviance(at(-width)) - 2.0 * deviance(own)
            width = min(width * math.sqrt(2.0 / bend), most) if bend > 0.0 else most
        return width

    def value(name: str) -> Callable[[float], Own]:
        return lambda by: replace(own, values={**own.values, name: own.values[name] + by})

    turning = PHASE in found.hypothesis.own
    phase = deviation(lambda by: replace(own, phase=own.phase + by), _UNKNOWN_PHASE) if turning else 0.0
    return Own(phase, {name: deviation(value(name), OWN_DEVIATION) for name in own.values})


def _deviance(
    problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray
) -> Callable[[Own], float]:
    """Deviance of a recording as a function of what it has of its own, with the prior of values."""

    def deviance(at: Own) -> float:
        prior = sum(_unlikely(value, found.terms.own[name]) for name, value in at.values.items())
        return deviance_of(problem, recording, found.terms, found.process_noise, own=at, reading=reading) + prior

    return deviance


def _unlikely(value: float, others: FloatArray) -> float:
    """−2 log density of a further value beside those of other recordings, shape (n,), up to a constant [1].

    Of normal values of which no more is known: Student's t of n − 1 degrees of freedom about their mean, wider than
    their deviation by √(1 + 1/n) (Gelman et al., Bayesian Data Analysis, 2013, section 3.2). Of a single one nothing
    tells how far another is from it.
    """
    count = len(others)
    if count < 2:
        return (value / OWN_DEVIATION) ** 2
    width = max(float(np.std(others, ddof=1)), _LEAST_SPREAD) * math.sqrt(1.0 + 1.0 / count)
    square = ((value - float(np.mean(others))) / width) ** 2
    return count * math.log1p(square / (count - 1))


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
