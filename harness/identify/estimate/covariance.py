"""Finite-difference covariance for laws that are not smooth.

For backlash or slip the innovations jump as a parameter changes, and their derivatives do not describe the deviance at
a finite distance: the standard error of a backlash width came out seventeen times too small. Differences over the
reported interval do.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.estimate.screening import information_inverse
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.problem import Problem

_ITERATIONS = 3  # of step and Jacobian, each of which depends on the other
_LONGEST = 1.0  # longest step, in scaled parameters


def with_interval_covariance(problem: Problem, found: Fit) -> Fit:
    """The same fit, its covariance by differences over ± one standard deviation of each parameter.

    It is the standard deviation with the other parameters held fixed, since the parameter is moved alone. A fit to free
    runs keeps its own.
    """
    if not len(found.theta) or found.estimator is Estimator.FREE_RUNS:
        return found
    jacobian = interval_jacobian(problem, found)
    return replace(found, covariance=information_inverse(problem, found.hypothesis, jacobian))


def interval_jacobian(problem: Problem, found: Fit) -> FloatArray:
    """Differences of the normalised innovations over ± one standard deviation per scaled parameter, shape
    (readings, k)."""
    residuals = Residuals(problem, found.hypothesis, found.process_noise)
    reach = np.full(len(found.theta), 1e-3)
    for _ in range(_ITERATIONS):
        jacobian = residuals.jacobian_over(found.theta, reach)
        norms = np.sqrt(np.sum(jacobian**2, axis=0))
        reach = 1.0 / np.maximum(norms, 1.0 / _LONGEST)
    return jacobian
