"""Fit of a hypothesis: its parameters by least squares on normalised innovations, its process noise by likelihood.

Least squares (`scipy.optimize.least_squares`) on the normalised innovations alternate with maximum likelihood for the
process noise until the deviance has converged. Output-error fits of free runs end in local minima on this double
integrator; prediction-error fits hardly do (Ljung, System Identification, 2nd ed., 1999, section 7.2).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from operator import attrgetter

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.identify.estimate.band import AS_FORESEEN, Band
from harness.identify.estimate.screening import COARSE_STEP, INSIDE, ScreeningFit, information_inverse, screen
from harness.identify.estimate.travel import ANYWHERE, Travel
from harness.identify.filter import run as filter_run
from harness.identify.filter.residuals import Residuals
from harness.identify.problem.hypothesis import PHASE, Hypothesis, Terms, own_key
from harness.identify.problem.problem import Problem

PROCESS_NOISE = 1e-5  # initial density of the process noise [m²/s³]
# Half width of the search for the log of the density: from the default, from a screening fit, from the previous round.
_WIDE, _NEARBY, _NARROW = 12.0, 6.0, 3.0
_HIGHEST = 0.0  # log of 1 m²/s³: a ball whose driving force is unknown
# Norm of the change of the residuals since, up to which a Jacobian is used again: a tenth of a standard error in all.
# Residuals are computed at each step, so that least squares end at the same place but where laws are not smooth: with
# 1 in place of 0.1 the level of a measured rig with dry friction came out a third lower.
_REUSED = 0.1
FINE_STEP = 1e-3  # of the Jacobian's differences near the optimum, in scaled parameters


class Estimator(StrEnum):
    """How parameters are estimated; names as in diagnosis.json."""

    LIKELIHOOD = "likelihood"  # innovations and process noise
    FREE_RUNS = "free_runs"  # runs over windows without readings on the way
    FORECASTS = "forecasts"  # the predicted part of windows, with its process noise


@dataclass(frozen=True)
class Fit:
    """A fitted hypothesis.

    Attributes:
        hypothesis: the one that was fitted.
        theta: scaled parameters, shape (k,).
        terms: effects, phases and spline term with these parameters.
        process_noise: density [m²/s³].
        deviance: −2 log likelihood up to a constant.
        covariance: of the parameters in their units, shape (k, k).
        readings: number n of readings.
        abandoned: whether it is a screening fit, or one of a single round, that was not continued because its criterion
            was behind that of the best candidate, or no candidate promised anything.
        estimator: of the parameters; process noise and deviance are those of the filter in any case.
        held_out: RMS error of every block by a fit without it [m], if it was cross-validated.
        band: of its predictions, by errors of held-out blocks if it was held against them.
        travel: within which its predictions are kept.
        forecast_errors: RMS error of every block as a fit without it predicts it, with the process noise of this fit
            and within the travel of the windows that it is fitted to [m]; empty unless the band was fitted.
        quiet_deviance: deviance of the same terms without process noise.
    """

    hypothesis: Hypothesis
    theta: FloatArray
    terms: Terms
    process_noise: float
    deviance: float
    covariance: FloatArray
    readings: int
    abandoned: bool = False
    estimator: Estimator = Estimator.LIKELIHOOD
    held_out: tuple[float, ...] = ()
    band: Band = AS_FORESEEN
    travel: Travel = ANYWHERE
    forecast_errors: tuple[float, ...] = ()
    quiet_deviance: float = math.inf

    @property
    def refined(self) -> Hypothesis:
        """The hypothesis with the fitted nodes of its spline term, to start a further fit from."""
        return replace(self.hypothesis, spline=self.terms.spline)

    @property
    def root_process_noise(self) -> float:
        """√q [m/s² per √Hz]: root density of the acceleration that the model leaves unexplained."""
        return math.sqrt(self.process_noise)

    def values(self) -> dict[tuple[str, str], float]:
        """Value of every (effect, parameter), and what recordings have of their own by `own_key`."""
        values = {(one.effect.name, key): value for one in self.terms.effects for key, value in one.values.items()}
        each = dict(self.terms.own)
        if self.hypothesis.turning:
            each[PHASE] = self.terms.phases
        for name, own in each.items():
            values |= {
                own_key(name, recording): float(value)
                for recording, value in zip(self.terms.recordings, own, strict=True)
            }
        return values

    def deviations(self) -> dict[tuple[str, str], float]:
        """Standard error of every (effect, parameter)."""
        errors = np.sqrt(np.diag(self.covariance).clip(min=0.0))
        deviations = dict(zip(self.hypothesis.parameters, errors, strict=False))
        for name, own in self.terms.own.items():
            # of the standard deviation x of n values: dx/dvalue = (value − mean)/(n x)
            effect = next(one for one in self.hypothesis.effects if one.name == name)
            apart = own - np.mean(own)
            slope = apart / max(float(np.linalg.norm(apart)), 1e-30) / math.sqrt(len(own))
            at = self._own_slice(name)
            square = float(slope @ self.covariance[at, at] @ slope)
            deviations[name, effect.parameters[0].name] = math.sqrt(max(square, 0.0))
        return deviations

    def own_deviations(self, name: str) -> dict[str, float]:
        """Standard error of an effect's value in each recording, by the recording's name."""
        at = self._own_slice(name)
        errors = np.sqrt(np.diag(self.covariance[at, at]).clip(min=0.0))
        return dict(zip(self.terms.recordings, map(float, errors), strict=True))

    def _own_slice(self, name: str) -> slice:
        count = len(self.terms.recordings)
        begin = len(self.hypothesis.parameters) + self.hypothesis.own.index(name) * count
        return slice(begin, begin + count)


def fit(
    problem: Problem,
    hypothesis: Hypothesis,
    *,
    process_noise: float = PROCESS_NOISE,
    initial: Mapping[tuple[str, str], float] | None = None,
    starts: Sequence[FloatArray] = (),
    rounds: int | None = None,
) -> Fit:
    """Fit one hypothesis from one or several starting points; the result of lowest deviance is returned.

    Args:
        process_noise: initial density [m²/s³]; with `starts` it is searched near this value only.
        initial: initial values by (effect, parameter).
        starts: initial scaled parameters, shape (k,) each, instead of the best screening fits.
        rounds: largest number of alternations of parameters and process noise; by default that of the settings.

    Raises:
        InputError: the model's ball leaves all numbers from a starting point.
    """
    settings = problem.settings
    width = _NEARBY if starts else _WIDE
    if not starts:
        screened = screen(problem, hypothesis, process_noise, initial or {})
        starts = [end.theta for end in screened[: settings.starts_followed]]
    rounds = rounds or settings.max_rounds
    fits = [_fit_from(problem, hypothesis, theta, process_noise, rounds, width) for theta in starts]
    return min(fits, key=attrgetter("deviance"))


def unrefined(problem: Problem, hypothesis: Hypothesis, screened: ScreeningFit) -> Fit:
    """A screening fit as a fit, without further optimisation."""
    best = hypothesis.terms(screened.theta, problem)
    return Fit(
        hypothesis,
        screened.theta,
        best,
        screened.process_noise,
        screened.deviance,
        screened.covariance,
        problem.readings,
        quiet_deviance=quiet_deviance(problem, best),
    )


def quiet_deviance(problem: Problem, terms: Terms) -> float:
    """Deviance of the terms without process noise, which a complete model does not need."""
    return filter_run.deviance(problem, terms, problem.least_process_noise)


def _fit_from(
    problem: Problem, hypothesis: Hypothesis, theta: FloatArray, process_noise: float, rounds: int, width: float
) -> Fit:
    low, high = hypothesis.bounds(problem)
    theta = np.clip(theta, low + INSIDE, high - INSIDE)
    slopes, smoothness = np.zeros((problem.readings, len(theta))), hypothesis.smoothness(problem)
    lowest = math.log(problem.least_process_noise)
    process_noise, deviance = max(process_noise, math.exp(lowest)), math.inf
    for number in range(rounds):
        before, previous = deviance, (theta, slopes, process_noise, deviance)
        if len(theta):
            residuals = Residuals(problem, hypothesis, _density(problem, hypothesis, process_noise))
            begin = theta
            try:
                theta, slopes = _least_squares(residuals, smoothness, begin, low, high, first=number == 0)
            except ValueError as error:
                raise (_diverging(problem, residuals.at(begin)) or error) from error
        reach, middle = (width if number == 0 else _NARROW), math.log(process_noise)
        optimum = minimize_scalar(
            lambda x, at=theta: Residuals(problem, hypothesis, math.exp(x)).deviance(at),
            bounds=(max(middle - reach, lowest), max(min(middle + reach, _HIGHEST), lowest + 1.0)),
            method="bounded",
            options={"xatol": 0.1},
        )
        # Least squares at a fixed process noise do not count what variances cost.
        if float(optimum.fun) > before + problem.settings.converged:
            theta, slopes, process_noise, deviance = previous
            break
        process_noise, deviance = math.exp(optimum.x), float(optimum.fun)
        if not len(theta) or before - deviance < problem.settings.converged:
            break
    best = hypothesis.terms(theta, problem)
    covariance = information_inverse(problem, hypothesis, slopes)
    quiet = quiet_deviance(problem, best)
    return Fit(hypothesis, theta, best, process_noise, deviance, covariance, problem.readings, quiet_deviance=quiet)


def _diverging(problem: Problem, residuals: FloatArray) -> InputError | None:
    """Where residuals, shape (readings,), are no numbers, as an error; none if all are."""
    at = 0
    for recording in problem.recordings:
        stamps = recording.time[recording.judged]
        bad = np.flatnonzero(~np.isfinite(residuals[at : at + len(stamps)]))
        if len(bad):
            return InputError(
                f"{recording.name}: at t = {stamps[bad[0]]:.4g} s the model's ball has left all numbers, as on a beam "
                "that turns by degrees within no time; check stamps and angles up to there"
            )
        at += len(stamps)
    return None


def _density(problem: Problem, hypothesis: Hypothesis, process_noise: float) -> float:
    """Process noise at which parameters are fitted [m²/s³]: an error of the sensor as if it explained all.

    The steeper the sensor, the more variance do its readings get from process noise, and least squares at a fixed
    density do not count what that costs.
    """
    of_sensor = hypothesis.spline is not None and hypothesis.spline.sensor
    return min(process_noise, problem.angle_floor**2) if of_sensor else process_noise


def _least_squares(
    residuals: Residuals, smoothness: FloatArray, start: FloatArray, low: FloatArray, high: FloatArray, *, first: bool
) -> tuple[FloatArray, FloatArray]:
    """Scaled parameters of least squares at a fixed process noise, shape (k,), and the Jacobian, shape (readings, k).

    SciPy's initial trust region is the norm of the start, which may be 0: parameters are counted from start − 1.
    """
    origin = start - 1.0
    step = COARSE_STEP if first else FINE_STEP

    def at(z: FloatArray) -> FloatArray:
        return np.concatenate((residuals.at(origin + z), smoothness @ (origin + z)))

    latest: tuple[FloatArray, FloatArray] | None = None

    def slopes(z: FloatArray) -> FloatArray:
        nonlocal latest
        if latest is None or np.linalg.norm(latest[1] @ (z - latest[0])) > _REUSED:
            latest = z, np.vstack((residuals.jacobian(origin + z, step), smoothness))
        return latest[1]

    # A parameter that the readings tell nothing of makes its trust region overflow, where it then ends at a bound.
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        result = least_squares(
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
    return origin + result.x, np.asarray(result.jac)[: len(result.fun) - len(smoothness)]
