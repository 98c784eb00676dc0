"""Fit of a hypothesis: its parameters by least squares on normalised innovations, its process noise by likelihood.

Gauss–Newton steps (`scipy.optimize.least_squares`) take the innovations over their standard deviations as residuals;
the density of the process noise then moves to its maximum likelihood, and both alternate until the deviance stands
still. Output-error fits of free runs end in local minima on this double integrator; prediction-error fits hardly do
(Ljung, System Identification, 2nd ed., 1999, section 7.2).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from analytic.motion import FloatArray
from harness.identify.estimate.screening import COARSE_STEP, INSIDE, ScreeningFit, information_inverse, screen
from harness.identify.filter.residuals import Misses
from harness.identify.problem.hypothesis import Hypothesis, Values, phase_of
from harness.identify.problem.problem import Problem

TWO_SIDED = 1.96  # standard deviations to either side hold 95 % of what is normal
DENSITY = 1e-5  # where the search for the process noise begins [m²/s³]
# Half widths of the search for the log of the density: from nowhere, from a screening fit, and from the round before.
_WIDE, _NEARBY, _NARROW = 12.0, 6.0, 3.0
_HIGHEST = 0.0  # log of 1 m²/s³: a beam of which nothing is known
_FINE_STEP = 1e-3  # of the Jacobian's differences near the optimum, in scaled parameters


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis.

    Attributes:
        hypothesis: what was fitted.
        numbers: scaled parameters, shape (k,).
        best: the same as effects, phases and spline term.
        density: of the process noise [m²/s³].
        deviance: −2 log likelihood, but for a constant.
        covariance: of the parameters in their units, from the curvature of the likelihood, shape (k, k).
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
        """The hypothesis with its spline term as it was fitted, to begin a further fit from."""
        return replace(self.hypothesis, shape=self.best.shape)

    @property
    def root_density(self) -> float:
        """Root of the process noise's density [m/s² per √Hz]: the acceleration that the model leaves unexplained."""
        return math.sqrt(self.density)

    def values(self) -> dict[tuple[str, str], float]:
        """Value of every (effect, parameter), and the phases of the recordings where there are any."""
        values = {(one.effect.name, key): value for one in self.best.effects for key, value in one.values.items()}
        if self.hypothesis.turning:
            values |= {phase_of(name): phase for name, phase in zip(self.best.records, self.best.phases, strict=True)}
        return values

    def deviations(self) -> dict[tuple[str, str], float]:
        """Standard error of every (effect, parameter), without overdispersion."""
        return dict(zip(self.hypothesis.parameters, np.sqrt(np.diag(self.covariance).clip(min=0.0)), strict=False))


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    *,
    density: float = DENSITY,
    known: Mapping[tuple[str, str], float] | None = None,
    starts: Sequence[FloatArray] = (),
    rounds: int | None = None,
) -> Fit:
    """Fit one hypothesis; of several starting points the likeliest end counts.

    Args:
        density: where the search for the process noise begins [m²/s³]; near to it, where there are `starts`.
        known: values to begin from.
        starts: scaled parameters to begin from, each of shape (k,), instead of those that the hypothesis names.
        rounds: of parameters and process noise in turn, at most; by default as in the settings.
    """
    settings = problem.settings
    width = _NEARBY if starts else _WIDE
    if not starts:
        screened = screen(problem, hypothesis, density, known or {})
        starts = [one.numbers for one in screened[: settings.starts_followed]]
    ends = [_fit_from(problem, hypothesis, one, density, rounds or settings.max_rounds, width) for one in starts]
    return min(ends, key=lambda one: one.deviance)


def unrefined(problem: Problem, hypothesis: Hypothesis, screened: ScreeningFit) -> Fit:
    """A screening fit that is not followed any further, as a fit."""
    best = hypothesis.read(screened.numbers, problem)
    return Fit(
        hypothesis,
        screened.numbers,
        best,
        screened.density,
        screened.deviance,
        screened.covariance,
        problem.readings,
    )


def _fit_from(
    problem: Problem, hypothesis: Hypothesis, numbers: FloatArray, density: float, rounds: int, width: float
) -> Fit:
    low, high = hypothesis.bounds(problem)
    numbers = np.clip(numbers, low + INSIDE, high - INSIDE)
    slopes, smoothness = np.zeros((problem.readings, len(numbers))), hypothesis.evenness(problem)
    lowest = 2.0 * math.log(problem.settings.noise_floor_share * problem.angle_floor)
    density, deviance = max(density, math.exp(lowest)), math.inf
    for turn in range(rounds):
        before = deviance
        if len(numbers):
            residuals = Misses(problem, hypothesis, density)
            numbers, slopes = _least_squares(residuals, smoothness, numbers, low, high, first=turn == 0)
        reach, middle = (width if turn == 0 else _NARROW), math.log(density)
        found = minimize_scalar(
            lambda x, at=numbers: Misses(problem, hypothesis, math.exp(x)).deviance(at),
            bounds=(max(middle - reach, lowest), max(min(middle + reach, _HIGHEST), lowest + 1.0)),
            method="bounded",
            options={"xatol": 0.1},
        )
        density, deviance = math.exp(found.x), float(found.fun)
        if not len(numbers) or before - deviance < problem.settings.converged:
            break
    best = hypothesis.read(numbers, problem)
    covariance = information_inverse(problem, hypothesis, slopes)
    return Fit(hypothesis, numbers, best, density, deviance, covariance, problem.readings)


def _least_squares(
    residuals: Misses, smoothness: FloatArray, start: FloatArray, low: FloatArray, high: FloatArray, *, first: bool
) -> tuple[FloatArray, FloatArray]:
    """Parameters of least squared innovations at a fixed process noise, and the Jacobian there.

    SciPy's trust region begins as wide as the start is long, which would be no step at all from where nothing acts:
    parameters are counted from one typical size below the start.
    """
    origin = start - 1.0
    step = COARSE_STEP if first else _FINE_STEP

    def at(z: FloatArray) -> FloatArray:
        return np.concatenate((residuals.at(origin + z), smoothness @ (origin + z)))

    def slopes(z: FloatArray) -> FloatArray:
        return np.vstack((residuals.slopes(origin + z, step), smoothness))

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
    return origin + found.x, np.asarray(found.jac)[: len(found.fun) - len(smoothness)]
