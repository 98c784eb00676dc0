"""How roughly the beam moves between the counts of its encoder: estimated by likelihood from the ball.

The drive estimates the density of the beam's third derivative from the angle's readings. A controller that follows a
noisy position shakes the beam within a count, which they do not show; the ball feels it, above all where dry friction
holds it. The error that the drive states is then too small, what is left is taken for process noise, and a play or a
delay of the angle seems to explain some of it. The ball's readings tell the factor by which the density is larger.
"""

from __future__ import annotations

import math

from scipy.optimize import minimize_scalar

from harness.identify.estimate.fit import Fit
from harness.identify.filter.run import deviance
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion
from harness.progress import Progress, silent

_FACTORS = (10.0**0.5, 10.0, 10.0**1.5, 100.0)  # densities that differ by less make no difference to any innovation
_LEAST = 4.0  # decrease of the deviance from which a factor is taken: that of two standard errors
_ABOVE = 2.0  # times its lower bound, above which process noise stands for something
_CLOSE = 0.05  # of the log density of the process noise


def with_beam_roughness(problem: Problem, found: Fit, progress: Progress = silent) -> Problem:
    """The same problem with a rougher beam if the ball's readings tell so, else the problem itself.

    Nothing is estimated where `found` needs no process noise, nor where it needs so much that physics is missing, nor
    where it has been.

    Args:
        found: a fit of what acts, whose terms are taken as they are.
    """
    needless = found.process_noise < _ABOVE * problem.least_process_noise
    if needless or problem.roughness != 1.0 or Criterion(problem.settings).far_above_noise_floor(problem, found):
        return problem
    progress("roughness of the beam's motion")
    posed = [problem, *(problem.rougher(factor) for factor in _FACTORS)]
    reached = [found.deviance, *(_lowest_deviance(rougher, found) for rougher in posed[1:])]
    lowest = min(reached)
    return posed[reached.index(lowest)] if lowest < found.deviance - _LEAST else problem


def _lowest_deviance(problem: Problem, found: Fit) -> float:
    """Deviance of the terms of a fit at the best density of the process noise."""
    least = problem.least_process_noise
    reached = deviance(problem, found.terms, least)
    if found.process_noise <= least:
        return reached
    at = minimize_scalar(
        lambda x: deviance(problem, found.terms, math.exp(x)),
        bounds=(math.log(least), math.log(found.process_noise)),
        method="bounded",
        options={"xatol": _CLOSE},
    )
    return min(reached, float(at.fun))
