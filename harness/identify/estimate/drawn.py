"""Parameters drawn from the covariance of a fit: how far predictions lie apart that the fit cannot tell apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.random import Generator

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import Problem


def drawn_terms(problem: Problem, found: Fit, draws: int, generator: Generator) -> Iterator[Terms]:
    """Terms with parameters drawn from the normal distribution of the fit, within their bounds.

    None where there are no parameters, or where their covariance is not finite and so tells nothing.
    """
    count = len(found.theta)
    if not count or not np.all(np.isfinite(found.covariance)):
        return
    if len(problem.recordings) > len(found.terms.recordings):  # of a part of them, as where blocks are held out
        fitted = tuple(one for one in problem.recordings if one.name in found.terms.recordings)
        problem = replace(problem, recordings=fitted)
    scale = found.hypothesis.scale(problem)
    root = _root(found.covariance / np.outer(scale, scale))
    low, high = found.hypothesis.bounds(problem)
    for _ in range(draws):
        theta = np.clip(found.theta + root @ generator.standard_normal(count), low, high)
        yield found.hypothesis.terms(theta, problem)


def _root(covariance: FloatArray) -> FloatArray:
    """Symmetric root of a covariance; eigenvalues that rounding makes negative are set to zero."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray((vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)
