"""Fits of which only the numbers matter that a decision rests on."""

from __future__ import annotations

import math

import numpy as np

from harness.identify.estimate.fit import Fit
from harness.identify.problem.hypothesis import Hypothesis, Terms
from harness.identify.problem.spline_term import Kind, Regressor, blank

READINGS = 1000
PRICE = math.log(READINGS)


def made(score: float, *names: str, spline: bool = False, parameters: int | None = None) -> Fit:
    """A fit whose criterion is `score`, with one parameter an effect unless told otherwise."""
    spline = blank(Kind(Regressor.POSITION), 0.0, 1.0) if spline else None
    count = len(names) if parameters is None else parameters
    hypothesis = Hypothesis(names, spline)
    deviance = score - PRICE * count
    terms = Terms((), (), np.zeros(0), spline)
    return Fit(hypothesis, np.zeros(count), terms, 1e-8, deviance, np.zeros((count, count)), READINGS)


def with_gain(gain: float) -> tuple[Fit, Fit]:
    """A spline term and the fit without it, of which the BIC is higher by this."""
    without = made(0.0)
    return made(without.deviance - gain, spline=True, parameters=12), without
