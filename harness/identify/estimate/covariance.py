"""Finite-difference covariance for laws that are not smooth.

Innovations of a law with corners (a play that closes, a ball that begins to slide) change in steps with its parameters,
and their slopes at one place say nothing of the deviance a little further off: a play's width was "known" seventeen
times as well as it was. What counts is how the deviance rises over the interval that is reported.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.screening import information_inverse
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.problem import Problem

_ITERATIONS = 3  # a step of one standard deviation follows from the slopes over the step before
_LONGEST = 1.0  # step, in typical sizes


def with_interval_covariance(problem: Problem, one: Fit) -> Fit:
    """The same fit, its covariance by differences across a standard deviation to either side of each parameter.

    The standard deviation is the overdispersed one of the reported intervals, with the other parameters held: moved
    alone by what all of them together leave open, one would go far beyond where the slopes mean anything.
    """
    if not len(one.theta):
        return one
    return replace(one, covariance=information_inverse(problem, one.hypothesis, interval_slopes(problem, one)))


def interval_slopes(problem: Problem, one: Fit) -> FloatArray:
    """Those differences of the normalised innovations per scaled parameter, shape (readings, k)."""
    inflation = math.sqrt(problem.settings.overdispersion)
    residuals = Residuals(problem, one.hypothesis, one.process_noise)
    reach = np.full(len(one.theta), 1e-3)
    for _ in range(_ITERATIONS):
        slopes = residuals.chords(one.theta, reach)
        steepness = np.sqrt(np.sum(slopes**2, axis=0))
        reach = inflation / np.maximum(steepness, inflation / _LONGEST)
    return slopes
