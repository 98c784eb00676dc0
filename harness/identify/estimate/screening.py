"""Screening fits: one Gauss–Newton step from each starting point, to select the hypotheses worth a full fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np
from scipy.optimize import lsq_linear

from analytic.motion import FloatArray
from harness.identify.estimate.starts import attenuated, starting_points
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

# Step of the Jacobian's differences, in scaled parameters: wide enough to average over the ripple of the deviance where
# the ball stops.
COARSE_STEP = 0.1
INSIDE = 1e-9  # distance from the bounds, in scaled parameters: least squares have to start strictly within them
_FAR = 0.05  # increase of deviance per reading beyond which the robust penalty is far from the square
_ATTENUATIONS = (1.0, 0.1, 0.01, 0.0)
_NOISE_FACTORS = (0.3, 0.1, 0.03, 0.03)  # successive factors by which the process noise is reduced


@dataclass(frozen=True)
class ScreeningFit:
    """One Gauss–Newton step from a starting point, then the process noise of lowest deviance of a few.

    Attributes:
        start, theta: scaled parameters before and after the step, shape (k,) each.
        predicted: deviance predicted by the linearised model, at the initial process noise.
        process_noise: density after the step [m²/s³].
        deviance: after the step.
        covariance: of the parameters in their units, shape (k, k), by the Jacobian at the start.
    """

    start: FloatArray
    theta: FloatArray
    predicted: float
    process_noise: float
    deviance: float
    covariance: FloatArray

    @property
    def expected_deviance(self) -> float:
        """The lower of the predicted deviance and the one reached."""
        return min(self.predicted, self.deviance)


def screen(
    problem: Problem,
    hypothesis: Hypothesis,
    process_noise: float,
    initial: Mapping[tuple[str, str], float],
    *,
    without: float = math.inf,
    steps: Sequence[float] = (COARSE_STEP,),
) -> list[ScreeningFit]:
    """A screening fit from each starting point of the hypothesis, lowest deviance first.

    Args:
        process_noise: initial density [m²/s³].
        initial: initial values by (effect, parameter).
        without: deviance with the effects in `initial` alone. A start whose deviance is much higher is attenuated
            towards them, into the range where the linearisation holds.
        steps: of the Jacobian's differences, in scaled parameters: the first at every start, the others at the best.
            They smooth the ripple of the deviance that arises where the model's ball stops at wrong times.
    """
    limit = without + _FAR * problem.readings
    fits = []
    for start in starting_points(problem, hypothesis, initial, process_noise):
        residuals = Residuals(problem, hypothesis, process_noise)
        weaker = (attenuated(hypothesis, start, factor, initial) for factor in _ATTENUATIONS)
        near = next((theta for theta in weaker if residuals.deviance(theta) < limit), start)
        fits.append(_one_step(problem, hypothesis, near, residuals, steps[0]))
    by_deviance = attrgetter("deviance")
    fits.sort(key=by_deviance)
    residuals = Residuals(problem, hypothesis, process_noise)
    fits += [_one_step(problem, hypothesis, fits[0].start, residuals, step) for step in steps[1:]]
    fits.sort(key=by_deviance)
    first = problem.settings.starts_followed
    reduced = (_with_less_noise(problem, hypothesis, screened) for screened in fits[:first])
    return sorted((*reduced, *fits[first:]), key=by_deviance)


def information_inverse(problem: Problem, hypothesis: Hypothesis, slopes: FloatArray) -> FloatArray:
    """Covariance of the parameters in their units, shape (k, k), from the Jacobian of the residuals, (readings, k)."""
    scale, smoothness = hypothesis.scale(problem), hypothesis.smoothness(problem)
    return np.linalg.pinv(slopes.T @ slopes + smoothness.T @ smoothness) * np.outer(scale, scale)


def _one_step(
    problem: Problem, hypothesis: Hypothesis, start: FloatArray, residuals: Residuals, step: float
) -> ScreeningFit:
    low, high = hypothesis.bounds(problem)
    start = np.clip(start, low + INSIDE, high - INSIDE)
    # Both now, of one run of the filter: only the latest is kept, and the Jacobian makes others.
    here, before = residuals.at(start), residuals.deviance(start)
    if not len(start):
        return ScreeningFit(start, start, before, residuals.process_noise, before, np.zeros((0, 0)))
    relative = np.clip(np.abs(start), COARSE_STEP / 10.0, COARSE_STEP)
    slopes = residuals.jacobian(start, relative if step == COARSE_STEP else np.full(len(start), step))
    smoothness = hypothesis.smoothness(problem)
    penalised, target = np.vstack((slopes, smoothness)), -np.concatenate((here, smoothness @ start))
    move = lsq_linear(penalised, target, bounds=(low - start, high - start), method="bvls").x
    predicted = before - float(here @ here - np.sum((here + slopes @ move) ** 2))
    end = np.clip(start + move, low, high)  # rounding can put it a little beyond a bound, where no law need be
    deviance = residuals.deviance(end)
    if not deviance <= before:  # nor is it where the filter diverges, of which the deviance is not a number
        half = start + 0.5 * move
        there = residuals.deviance(half)
        deviance, end = (there, half) if there <= before else (before, start)
    covariance = information_inverse(problem, hypothesis, slopes)
    return ScreeningFit(start, end, predicted, residuals.process_noise, deviance, covariance)


def _with_less_noise(problem: Problem, hypothesis: Hypothesis, screened: ScreeningFit) -> ScreeningFit:
    """The same with less process noise as long as that lowers the deviance, as it does if the law was missing."""
    lowest = problem.least_process_noise
    for factor in _NOISE_FACTORS:
        reduced = factor * screened.process_noise
        if reduced < lowest:
            break
        deviance = Residuals(problem, hypothesis, reduced).deviance(screened.theta)
        if deviance > screened.deviance:
            break
        screened = replace(screened, process_noise=reduced, deviance=deviance)
    return screened
