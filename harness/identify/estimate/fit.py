"""Fitting a hypothesis: its numbers by least squares on innovations, the process noise by likelihood, in turn.

Gauss–Newton steps (`scipy.optimize.least_squares`) take the innovations over their standard deviations as residuals;
the density of the process noise then moves to its likeliest value, and both are repeated until the deviance stands
still. Single shooting would end in local minima here; prediction errors have next to none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np
from scipy.optimize import least_squares, lsq_linear, minimize_scalar

from analytic.motion import FloatArray
from harness.identify.filter.residuals import Misses
from harness.identify.problem.hypothesis import Hypothesis, Values, phase_of
from harness.identify.problem.problem import Problem

# Standard errors from the curvature of the likelihood are too small, for the angle's error is not white as the filter
# takes it to be: a beam that rests is read wrong by one and the same part of a count. Intervals this much wider hold
# the truth in 90 to 98 % of calibrated trials (docs/calibration.md); deviances are too large by the square of it.
INFLATION = 1.75
TWO_SIDED = 1.96  # standard deviations to either side hold 95 % of what is normal
DENSITY = 1e-5  # where the search for the process noise begins [m²/s³]
# The angle's error leaves no less than this share of what its draws give; a curve could follow all the rest.
_LEAST_SHARE = 0.25
# How far off the log of the density may be: where the search begins anywhere, where it begins from a look, and then.
_WIDE, _NEARBY, _NARROW = 12.0, 6.0, 3.0
_HIGHEST = 0.0  # log of 1 m²/s³: a beam that is not known at all
_ROUNDS = 6
_STARTS = 2  # that are followed to their ends, the most promising ones
_FAR = 0.05  # of deviance a reading: beyond it the robust penalty is not the square that a linear model needs
_FACTORS = (1.0, 0.1, 0.01, 0.0)
_QUIETER = (0.3, 0.1, 0.03, 0.03)  # steps in which less process noise is tried where a look ends
_INSIDE = 1e-9  # of the bounds, in scaled numbers: least squares begin strictly within them
_STANDS = 0.05  # of the deviance: a fiftieth of what decides anything
# Steps of slopes, in scaled numbers: the first, coarse ones look over the ripples that a ball's stops leave in the
# deviance; a step relative to a number that is 0 would fall into the rounding.
COARSE, _STEP = 0.1, 1e-3


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
    def refined(self) -> Hypothesis:
        """The hypothesis with its curve as it was found, to fit on from there."""
        return replace(self.hypothesis, shape=self.best.shape)

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
        """Value of every (effect, parameter), and the phases of the recordings where there are any."""
        values = {(one.effect.name, key): value for one in self.best.effects for key, value in one.values.items()}
        if self.hypothesis.turning:
            values |= {phase_of(name): phase for name, phase in zip(self.best.records, self.best.phases, strict=True)}
        return values

    def deviations(self) -> dict[tuple[str, str], float]:
        """Standard deviation of every (effect, parameter), from the curvature of the likelihood."""
        return dict(zip(self.hypothesis.parameters, np.sqrt(np.diag(self.covariance).clip(min=0.0)), strict=False))


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    *,
    density: float = DENSITY,
    known: Mapping[tuple[str, str], float] | None = None,
    starts: Sequence[FloatArray] = (),
    rounds: int = _ROUNDS,
) -> Fit:
    """Fit one hypothesis; of several starts the likeliest end counts.

    Args:
        density: where the search for the process noise begins [m²/s³]; near to it, where there are `starts`.
        known: values to begin from.
        starts: scaled numbers to begin from, each of shape (k,), instead of those that the hypothesis names.
        rounds: of numbers and process noise in turn, at most.
    """
    wide = _NEARBY if starts else _WIDE
    starts = starts or [one.numbers for one in looks(problem, hypothesis, density, known or {})[:_STARTS]]
    return min(
        (_fit_from(problem, hypothesis, start, density, rounds, wide) for start in starts), key=lambda one: one.deviance
    )


@dataclass(frozen=True)
class Look:
    """One Gauss–Newton step from a start; the process noise is then the likeliest of a few.

    Attributes:
        start, numbers: where it begins and ends, scaled, shape (k,).
        promise: what the linear model leaves of the deviance, at the process noise of the start.
        density: of the process noise where it ends [m²/s³].
        deviance: there.
        covariance: of the values in their units, shape (k, k), by the slopes at the start.
    """

    start: FloatArray
    numbers: FloatArray
    promise: float
    density: float
    deviance: float
    covariance: FloatArray


def looks(
    problem: Problem,
    hypothesis: Hypothesis,
    density: float,
    known: Mapping[tuple[str, str], float],
    *,
    without: float = math.inf,
    steps: Sequence[float] = (COARSE,),
) -> list[Look]:
    """A step from each start of the hypothesis, the one that ends likeliest first.

    Args:
        steps: over which slopes are taken, in scaled numbers: the first at every start, the others at the best. Where
            much is missing the ball of the filter stops at other times than the true one, and the deviance is rippled.
        without: deviance of what is `known` alone. A start that is much worse than that is taken back towards it,
            until the readings are where the linear model holds.
    """
    far = without + _FAR * problem.readings
    found = []
    for start in hypothesis.starts(problem, known, density):
        misses = Misses(problem, hypothesis, density)
        weaker = (hypothesis.weaker(start, factor, known) for factor in _FACTORS)
        near = next((one for one in weaker if misses.deviance(one) < far), start)
        found.append(_look(problem, hypothesis, near, misses, steps[0]))
    found.sort(key=_deviance)
    misses = Misses(problem, hypothesis, density)
    found += [_look(problem, hypothesis, found[0].start, misses, step) for step in steps[1:]]
    found.sort(key=_deviance)
    return sorted((*(_quieter(problem, hypothesis, one) for one in found[:_STARTS]), *found[_STARTS:]), key=_deviance)


def _deviance(look: Look) -> float:
    return look.deviance


def _look(problem: Problem, hypothesis: Hypothesis, start: FloatArray, misses: Misses, step: float) -> Look:
    low, high = hypothesis.bounds(problem)
    start = np.clip(start, low + _INSIDE, high - _INSIDE)
    here = misses.at(start)
    if not len(start):
        deviance = misses.deviance(start)
        return Look(start, start, deviance, misses.density, deviance, np.zeros((0, 0)))
    size = np.clip(np.abs(start), COARSE / 10.0, COARSE) if step == COARSE else np.full(len(start), step)
    slopes = misses.slopes(start, size)
    even = hypothesis.evenness(problem)
    all_slopes, all_here = np.vstack((slopes, even)), np.concatenate((here, even @ start))
    move = lsq_linear(all_slopes, -all_here, bounds=(low - start, high - start), method="bvls").x
    before = misses.deviance(start)
    promise = before - float(here @ here - np.sum((here + slopes @ move) ** 2))
    end, deviance = start + move, misses.deviance(start + move)
    if deviance > before:
        deviance, end = min(
            (misses.deviance(start + 0.5 * move), start + 0.5 * move), (before, start), key=itemgetter(0)
        )
    return Look(start, end, promise, misses.density, deviance, covariance_of(problem, hypothesis, slopes))


def _quieter(problem: Problem, hypothesis: Hypothesis, look: Look) -> Look:
    """The look with less process noise where that is likelier, which it is if the law explains what was missing."""
    lowest = (_LEAST_SHARE * problem.angle_floor) ** 2
    for factor in _QUIETER:
        if factor * look.density < lowest:
            break
        deviance = Misses(problem, hypothesis, factor * look.density).deviance(look.numbers)
        if deviance > look.deviance:
            break
        look = replace(look, density=factor * look.density, deviance=deviance)
    return look


def unfitted(problem: Problem, hypothesis: Hypothesis, look: Look) -> Fit:
    """Where a look ends, as a fit that went no further."""
    return Fit(
        hypothesis,
        look.numbers,
        hypothesis.read(look.numbers, problem),
        look.density,
        look.deviance,
        look.covariance,
        problem.readings,
    )


def _fit_from(
    problem: Problem, hypothesis: Hypothesis, numbers: FloatArray, density: float, rounds: int, wide: float
) -> Fit:
    low, high = hypothesis.bounds(problem)
    numbers = np.clip(numbers, low + _INSIDE, high - _INSIDE)
    slopes, even = np.zeros((problem.readings, len(numbers))), hypothesis.evenness(problem)
    lowest = 2.0 * math.log(_LEAST_SHARE * problem.angle_floor)
    density, deviance = max(density, math.exp(lowest)), math.inf
    for turn in range(rounds):
        before = deviance
        if len(numbers):
            misses = Misses(problem, hypothesis, density)
            numbers, slopes = _least(misses, even, numbers, low, high, first=turn == 0)
        width, middle = (wide if turn == 0 else _NARROW), math.log(density)
        found = minimize_scalar(
            lambda x, at=numbers: Misses(problem, hypothesis, math.exp(x)).deviance(at),
            bounds=(max(middle - width, lowest), max(min(middle + width, _HIGHEST), lowest + 1.0)),
            method="bounded",
            options={"xatol": 0.1},
        )
        density, deviance = math.exp(found.x), float(found.fun)
        if not len(numbers) or before - deviance < _STANDS:
            break
    best = hypothesis.read(numbers, problem)
    covariance = covariance_of(problem, hypothesis, slopes)
    return Fit(hypothesis, numbers, best, density, deviance, covariance, problem.readings)


def covariance_of(problem: Problem, hypothesis: Hypothesis, slopes: FloatArray) -> FloatArray:
    """Of values in their units, shape (k, k), by slopes of innovations over their standard deviations."""
    scale, even = hypothesis.scale(problem), hypothesis.evenness(problem)
    return np.linalg.pinv(slopes.T @ slopes + even.T @ even) * np.outer(scale, scale)


def _least(
    misses: Misses, even: FloatArray, start: FloatArray, low: FloatArray, high: FloatArray, *, first: bool
) -> tuple[FloatArray, FloatArray]:
    """Numbers of least squared innovations at a fixed process noise, with even curves, and the slopes there.

    The trust region begins as wide as the start is long, which would be no step at all from where nothing acts: numbers
    are counted from one typical size below the start.
    """
    origin = start - 1.0
    step = COARSE if first else _STEP

    def at(z: FloatArray) -> FloatArray:
        return np.concatenate((misses.at(origin + z), even @ (origin + z)))

    def slopes(z: FloatArray) -> FloatArray:
        return np.vstack((misses.slopes(origin + z, step), even))

    found = least_squares(
        at,
        start - origin,
        jac=slopes,
        bounds=(low - origin, high - origin),
        x_scale=1.0,
        max_nfev=6,
        xtol=1e-5,
        ftol=1e-6,
        gtol=1e-6,
    )
    return origin + found.x, np.asarray(found.jac)[: len(found.fun) - len(even)]
