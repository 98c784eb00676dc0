"""Expected deviance of a rival on a simulated recording, with its parameters and process noise fitted to it.

A misspecified model absorbs missing physics as process noise: the filter then follows the readings instead of the law.
The rival is therefore rated at the process noise of lowest deviance. For a double integrator with equidistant readings
the steady-state filter of each process noise density is known in closed form, and the innovations at one density follow
from those at another by a linear filter of second order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_discrete_are, solve_discrete_lyapunov

from analytic.motion import FloatArray
from harness.identify.design.closed_loop import SimulatedRun, repeated
from harness.identify.estimate.fit import Fit
from harness.identify.filter.ekf import penalty
from harness.identify.filter.run import run_filter
from harness.identify.problem.hypothesis import PHASE, Terms
from harness.identify.problem.problem import Problem

_STEP = 1e-2  # of finite differences, in scaled parameters
_SHARES = (1.0, 0.5, 0.25)  # of a Gauss–Newton step, tried until one lowers the deviance
_PHASES = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)  # initial values of φ₀ [rad]
_RANK = 1e-10  # relative size of singular values below which parameters are undetermined and stay as they are
# Largest process noise of a rival [m²/s³], and the log of the ratio of neighbouring densities, a factor of four: the
# deviance half a ratio from its minimum is less than 1 higher.
_LARGEST, _LOG_RATIO = 1e-1, 1.4
_SMALLEST_VARIANCE = 1e-14  # of a reading [m²]: without any noise the filter has no steady state
_OPEN = (
    1e-4  # process noise with which recordings are filtered: wrong parameters then give innovations of few σ [m²/s³]
)


@dataclass(frozen=True)
class SteadyFilters:
    """Steady-state filters of one sensor for d densities of the process noise.

    Attributes:
        process_noise: densities, the first the true one, shape (d,) [m²/s³].
        innovation_variance: S assumed by each filter, shape (d,) [m²].
        cost: expected deviance per reading minus that at the true density, shape (d,).
        poles: denominator of the transfer function from position error to innovation, shape (d, 3).
        open: the same at the process noise with which recordings are filtered, shape (3,).
    """

    process_noise: FloatArray
    innovation_variance: FloatArray
    cost: FloatArray
    poles: FloatArray
    open: FloatArray

    @classmethod
    def of(cls, interval: float, reading_variance: float, process_noise: float) -> SteadyFilters:
        """Filters for a sampling interval [s], a reading variance [m²] and a true process noise [m²/s³]."""
        R = max(reading_variance, _SMALLEST_VARIANCE)
        count = max(math.ceil(math.log(_LARGEST / process_noise) / _LOG_RATIO), 0) + 1
        densities = process_noise * np.exp(_LOG_RATIO * np.arange(count))
        assumed, actual, poles = zip(*(_steady(interval, R, q, process_noise) for q in densities), strict=True)
        variance = np.array(assumed)
        cost = np.log(variance) + np.array(actual) / variance
        return cls(densities, variance, cost - cost[0], np.array(poles), _steady(interval, R, _OPEN, process_noise)[2])

    def filtered(self, innovations: FloatArray) -> FloatArray:
        """Innovations at the process noise of `open`, shape (n, c), transformed to every density, shape (d, n, c)."""
        from scipy.signal import lfilter  # imported here because it brings scipy.stats along, for a third of a second

        return np.array([lfilter(self.open, poles, innovations, axis=0) for poles in self.poles])

    def deviance(self, innovations: FloatArray) -> float:
        """Lowest deviance over the densities minus that of the true filter, of mean innovations, shape (n,) [m]."""
        ratios = self.filtered(innovations[:, None])[:, :, 0] / np.sqrt(self.innovation_variance)[:, None]
        return float(np.min(penalty(ratios).sum(axis=1) + self.cost * len(innovations)))

    def step(self, innovations: FloatArray, slopes: FloatArray) -> FloatArray:
        """Gauss–Newton step of scaled parameters, shape (k,), at the best density, from the Jacobian, shape (n, k)."""
        best, least = np.zeros(slopes.shape[1]), math.inf
        columns = self.filtered(np.column_stack((innovations, slopes)))
        for ratio, cost in zip(columns / np.sqrt(self.innovation_variance)[:, None, None], self.cost, strict=True):
            here, slope = ratio[:, 0], ratio[:, 1:]
            step = -np.linalg.pinv(slope.T @ slope, rcond=_RANK, hermitian=True) @ (slope.T @ here)
            deviance = float(penalty(here + slope @ step).sum()) + cost * len(innovations)
            if deviance < least:
                best, least = step, deviance
        return best


def _steady(interval: float, R: float, process_noise: float, true: float) -> tuple[float, float, FloatArray]:
    """Innovation variance assumed by a steady-state filter, the actual one at the `true` density [m²], its poles."""
    F = np.array([[1.0, interval], [0.0, 1.0]])
    white = np.array([[interval**3 / 3.0, interval**2 / 2.0], [interval**2 / 2.0, interval]])
    P = solve_discrete_are(F.T, np.array([[1.0], [0.0]]), process_noise * white, np.array([[R]]))
    S = float(P[0, 0]) + R
    gain = F @ P[:, :1] / S
    closed = F - gain @ np.array([[1.0, 0.0]])
    error = solve_discrete_lyapunov(closed, true * white + R * gain @ gain.T)
    return S, float(error[0, 0]) + R, np.array([1.0, -np.trace(closed), np.linalg.det(closed)])


def mean_innovations(problem: Problem, run: SimulatedRun, values: Terms) -> FloatArray:
    """Innovations of a model on a noiseless recording, at the process noise of `SteadyFilters.open`, (n − 1,) [m]."""
    at = repeated(values)
    # By slopes: the mean over so much process noise is not the path of a ball without any.
    out = run_filter(problem, run.recording, at, _OPEN, own=at.own_at(0), reading=run.reading, points=False)
    return out.innovation[1:]


def rival_deviance(
    problem: Problem, run: SimulatedRun, rival: Fit, steady_filters: SteadyFilters, *, rounds: int = 1
) -> float:
    """Deviance of a rival minus that of the true model on a simulated recording.

    The rival's parameters and process noise are fitted to this recording alone, which gives a lower bound for several
    recordings together.

    Args:
        run: the recording that the true model predicts.
        steady_filters: for the problem's sensor, with the true process noise first.
        rounds: Gauss–Newton steps.
    """
    alone = replace(problem, recordings=(run.recording,))
    hypothesis = rival.hypothesis
    low, high = hypothesis.bounds(alone)

    def innovations(theta: FloatArray) -> FloatArray:
        return mean_innovations(problem, run, hypothesis.terms(theta, alone))

    theta = _for_new_recording(problem, alone, rival)
    if hypothesis.turning:
        starts = theta + np.outer(_PHASES, np.arange(len(theta)) == hypothesis.own_slice(PHASE, alone).start)
        theta = min(starts, key=lambda start: float(np.sum(innovations(start) ** 2)))
    here = innovations(theta)
    least = steady_filters.deviance(here)
    for _ in range(rounds if len(theta) else 0):
        moves = np.diag(np.where(theta + _STEP <= high, _STEP, -_STEP))
        slopes = np.column_stack([(innovations(theta + move) - here) / move.sum() for move in moves])
        step = steady_filters.step(here, slopes)
        for share in _SHARES:
            end = np.clip(theta + share * step, low, high)
            there = innovations(end)
            deviance = steady_filters.deviance(there)
            if deviance < least:
                theta, here, least = end, there, deviance
                break
        else:
            break
    return least


def _for_new_recording(problem: Problem, alone: Problem, fit: Fit) -> FloatArray:
    """Scaled parameters of a fit for a single new recording, with zeros for what the old ones have of their own."""
    hypothesis = fit.hypothesis
    effects, own = len(hypothesis.parameters), hypothesis.tail(problem)[0]
    return np.concatenate((fit.theta[:effects], np.zeros(hypothesis.tail(alone)[0]), fit.theta[effects + own :]))


def open_loop_drift(problem: Problem, found: Fit, run: SimulatedRun) -> float:
    """Standard deviation of the ball's final position if the angle is replayed without feedback [m].

    From process noise and angle error, integrated twice, and the parameters, along the principal axes of their
    covariance.
    """
    alone = replace(problem, recordings=(run.recording,))
    theta, size = _for_new_recording(problem, alone, found), len(found.hypothesis.parameters)
    scale = found.hypothesis.scale(alone)
    low, high = found.hypothesis.bounds(alone)
    values, vectors = np.linalg.eigh(found.covariance[:size, :size] / np.outer(scale[:size], scale[:size]))
    square = 0.0
    for value, axis in zip(values, vectors.T, strict=True):
        moved = theta.copy()
        moved[:size] += math.sqrt(max(value, 0.0)) * axis
        at = repeated(found.hypothesis.terms(np.clip(moved, low, high), alone))
        out = run_filter(problem, run.recording, at, found.process_noise, own=at.own_at(0))
        square += float(out.recorded[-1] - run.reading[-1]) ** 2
    noise = problem.with_angle(found.process_noise) * (run.recording.time[-1] - run.recording.time[0]) ** 3 / 3.0
    return math.sqrt(square + noise)
