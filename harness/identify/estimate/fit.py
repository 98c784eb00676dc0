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
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import Hypothesis, Terms, phase_key
from harness.identify.problem.problem import Problem

TWO_SIDED = 1.96  # standard deviations to either side hold 95 % of what is normal
PROCESS_NOISE = 1e-5  # where the search for the process noise begins [m²/s³]
# Half widths of the search for the log of the density: from nowhere, from a screening fit, and from the round before.
_WIDE, _NEARBY, _NARROW = 12.0, 6.0, 3.0
_HIGHEST = 0.0  # log of 1 m²/s³: a beam of which nothing is known
_FINE_STEP = 1e-3  # of the Jacobian's differences near the optimum, in scaled parameters


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis.

    Attributes:
        hypothesis: what was fitted.
        theta: scaled parameters, shape (k,).
        terms: the same as effects, phases and spline term.
        process_noise: its density [m²/s³].
        deviance: −2 log likelihood, but for a constant.
        covariance: of the parameters in their units, from the curvature of the likelihood, shape (k, k).
        readings: how many were predicted.
    """

    hypothesis: Hypothesis
    theta: FloatArray
    terms: Terms
    process_noise: float
    deviance: float
    covariance: FloatArray
    readings: int

    @property
    def refined(self) -> Hypothesis:
        """The hypothesis with its spline term as it was fitted, to begin a further fit from."""
        return replace(self.hypothesis, spline=self.terms.spline)

    @property
    def root_process_noise(self) -> float:
        """Root of the process noise's density [m/s² per √Hz]: the acceleration that the model leaves unexplained."""
        return math.sqrt(self.process_noise)

    def values(self) -> dict[tuple[str, str], float]:
        """Value of every (effect, parameter), and the phases of the recordings where there are any."""
        values = {(one.effect.name, key): value for one in self.terms.effects for key, value in one.values.items()}
        if self.hypothesis.turning:
            values |= {
                phase_key(name): phase for name, phase in zip(self.terms.recordings, self.terms.phases, strict=True)
            }
        return values

    def deviations(self) -> dict[tuple[str, str], float]:
        """Standard error of every (effect, parameter), without overdispersion."""
        return dict(zip(self.hypothesis.parameters, np.sqrt(np.diag(self.covariance).clip(min=0.0)), strict=False))


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    *,
    process_noise: float = PROCESS_NOISE,
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
        screened = screen(problem, hypothesis, process_noise, known or {})
        starts = [one.theta for one in screened[: settings.starts_followed]]
    ends = [_fit_from(problem, hypothesis, one, process_noise, rounds or settings.max_rounds, width) for one in starts]
    return min(ends, key=lambda one: one.deviance)


def unrefined(problem: Problem, hypothesis: Hypothesis, screened: ScreeningFit) -> Fit:
    """A screening fit that is not followed any further, as a fit."""
    best = hypothesis.terms(screened.theta, problem)
    return Fit(
        hypothesis,
        screened.theta,
        best,
        screened.process_noise,
        screened.deviance,
        screened.covariance,
        problem.readings,
    )


def _fit_from(
    problem: Problem, hypothesis: Hypothesis, theta: FloatArray, process_noise: float, rounds: int, width: float
) -> Fit:
    low, high = hypothesis.bounds(problem)
    theta = np.clip(theta, low + INSIDE, high - INSIDE)
    slopes, smoothness = np.zeros((problem.readings, len(theta))), hypothesis.smoothness(problem)
    lowest = 2.0 * math.log(problem.settings.noise_floor_share * problem.angle_floor)
    process_noise, deviance = max(process_noise, math.exp(lowest)), math.inf
    for turn in range(rounds):
        before = deviance
        if len(theta):
            residuals = Residuals(problem, hypothesis, process_noise)
            theta, slopes = _least_squares(residuals, smoothness, theta, low, high, first=turn == 0)
        reach, middle = (width if turn == 0 else _NARROW), math.log(process_noise)
        found = minimize_scalar(
            lambda x, at=theta: Residuals(problem, hypothesis, math.exp(x)).deviance(at),
            bounds=(max(middle - reach, lowest), max(min(middle + reach, _HIGHEST), lowest + 1.0)),
            method="bounded",
            options={"xatol": 0.1},
        )
        process_noise, deviance = math.exp(found.x), float(found.fun)
        if not len(theta) or before - deviance < problem.settings.converged:
            break
    best = hypothesis.terms(theta, problem)
    covariance = information_inverse(problem, hypothesis, slopes)
    return Fit(hypothesis, theta, best, process_noise, deviance, covariance, problem.readings)


def _least_squares(
    residuals: Residuals, smoothness: FloatArray, start: FloatArray, low: FloatArray, high: FloatArray, *, first: bool
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
