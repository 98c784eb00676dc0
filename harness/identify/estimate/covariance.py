"""How well numbers are known where laws have corners.

Innovations of a law with corners (a play that closes, a ball that begins to slide) change in steps with its numbers,
and their slopes at one place say nothing of the deviance a little further off: a width was "known" seventeen times as
well as it was. What counts is how the deviance rises over the interval that is reported.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.identify.estimate.fit import INFLATION, Fit, covariance_of
from harness.identify.filter.residuals import Misses
from harness.identify.problem.problem import Problem

_ROUNDS = 3  # a step of one standard deviation is found from the slopes over the step before
_LONGEST = 1.0  # step, in typical sizes


def spread_over(problem: Problem, one: Fit) -> Fit:
    """The same fit, its covariance by slopes across a standard deviation to either side of each number.

    The standard deviation is that of intervals (`INFLATION`), with the other numbers held: moved alone by what all of
    them together leave open, a number would go far beyond where the slopes mean anything.
    """
    if not len(one.numbers):
        return one
    misses = Misses(problem, one.hypothesis, one.density)
    reach = np.full(len(one.numbers), 1e-3)
    for _ in range(_ROUNDS):
        slopes = misses.chords(one.numbers, reach)
        steepness = np.sqrt(np.sum(slopes**2, axis=0))
        reach = INFLATION / np.maximum(steepness, INFLATION / _LONGEST)
    return replace(one, covariance=covariance_of(problem, one.hypothesis, slopes))
