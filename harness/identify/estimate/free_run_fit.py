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
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from analytic.motion import FloatArray
from harness.identify.estimate.fit import PROCESS_NOISE, Estimator, Fit
from harness.identify.estimate.screening import INSIDE
from harness.identify.estimate.window_errors import bounded
from harness.identify.filter.free_run import free_runs, start_derivatives
from harness.identify.filter.run import beam_over, dynamics
from harness.identify.problem.hypothesis import Hypothesis, Terms, own_key
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import AHEAD, KNOWN, Window

_FIRST = 0.6  # over which a line through the readings gives the first guess of a start [s]
_CONVERGED = 2e-3  # relative decrease of the loss
_LEAST_SCALE = 1e-4  # of the loss [m]
_MEDIAN = 0.6745  # median absolute value of a standard normal variable
_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-6, 1e4  # at first; the bounds of it
_FACTOR = 6.0  # by which the damping changes
_RIDGE = 1e-9  # keeps starts on which nothing depends where they are
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


class _Group(NamedTuple):
    """Windows of one recording: the thinned recording, and the stamps at which each window begins and ends."""

    recording: PreparedRecording
    first: NDArray[np.int64]
    last: NDArray[np.int64]


class FreeRuns:
    """The readings in windows, thinned, and free runs to compare with them."""

    def __init__(self, problem: Problem, windows: Sequence[Window]) -> None:
        self.problem = problem
        by_recording: dict[int, list[Window]] = {}
        for window in windows:
            by_recording.setdefault(id(window.recording), []).append(window)
        self._groups = []
        for group in by_recording.values():
            thin = group[0].recording.thinned
            begin = np.array([window.begin for window in group])
            first, last = np.searchsorted(thin.time, np.array([begin, begin + KNOWN + AHEAD]))
            self._groups.append(_Group(thin, first, last))
        self.reading = np.concatenate(
            [group.recording.reading[a:b] for group in self._groups for a, b in zip(*group[1:], strict=True)]
        )
        sizes = np.concatenate([group.last - group.first for group in self._groups])
        self.windows = len(sizes)
        self._window = np.repeat(np.arange(len(sizes)), sizes)
        self._begin = np.concatenate(([0], np.cumsum(sizes)[:-1]))

    def first_starts(self) -> FloatArray:
        """Starts by a line through the first readings of each window, shape (windows, 2)."""
        starts = []
        for group in self._groups:
            time, reading = group.recording.time, group.recording.reading
            for first, last in zip(group.first, group.last, strict=True):
                end = min(max(int(np.searchsorted(time, time[first] + _FIRST)), first + 4), last)
                velocity, position = np.polyfit(time[first:end] - time[first], reading[first:end], 1)
                starts.append((position, velocity))
        return np.array(starts)

    def runs(self, terms: Terms, starts: FloatArray) -> FloatArray:
        """Recorded positions of the runs, shape (readings,) [m]."""
        return self._runs(terms, starts, self._groups, slopes=False)[0]

    def moved_of(self, recording: PreparedRecording, terms: Terms, starts: FloatArray, here: FloatArray) -> FloatArray:
        """`runs` where the terms differ from those of the runs `here` in what one recording has of its own alone."""
        moved, readings, windows = here.copy(), 0, 0
        for group in self._groups:
            rows = slice(readings, readings + int(np.sum(group.last - group.first)))
            if group.recording is recording.thinned:
                begin = starts[windows : windows + len(group.first)]
                moved[rows] = self._runs(terms, begin, [group], slopes=False)[0]
            readings, windows = rows.stop, windows + len(group.first)
        return moved

    def runs_and_slopes(self, terms: Terms, starts: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same, and their derivatives by the starts, shape (readings, 2) [1], [s]."""
        return self._runs(terms, starts, self._groups, slopes=True)

    def _runs(
        self, terms: Terms, starts: FloatArray, groups: Sequence[_Group], *, slopes: bool
    ) -> tuple[FloatArray, FloatArray]:
        sensor = self.problem.sensor(terms.effects)
        runs, derivatives, at = [], [], 0
        position = sensor.position(starts[:, 0])
        begins = np.column_stack((position, starts[:, 1] / sensor.slope(position)))
        for recording, first, last in groups:
            p, table = dynamics(self.problem, recording, terms, terms.own_of(recording.name))
            begin = begins[at : at + len(first)]
            windows = first, last, beam_over(recording, table), p, sensor.lag, begin
            runs.append(free_runs(*windows))
            if slopes:
                derivatives.append(start_derivatives(*windows, runs[-1]))
            at += len(first)
        positions = bounded(np.concatenate(runs))
        if not slopes:
            return sensor.curve(positions), np.zeros((0, 2))
        return sensor.curve(positions), bounded(np.concatenate(derivatives))

    def sums(self, values: FloatArray) -> FloatArray:
        """Sums over the readings of each window, shape (windows, …)."""
        return np.asarray(np.add.reduceat(values, self._begin, axis=0))

    def project(self, slopes: FloatArray, columns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """`columns`, shape (readings, c), without what starts explain, and the changes of starts, (windows, 2, c)."""
        gram = self.sums(slopes[:, :, None] * slopes[:, None, :]) + _RIDGE * np.eye(2)
        moves = np.linalg.solve(gram, self.sums(slopes[:, :, None] * columns[:, None, :]))
        rest: FloatArray = columns - np.einsum("ij,ijc->ic", slopes, moves[self._window])
        return rest, np.asarray(moves)


@dataclass(frozen=True)
class FreeRunFit:
    """A fit, and the residuals of its free runs, shape (readings,) [m]."""

    fit: Fit
    residual: FloatArray

    def loss(self, scale: float) -> float:
        """Sum of the soft L1 losses with c = `scale` [m²]."""
        return _loss(self.residual, scale)

    @property
    def scale(self) -> float:
        """c of this fit's own residuals [m]."""
        return _scale(self.residual)


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
    scale = min(_scale(point.residual) for point in begun)
    begun = sorted(begun, key=lambda point: _loss(point.residual, scale))
    followed = begun[: _FOLLOWED if effort is Effort.FULL else 1]
    widths, steps = _EFFORTS[effort]
    ends = [_descend(runs, hypothesis, point, widths, steps) for point in followed]
    scale = min(_scale(point.residual) for point in ends)
    best = min(ends, key=lambda point: _loss(point.residual, scale))
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
    tail = [*own, *(hypothesis.spline.nodes if hypothesis.spline else [])]
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
            scale = _scale(point.residual)
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
    weight = _weights(point.residual, scale) / scale
    slopes = point.slopes * weight[:, None]
    columns = np.column_stack((point.residual, _jacobian(runs, hypothesis, point, width))) * weight[:, None]
    projected, _ = runs.project(slopes, columns)
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
        if _loss(residual, scale) < _loss(tried.residual, scale):
            tried = replace(tried, starts=starts, residual=residual)
        if _objective(hypothesis, runs, theta, tried.residual, scale) < before:
            return tried, max(damping / _FACTOR, _LEAST_DAMPING)
        damping *= _FACTOR
    return None, damping


def _objective(hypothesis: Hypothesis, runs: FreeRuns, theta: FloatArray, residual: FloatArray, scale: float) -> float:
    """Loss over c² and smoothness penalty [1]."""
    penalty = hypothesis.smoothness(runs.problem) @ theta
    return _loss(residual, scale) / scale**2 + float(penalty @ penalty)


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
    """Sandwich covariance of the parameters in their units, shape (k, k)."""
    count = runs.windows
    weight = _weights(point.residual, _scale(point.residual))
    columns = np.column_stack((point.residual, _jacobian(runs, hypothesis, point, _NARROW))) * weight[:, None]
    projected, _ = runs.project(point.slopes * weight[:, None], columns)
    residual, jacobian = projected[:, 0], projected[:, 1:]
    scores = runs.sums(jacobian * residual[:, None])
    bread = np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)
    scale = hypothesis.scale(runs.problem)
    correction = count / max(count - len(point.theta), 1)
    return np.asarray(correction * (bread @ (scores.T @ scores) @ bread) * np.outer(scale, scale))


def _weights(residual: FloatArray, scale: float) -> FloatArray:
    """Roots of the weights with which least squares follow the soft L1, same shape."""
    return np.asarray((1.0 + (residual / scale) ** 2) ** -0.25)


def _loss(residual: FloatArray, scale: float) -> float:
    """Sum of the soft L1 losses [m²]."""
    return float(np.sum(2.0 * scale**2 * (np.sqrt(1.0 + (residual / scale) ** 2) - 1.0)))


def _scale(residual: FloatArray) -> float:
    """c of the soft L1: the standard deviation that the median residual has of normal ones [m]."""
    return max(float(np.median(np.abs(residual))) / _MEDIAN, _LEAST_SCALE)
