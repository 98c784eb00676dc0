"""How far a new recording sets a rival apart: its numbers and its process noise are fitted to what is expected.

A model that lacks something lays it to the process noise, as far as that pays: the filter then follows the readings
instead of the law. Half of the work is therefore to know what a larger process noise costs and what it takes away. For
a ball on a beam, a double integrator read at even intervals, both are known in closed form once the filter is steady:
innovations at one density follow from those at another by a linear filter of second order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_discrete_are, solve_discrete_lyapunov
from scipy.signal import lfilter

from analytic.motion import FloatArray
from harness.identify.design.closed_loop import SimulatedRun, repeated
from harness.identify.estimate.fit import Fit
from harness.identify.filter.ekf import penalty
from harness.identify.filter.run import run_filter
from harness.identify.problem.hypothesis import Terms
from harness.identify.problem.problem import Problem

_STEP = 1e-2  # of slopes, in scaled numbers
_SHARES = (1.0, 0.5, 0.25)  # of a Gauss–Newton step, tried until one helps
_PHASES = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
_RANK = 1e-10  # of slopes, below which a number is held by nothing and stays
# Process noise that a rival may come to [m²/s³], in steps of a factor of four: the deviance is flat around its least,
# and half a step from there costs less than one.
_LARGEST, _APART = 1e-1, 1.4
_LEAST_NOISE = 1e-14  # of a reading [m²]: of readings without any, no filter has a steady state
_OPEN = 1e-4  # with which the filter runs: wrong numbers then leave innovations of a few deviations at most [m²/s³]


@dataclass(frozen=True)
class SteadyFilters:
    """Steady filters of one sensor, one for each density of the process noise.

    Attributes:
        density: shape (d,), the first is the true one [m²/s³].
        innovation_variance: as the filter takes it, shape (d,) [m²].
        cost: what each reading adds to the deviance beyond what it adds at the true density, shape (d,).
        poles: denominator of the transfer from the path's error to innovations, shape (d, 3).
        open: the same with which recordings are filtered, shape (3,).
    """

    process_noise: FloatArray
    innovation_variance: FloatArray
    cost: FloatArray
    poles: FloatArray
    open: FloatArray

    @classmethod
    def of(cls, interval: float, noise: float, process_noise: float) -> SteadyFilters:
        """For readings every `interval` [s] of variance `noise` [m²], where the process noise truly has `density`."""
        noise = max(noise, _LEAST_NOISE)
        count = max(math.ceil(math.log(_LARGEST / process_noise) / _APART), 0) + 1
        process_noises = process_noise * np.exp(_APART * np.arange(count))
        each = [_steady(interval, noise, one, process_noise) for one in process_noises]
        variance = np.array([one[0] for one in each])
        cost = np.array([math.log(one[0]) + one[1] / one[0] for one in each])
        poles = np.array([one[2] for one in each])
        return cls(process_noises, variance, cost - cost[0], poles, _steady(interval, noise, _OPEN, process_noise)[2])

    def filtered(self, misses: FloatArray) -> FloatArray:
        """What innovations, shape (n, c), are at every density, shape (d, n, c)."""
        return np.array([lfilter(self.open, poles, misses, axis=0) for poles in self.poles])

    def deviance(self, misses: FloatArray) -> float:
        """Of mean innovations, shape (n,) [m], beyond that of the true filter, at the density where it is least."""
        each = self.filtered(misses[:, None])[:, :, 0] / np.sqrt(self.innovation_variance)[:, None]
        return float(np.min(penalty(each).sum(axis=1) + self.cost * len(misses)))

    def step(self, misses: FloatArray, slopes: FloatArray) -> FloatArray:
        """Of numbers, shape (k,), that takes the deviance furthest down; slopes of the innovations, shape (n, k)."""
        best, least = np.zeros(slopes.shape[1]), math.inf
        each = self.filtered(np.column_stack((misses, slopes))) / np.sqrt(self.innovation_variance)[:, None, None]
        for ratio, cost in zip(each, self.cost, strict=True):
            here, slope = ratio[:, 0], ratio[:, 1:]
            step = -np.linalg.pinv(slope.T @ slope, rcond=_RANK, hermitian=True) @ (slope.T @ here)
            deviance = float(penalty(here + slope @ step).sum()) + cost * len(misses)
            if deviance < least:
                best, least = step, deviance
        return best


def _steady(interval: float, noise: float, process_noise: float, true: float) -> tuple[float, float, FloatArray]:
    """Variance of innovations as a filter of this density takes it, as it truly is [m²], and the filter's poles."""
    F = np.array([[1.0, interval], [0.0, 1.0]])
    white = np.array([[interval**3 / 3.0, interval**2 / 2.0], [interval**2 / 2.0, interval]])
    P = solve_discrete_are(F.T, np.array([[1.0], [0.0]]), process_noise * white, np.array([[noise]]))
    variance = float(P[0, 0]) + noise
    gain = F @ P[:, :1] / variance
    closed = F - gain @ np.array([[1.0, 0.0]])
    error = solve_discrete_lyapunov(closed, true * white + noise * gain @ gain.T)
    return (
        variance,
        float(error[0, 0]) + noise,
        np.array([1.0, -np.trace(closed), np.linalg.det(closed)]),
    )


def mean_innovations(problem: Problem, made: SimulatedRun, values: Terms) -> FloatArray:
    """What a model misses of a recording without noise, shape (n − 1,) [m], at the process noise of `Noises.open`."""
    at = repeated(values)
    out = run_filter(problem, made.recording, at, _OPEN, phase=float(at.phases[0]), reading=made.reading)
    return out.innovation[1:]


def rival_deviance(
    problem: Problem, made: SimulatedRun, rival: Fit, steady_filters: SteadyFilters, *, rounds: int = 1
) -> float:
    """What a new recording adds to a rival's deviance over that of the model which the recording is expected from.

    The rival's numbers and process noise are fitted to the new recording alone. Recordings diagnosed together are
    separated by at least the sum of what each of them gives: a rival's numbers then have to do for all.

    Args:
        noises: for the problem's sensor, the model's process noise first.
        rounds: Gauss–Newton steps.
    """
    alone = replace(problem, recordings=(made.recording,))
    hypothesis = rival.hypothesis
    low, high = hypothesis.bounds(alone)

    def misses(theta: FloatArray) -> FloatArray:
        return mean_innovations(problem, made, hypothesis.terms(theta, alone))

    theta = _carried(problem, alone, rival)
    if hypothesis.turning:
        turned = theta + np.outer(_PHASES, np.arange(len(theta)) == len(hypothesis.parameters))
        theta = min(turned, key=lambda each: float(np.sum(misses(each) ** 2)))
    here = misses(theta)
    least = steady_filters.deviance(here)
    for _ in range(rounds if len(theta) else 0):
        moves = np.diag(np.where(theta + _STEP <= high, _STEP, -_STEP))
        slopes = np.column_stack([(misses(theta + move) - here) / move.sum() for move in moves])
        step = steady_filters.step(here, slopes)
        for share in _SHARES:
            end = np.clip(theta + share * step, low, high)
            there = misses(end)
            deviance = steady_filters.deviance(there)
            if deviance < least:
                theta, here, least = end, there, deviance
                break
        else:
            break
    return least


def _carried(problem: Problem, alone: Problem, rival: Fit) -> FloatArray:
    """A rival's scaled numbers for a new recording, in which the ball lies as nobody knows."""
    hypothesis = rival.hypothesis
    effects, more = len(hypothesis.parameters), hypothesis.size(problem) - hypothesis.size(alone)
    if not hypothesis.turning:
        return rival.theta
    return np.concatenate((rival.theta[:effects], [0.0], rival.theta[effects + more + 1 :]))


def open_loop_drift(problem: Problem, found: Fit, made: SimulatedRun) -> float:
    """How far the ball may be from where it is expected at the end, if nobody corrects the angle [m].

    The process noise, integrated twice, and what the fit leaves open, one standard deviation along each axis of it.
    """
    alone = replace(problem, recordings=(made.recording,))
    theta, size = _carried(problem, alone, found), len(found.hypothesis.parameters)
    scale = found.hypothesis.scale(alone)
    low, high = found.hypothesis.bounds(alone)
    values, vectors = np.linalg.eigh(found.covariance[:size, :size] / np.outer(scale[:size], scale[:size]))
    square = 0.0
    for value, axis in zip(values, vectors.T, strict=True):
        moved = theta.copy()
        moved[:size] += math.sqrt(max(value, 0.0)) * axis
        at = repeated(found.hypothesis.terms(np.clip(moved, low, high), alone))
        out = run_filter(problem, made.recording, at, found.process_noise, phase=0.0)
        square += float(out.recorded[-1] - made.reading[-1]) ** 2
    noise = found.process_noise * (made.recording.time[-1] - made.recording.time[0]) ** 3 / 3.0
    return math.sqrt(problem.settings.overdispersion * square + noise)
