"""Fit of a hypothesis to free runs over windows: what predicts seconds best, whatever colour the model's error has.

Each window has a start (s, ṡ) of its own, which is eliminated (variable projection, Golub and Pereyra, SIAM J. Numer.
Anal. 10, 1973); the parameters are common. Steps of Gauss and Newton are damped (Levenberg and Marquardt) and kept
within the bounds. The loss of a residual e is the soft L1, 2 c² (√(1 + (e/c)²) − 1), with c from the median residual,
because a few windows in which the ball meets an end of the track or a sensor fails would decide otherwise.

One-step predictions tell more where the filter's assumptions hold. Where sensors are dirty and the model's error is
coloured they tell about that error; over seconds readings tell about forces.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from scipy.optimize import lsq_linear

from analytic.motion import FloatArray
from harness.identify.estimate.fit import PROCESS_NOISE, Estimator, Fit
from harness.identify.estimate.screening import INSIDE
from harness.identify.estimate.soft_l1 import loss, sandwich_covariance, scale_of, weights
from harness.identify.estimate.window_runs import FreeRuns
from harness.identify.problem.hypothesis import Hypothesis, own_key
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Window

_CONVERGED = 2e-3  # relative decrease of the loss
_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-6, 1e4  # at first; the bounds of it
_FACTOR = 6.0  # by which the damping changes
_FASTEST = 0.5  # largest change of a start in one step [m], [m/s]


class Effort(Enum):
    """How far a fit is taken."""

    FULL = "from anywhere to the optimum"
    NEAR = "from nearby to the optimum"
    BRIEF = "a few steps, to tell what is worth a full fit"


# Of the catalogue's, at which dry frictions begin: each ball that stops elsewhere is a local minimum of its own.
_STRENGTHS = (1.0, 4.0, 16.0)
_FOLLOWED = 3  # starting points from which a full fit descends: all of one dry friction
_NARROW = 0.05  # last width of the Jacobian's differences, in scaled parameters
# Widths of these differences and most steps with each of them.
_EFFORTS = {Effort.FULL: ((0.3, _NARROW), 12), Effort.NEAR: ((_NARROW,), 8), Effort.BRIEF: ((0.3,), 3)}


@dataclass(frozen=True)
class _Point:
    """Parameters θ, shape (k,), starts, shape (windows, 2), and what follows from them.

    Attributes:
        residual: reading − run of every reading, shape (readings,) [m].
        slopes: derivatives of the runs by the start of their window, shape (readings, 2).
    """

    theta: FloatArray
    starts: FloatArray
    residual: FloatArray
    slopes: FloatArray


@dataclass(frozen=True)
class FreeRunFit:
    """A fit, and the residuals of its free runs, shape (readings,) [m]."""

    fit: Fit
    residual: FloatArray

    def loss(self, scale: float) -> float:
        """Sum of the soft L1 losses with c = `scale` [m²]."""
        return loss(self.residual, scale)

    @property
    def scale(self) -> float:
        """c of this fit's own residuals [m]."""
        return scale_of(self.residual)


def fit_free_runs(
    problem: Problem,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    *,
    initial: Mapping[tuple[str, str], float] | None = None,
    effort: Effort = Effort.FULL,
) -> FreeRunFit:
    """Fit one hypothesis to free runs over `windows`, from the best of its starting points.

    The process noise of the fit is the initial one; `errors_by_density` tells which predicts best. The covariance is
    that of an M-estimator with windows as clusters (Liang and Zeger, Biometrika 73, 1986).

    Args:
        initial: initial values by (effect, parameter).
        effort: how far the fit is taken.
    """
    runs = FreeRuns(problem, windows)
    first = runs.first_starts()
    starts = _starting_points(problem, hypothesis, initial or {})
    low, high = hypothesis.bounds(problem)
    begun = [_settled(runs, hypothesis, np.clip(theta, low + INSIDE, high - INSIDE), first) for theta in starts]
    scale = min(scale_of(point.residual) for point in begun)
    begun = sorted(begun, key=lambda point: loss(point.residual, scale))
    followed = begun[: _FOLLOWED if effort is Effort.FULL else 1]
    widths, steps = _EFFORTS[effort]
    ends = [_descend(runs, hypothesis, point, widths, steps) for point in followed]
    scale = min(scale_of(point.residual) for point in ends)
    best = min(ends, key=lambda point: loss(point.residual, scale))
    if not np.all(np.isfinite(best.residual)):
        raise FloatingPointError("the free runs of this fit are not finite")
    return FreeRunFit(
        Fit(
            hypothesis,
            best.theta,
            hypothesis.terms(best.theta, problem),
            PROCESS_NOISE,
            np.nan,
            _covariance(runs, hypothesis, best),
            problem.readings,
            estimator=Estimator.FREE_RUNS,
        ),
        best.residual,
    )


def in_sample_losses(problem: Problem, windows: Sequence[Window], fits: Sequence[Fit]) -> tuple[float, ...]:
    """Loss of each fit, taken to its optimum over `windows`, at the scale of the first one [m²]."""
    made = [fit_free_runs(problem, one.refined, windows, initial=one.values(), effort=Effort.NEAR) for one in fits]
    return tuple(one.loss(made[0].scale) for one in made)


def _starting_points(
    problem: Problem, hypothesis: Hypothesis, initial: Mapping[tuple[str, str], float]
) -> list[FloatArray]:
    """Initial scaled parameters, shape (k,) each: given values, else every combination of the catalogue's.

    Dry frictions begin at several strengths.
    """
    choices = []
    by_name = {(effect.name, one.name): (effect, one) for effect in hypothesis.effects for one in effect.parameters}
    for key in hypothesis.parameters:
        effect, parameter = by_name[key]
        starts = parameter.starts_on(problem.visited, problem.rig)
        if effect.dry and parameter.strength:
            starts = [factor * start for start in starts for factor in _STRENGTHS]
        choices.append([initial[key]] if key in initial else starts)
    own = [initial.get(own_key(name, one.name), 0.0) for name in hypothesis.own for one in problem.recordings]
    tail = [*own, *(hypothesis.spline.numbers if hypothesis.spline else [])]
    scale = hypothesis.scale(problem)
    return [np.array([*values, *tail]) / scale for values in itertools.product(*choices)]


def _point(runs: FreeRuns, hypothesis: Hypothesis, theta: FloatArray, starts: FloatArray) -> _Point:
    position, slopes = runs.runs_and_slopes(hypothesis.terms(theta, runs.problem), starts)
    return _Point(theta, starts, runs.reading - position, slopes)


def _settled(runs: FreeRuns, hypothesis: Hypothesis, theta: FloatArray, starts: FloatArray) -> _Point:
    """The point with the starts of least squares at θ."""
    point = _point(runs, hypothesis, theta, starts)
    for _ in range(2):
        point = _point(
            runs, hypothesis, theta, _moved(point.starts, runs.project(point.slopes, point.residual[:, None])[1])
        )
    return point


def _moved(starts: FloatArray, moves: FloatArray) -> FloatArray:
    """Starts after one step, shape (windows, 2)."""
    return starts + np.clip(moves[:, :, 0], -_FASTEST, _FASTEST)


def _descend(runs: FreeRuns, hypothesis: Hypothesis, point: _Point, widths: Sequence[float], iterations: int) -> _Point:
    """The point of lowest loss that damped Gauss–Newton steps lead to.

    Args:
        widths: of the Jacobian's differences, in scaled parameters, one after the other. Wide ones average over the
            jumps that arise where dry friction stops the ball; narrow ones follow.
        iterations: most steps with each of these.
    """
    for width in widths if len(point.theta) else ():
        damping = _DAMPING
        for _ in range(iterations):
            scale = scale_of(point.residual)
            before = _objective(hypothesis, runs, point.theta, point.residual, scale)
            tried, damping = _damped_step(runs, hypothesis, point, width, scale, damping)
            if tried is None:
                break
            point = tried
            if _objective(hypothesis, runs, point.theta, point.residual, scale) > (1.0 - _CONVERGED) * before:
                break
    return point


def _damped_step(
    runs: FreeRuns, hypothesis: Hypothesis, point: _Point, width: float, scale: float, damping: float
) -> tuple[_Point | None, float]:
    """A point of lower objective, or `None`, and the damping for the step after it.

    Args:
        width: of the Jacobian's differences, in scaled parameters.
        scale: of the loss [m].
    """
    low, high = hypothesis.bounds(runs.problem)
    smoothness = hypothesis.smoothness(runs.problem)
    weight = weights(point.residual, scale) / scale
    slopes = point.slopes * weight[:, None]
    columns = np.column_stack((point.residual, _jacobian(runs, hypothesis, point, width))) * weight[:, None]
    projected, _ = runs.project(slopes, columns)
    if not np.all(np.isfinite(projected)):  # beside this point a ball leaves every bound: no way is known from here
        return None, damping
    before = _objective(hypothesis, runs, point.theta, point.residual, scale)
    while damping < _MOST_DAMPING:
        ridge = np.sqrt(damping) * np.diag(np.linalg.norm(projected[:, 1:], axis=0) + 1e-9)
        A = np.vstack((projected[:, 1:], smoothness, ridge))
        b = np.concatenate((projected[:, 0], -smoothness @ point.theta, np.zeros(len(ridge))))
        move = _bounded_step(A, b, low - point.theta, high - point.theta)
        theta = np.clip(point.theta + move, low, high)
        _, moves = runs.project(slopes, columns[:, :1] - columns[:, 1:] @ move[:, None])
        tried = _point(runs, hypothesis, theta, _moved(point.starts, moves))
        starts = _moved(tried.starts, runs.project(tried.slopes, tried.residual[:, None])[1])
        residual = runs.reading - runs.runs(hypothesis.terms(theta, runs.problem), starts)
        if loss(residual, scale) < loss(tried.residual, scale):
            tried = replace(tried, starts=starts, residual=residual)
        if _objective(hypothesis, runs, theta, tried.residual, scale) < before:
            return tried, max(damping / _FACTOR, _LEAST_DAMPING)
        damping *= _FACTOR
    return None, damping


def _objective(hypothesis: Hypothesis, runs: FreeRuns, theta: FloatArray, residual: FloatArray, scale: float) -> float:
    """Loss over c² and smoothness penalty [1]."""
    penalty = hypothesis.smoothness(runs.problem) @ theta
    return loss(residual, scale) / scale**2 + float(penalty @ penalty)


def _bounded_step(A: FloatArray, b: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Least squares of A x = b within bounds, shape (k,)."""
    if not A.shape[1]:
        return np.zeros(0)
    return np.asarray(lsq_linear(A, b, bounds=(np.minimum(low, -INSIDE), np.maximum(high, INSIDE)), method="bvls").x)


def _jacobian(runs: FreeRuns, hypothesis: Hypothesis, point: _Point, width: float) -> FloatArray:
    """Derivatives of the runs by the scaled parameters, by differences over `width`; shape (readings, k)."""
    high = hypothesis.bounds(runs.problem)[1]
    here = runs.reading - point.residual
    columns = []
    for i, recording in enumerate(hypothesis.recording_of(runs.problem)):
        step = np.zeros(len(point.theta))
        step[i] = width if point.theta[i] + width <= high[i] else -width
        terms = hypothesis.terms(point.theta + step, runs.problem)
        if recording is None:
            moved = runs.runs(terms, point.starts)
        else:
            moved = runs.moved_of(runs.problem.recordings[recording], terms, point.starts, here)
        columns.append((moved - here) / step[i])
    return np.column_stack(columns) if columns else np.zeros((len(here), 0))


def _covariance(runs: FreeRuns, hypothesis: Hypothesis, point: _Point) -> FloatArray:
    """Sandwich covariance of the parameters in their units, shape (k, k); infinite where free runs beside them are."""
    weight = weights(point.residual, scale_of(point.residual))
    columns = np.column_stack((point.residual, _jacobian(runs, hypothesis, point, _NARROW))) * weight[:, None]
    projected, _ = runs.project(point.slopes * weight[:, None], columns)
    if not np.all(np.isfinite(projected)):
        return np.diag(np.full(len(point.theta), np.inf))
    residual, jacobian = projected[:, 0], projected[:, 1:]
    scores = runs.sums(jacobian * residual[:, None])
    return sandwich_covariance(jacobian, scores, hypothesis.scale(runs.problem))
