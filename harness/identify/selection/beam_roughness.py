"""How roughly the beam moves between the counts of its encoder: estimated by likelihood from the ball.

The drive estimates the density of the beam's third derivative from the angle's readings. A controller that follows a
noisy position shakes the beam within a count, which they do not show; the ball feels it, above all where dry friction
holds it. The error that the drive states is then too small, what is left is taken for process noise, and a play or a
delay of the angle seems to explain some of it. The ball's readings tell the factor by which the density is larger.
"""

from __future__ import annotations

import math
from dataclasses import replace

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
    where it has been. A rougher beam that leaves the process noise nearly as it is has nothing to do with what that
    stands for: it only fits the colour of another error.

    Args:
        found: a fit of what acts, whose terms are taken as they are.
    """
    needless = found.process_noise < _ABOVE * problem.least_process_noise
    if needless or problem.roughness != 1.0 or Criterion(problem.settings).far_above_noise_floor(problem, found):
        return problem
    progress("roughness of the beam's motion")
    rougher = [problem.rougher(factor) for factor in _FACTORS]
    reached = [_at_its_density(one, found) for one in rougher]
    best, fitted = min(zip(rougher, reached, strict=True), key=lambda pair: pair[1].deviance)
    told = fitted.deviance < found.deviance - _LEAST and Criterion(problem.settings).explains(fitted, found)
    return best if told else problem


def _at_its_density(problem: Problem, found: Fit) -> Fit:
    """The terms of a fit at the density of the process noise of lowest deviance, at most that of the fit."""
    least = problem.least_process_noise
    reached = {least: deviance(problem, found.terms, least)}
    if found.process_noise > least:
        at = minimize_scalar(
            lambda x: deviance(problem, found.terms, math.exp(x)),
            bounds=(math.log(least), math.log(found.process_noise)),
            method="bounded",
            options={"xatol": _CLOSE},
        )
        reached[math.exp(at.x)] = float(at.fun)
    density = min(reached, key=reached.__getitem__)
    return replace(found, process_noise=density, deviance=reached[density])
