"""Fitting a hypothesis: its numbers by least squares on innovations, the process noise by likelihood, in turn.

Gauss–Newton steps (`scipy.optimize.least_squares`) take the innovations over their standard deviations as residuals;
the density of the process noise then moves to its likeliest value, and both are repeated until the deviance stands
still. Single shooting would end in local minima here; prediction errors have next to none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from analytic.motion import FloatArray
from harness.identify.hypothesis import Hypothesis, Values
from harness.identify.innovations import penalty
from harness.identify.problem import Problem

# Standard errors from the curvature of the likelihood are this much too small, for the angle's error is not white as
# the filter takes it to be: over 52 fits of 13 effects to recordings of the virtual rig (40,000 counts a turn) errors
# were 1.7 of them RMS, and 1.96 × 1.8 covered 93 %. Differences of deviance are too large by the square of it.
INFLATION = 2.0
_DENSITY = (1e-11, 1.0)  # [m²/s³]: an angle error of 0.1 µrad at 100 Hz … a beam that is not known at all
_ROUNDS = 6
_STANDS = 0.05  # of the deviance: a fiftieth of what decides anything
# Steps of slopes, in scaled numbers: the first, coarse ones look over the ripples that a ball's stops leave in the
# deviance; a step relative to a number that is 0 would fall into the rounding.
_COARSE, _STEP = 0.1, 1e-3


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis.

    Attributes:
        hypothesis: what was fitted.
        numbers: scaled, shape (k,).
        best: the same as effects, phases and curve.
        density: of the process noise [m²/s³].
        deviance: −2 log likelihood, but for a constant.
        covariance: of the values in their units, shape (k, k).
        readings: how many were predicted.
    """

    hypothesis: Hypothesis
    numbers: FloatArray
    best: Values
    density: float
    deviance: float
    covariance: FloatArray
    readings: int

    @property
    def bic(self) -> float:
        """Bayesian information criterion: deviance and a price of log n a number (Schwarz, Ann. Statist. 6, 1978)."""
        return self.deviance + math.log(self.readings) * len(self.numbers)

    @property
    def score(self) -> float:
        """The same with the deviance taken for what it is worth (quasi-likelihood, Wedderburn, Biometrika 61, 1974)."""
        return self.deviance / INFLATION**2 + math.log(self.readings) * len(self.numbers)

    @property
    def root_density(self) -> float:
        """Root of the process noise's density [m/s² per √Hz]: what the model leaves unexplained."""
        return math.sqrt(self.density)

    def values(self) -> dict[tuple[str, str], float]:
        """Value of every (effect, parameter)."""
        return {(one.effect.name, key): value for one in self.best.effects for key, value in one.values.items()}

    def deviations(self) -> dict[tuple[str, str], float]:
        """Standard deviation of every (effect, parameter), from the curvature of the likelihood."""
        return dict(zip(self.hypothesis.parameters, np.sqrt(np.diag(self.covariance)), strict=False))


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    *,
    density: float = 1e-5,
    known: Mapping[tuple[str, str], float] | None = None,
    quick: bool = False,
) -> Fit:
    """Fit one hypothesis; of several starts the likeliest end counts.

    Args:
        density: where the search for the process noise begins [m²/s³].
        known: values to begin from.
        quick: from the most promising start only and in one round: enough to see whether anything is to be gained.
    """
    best: Fit | None = None
    starts = list(hypothesis.starts(problem, known or {}))
    if len(starts) > (1 if quick else 3):
        starts = _promising(problem, hypothesis, starts, density)[: 1 if quick else 3]
    for start in starts:
        one = _fit_from(problem, hypothesis, start, density, rounds=1 if quick else _ROUNDS)
        if best is None or one.deviance < best.deviance:
            best = one
    assert best is not None
    return best


def _promising(problem: Problem, hypothesis: Hypothesis, starts: list[FloatArray], density: float) -> list[FloatArray]:
    """The three starts that a short fit takes furthest."""
    tried: list[tuple[float, int, FloatArray]] = []
    for start in starts:
        numbers, _ = _least(problem, hypothesis, start, density, evaluations=3, step=_COARSE)
        tried.append((_deviance(problem, hypothesis, numbers, density), len(tried), numbers))
    return [numbers for *_, numbers in sorted(tried)[:3]]


def _fit_from(problem: Problem, hypothesis: Hypothesis, numbers: FloatArray, density: float, rounds: int) -> Fit:
    jacobian = np.zeros((problem.readings, len(numbers)))
    before = math.inf
    deviance = math.inf
    for turn in range(rounds):
        if len(numbers):
            numbers, jacobian = _least(
                problem,
                hypothesis,
                numbers,
                density,
                evaluations=12 if rounds > 1 else 5,
                step=_COARSE if turn == 0 else _STEP,
            )
        width = 12.0 if turn == 0 else 3.0
        middle = math.log(density)
        found = minimize_scalar(
            lambda x, at=numbers: _deviance(problem, hypothesis, at, math.exp(x)),
            bounds=(max(middle - width, math.log(_DENSITY[0])), min(middle + width, math.log(_DENSITY[1]))),
            method="bounded",
            options={"xatol": 0.1},
        )
        density, deviance = math.exp(found.x), float(found.fun)
        if not len(numbers) or before - deviance < _STANDS:
            break
        before = deviance
    best = hypothesis.read(numbers, problem)
    scale = hypothesis.scale(problem)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * np.outer(scale, scale)
    return Fit(hypothesis, numbers, best, density, deviance, covariance, problem.readings)


def _least(
    problem: Problem, hypothesis: Hypothesis, start: FloatArray, density: float, evaluations: int, step: float
) -> tuple[FloatArray, FloatArray]:
    """Numbers of least squared innovations at a fixed process noise, and the Jacobian there."""

    @lru_cache(maxsize=1)
    def at_numbers(numbers: tuple[float, ...]) -> FloatArray:
        at = hypothesis.read(np.array(numbers), problem)
        miss, spread = problem.predict(at.effects, at.phases, density, at.shape)
        ratio = miss / np.sqrt(spread)
        return np.sign(ratio) * np.sqrt(penalty(ratio))

    def residuals(numbers: FloatArray) -> FloatArray:
        return at_numbers(tuple(numbers.tolist()))

    low, high = hypothesis.bounds(problem)

    def slopes(numbers: FloatArray) -> FloatArray:
        here = residuals(numbers)
        moves = np.diag(np.where(numbers + step <= high, step, -step))
        return np.column_stack([(residuals(numbers + move) - here) / move.sum() for move in moves])

    start = np.clip(start, low + 1e-9, high - 1e-9)
    found = least_squares(
        residuals,
        start,
        jac=slopes,
        bounds=(low, high),
        x_scale=1.0,
        max_nfev=evaluations,
        xtol=1e-5,
        ftol=1e-6,
        gtol=1e-6,
    )
    return found.x, np.asarray(found.jac)


def _deviance(problem: Problem, hypothesis: Hypothesis, numbers: FloatArray, density: float) -> float:
    at = hypothesis.read(numbers, problem)
    return problem.deviance(at.effects, at.phases, density, at.shape)
