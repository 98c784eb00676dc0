"""Screening fits: one Gauss–Newton step from each starting point, to tell which hypotheses are worth a fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter, itemgetter

import numpy as np
from scipy.optimize import lsq_linear

from analytic.motion import FloatArray
from harness.identify.estimate.starts import attenuated, starting_points
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

# Step of the Jacobian's differences, in scaled parameters: wide enough to smooth over the ripples that a ball's stops
# leave in the deviance; a step relative to a parameter that is 0 would drown in rounding.
COARSE_STEP = 0.1
INSIDE = 1e-9  # distance from the bounds, in scaled parameters: least squares begin strictly within them
_FAR = 0.05  # of deviance a reading: beyond it the robust penalty is not the square that a linear model assumes
_ATTENUATIONS = (1.0, 0.1, 0.01, 0.0)
_NOISE_FACTORS = (0.3, 0.1, 0.03, 0.03)  # steps in which less process noise is tried where a screening fit ends


@dataclass(frozen=True)
class ScreeningFit:
    """One Gauss–Newton step from a starting point; the process noise is then the likeliest of a few.

    Attributes:
        start, numbers: where it begins and ends, scaled, shape (k,).
        predicted: deviance that the linear model predicts, at the process noise of the start.
        density: of the process noise where it ends [m²/s³].
        deviance: there.
        covariance: of the parameters in their units, shape (k, k), by the Jacobian at the start.
    """

    start: FloatArray
    theta: FloatArray
    predicted: float
    process_noise: float
    deviance: float
    covariance: FloatArray

    @property
    def hoped(self) -> float:
        """The lower of the predicted deviance and the one reached."""
        return min(self.predicted, self.deviance)


def screen(
    problem: Problem,
    hypothesis: Hypothesis,
    process_noise: float,
    known: Mapping[tuple[str, str], float],
    *,
    without: float = math.inf,
    steps: Sequence[float] = (COARSE_STEP,),
) -> list[ScreeningFit]:
    """A screening fit from each starting point of the hypothesis, the likeliest end first.

    Args:
        density: of the process noise [m²/s³].
        known: values to begin from.
        without: deviance of what is `known` alone. A start that is much worse is attenuated towards it, until the
            readings are where the linear model holds.
        steps: of the Jacobian's differences, in scaled parameters: the first at every start, the others at the best.
            Where much is missing the filter's ball stops at other times than the true one, and the deviance is rippled.
    """
    far = without + _FAR * problem.readings
    found = []
    for start in starting_points(problem, hypothesis, known, process_noise):
        residuals = Residuals(problem, hypothesis, process_noise)
        weaker = (attenuated(hypothesis, start, factor, known) for factor in _ATTENUATIONS)
        near = next((one for one in weaker if residuals.deviance(one) < far), start)
        found.append(_one_step(problem, hypothesis, near, residuals, steps[0]))
    by_deviance = attrgetter("deviance")
    found.sort(key=by_deviance)
    residuals = Residuals(problem, hypothesis, process_noise)
    found += [_one_step(problem, hypothesis, found[0].start, residuals, step) for step in steps[1:]]
    found.sort(key=by_deviance)
    first = problem.settings.starts_followed
    quieter = (_with_less_noise(problem, hypothesis, one) for one in found[:first])
    return sorted((*quieter, *found[first:]), key=by_deviance)


def information_inverse(problem: Problem, hypothesis: Hypothesis, slopes: FloatArray) -> FloatArray:
    """Covariance of the parameters in their units, shape (k, k), by the Jacobian of the normalised innovations."""
    scale, smoothness = hypothesis.scale(problem), hypothesis.smoothness(problem)
    return np.linalg.pinv(slopes.T @ slopes + smoothness.T @ smoothness) * np.outer(scale, scale)


def _one_step(
    problem: Problem, hypothesis: Hypothesis, start: FloatArray, residuals: Residuals, step: float
) -> ScreeningFit:
    low, high = hypothesis.bounds(problem)
    start = np.clip(start, low + INSIDE, high - INSIDE)
    here = residuals.at(start)
    if not len(start):
        deviance = residuals.deviance(start)
        return ScreeningFit(start, start, deviance, residuals.process_noise, deviance, np.zeros((0, 0)))
    relative = np.clip(np.abs(start), COARSE_STEP / 10.0, COARSE_STEP)
    slopes = residuals.slopes(start, relative if step == COARSE_STEP else np.full(len(start), step))
    smoothness = hypothesis.smoothness(problem)
    all_slopes, all_here = np.vstack((slopes, smoothness)), np.concatenate((here, smoothness @ start))
    move = lsq_linear(all_slopes, -all_here, bounds=(low - start, high - start), method="bvls").x
    before = residuals.deviance(start)
    predicted = before - float(here @ here - np.sum((here + slopes @ move) ** 2))
    end, deviance = start + move, residuals.deviance(start + move)
    if deviance > before:
        half = start + 0.5 * move
        deviance, end = min((residuals.deviance(half), half), (before, start), key=itemgetter(0))
    covariance = information_inverse(problem, hypothesis, slopes)
    return ScreeningFit(start, end, predicted, residuals.process_noise, deviance, covariance)


def _with_less_noise(problem: Problem, hypothesis: Hypothesis, one: ScreeningFit) -> ScreeningFit:
    """The same with less process noise where that is likelier, which it is if the law explains what was missing."""
    lowest = (problem.settings.noise_floor_share * problem.angle_floor) ** 2
    for factor in _NOISE_FACTORS:
        if factor * one.process_noise < lowest:
            break
        deviance = Residuals(problem, hypothesis, factor * one.process_noise).deviance(one.theta)
        if deviance > one.deviance:
            break
        one = replace(one, process_noise=factor * one.process_noise, deviance=deviance)
    return one
