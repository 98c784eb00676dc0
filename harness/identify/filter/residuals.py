"""Normalised innovations as residuals of least squares, and their finite-difference Jacobian."""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from harness.identify.filter.dynamics import Dynamics
from harness.identify.filter.ekf import negative_two_log_likelihood, penalty
from harness.identify.filter.run import innovations, innovations_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.threads import in_threads


class Residuals:
    """Normalised innovations as a function of the scaled parameters θ, shape (k,), at a fixed process noise."""

    def __init__(self, problem: Problem, hypothesis: Hypothesis, process_noise: float) -> None:
        self._problem, self._hypothesis, self.process_noise = problem, hypothesis, process_noise
        self._lowest, self._highest = hypothesis.bounds(problem)
        self._latest: tuple[bytes, FloatArray, FloatArray] | None = None
        self._recordings = hypothesis.recording_of(problem)

    def _predicted(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Innovations [m] and their variances [m²], shape (readings,) each; cached for the latest θ."""
        key, latest = theta.tobytes(), self._latest
        if latest is None or latest[0] != key:
            at = self._hypothesis.terms(theta, self._problem)
            latest = self._latest = key, *innovations(self._problem, at, self.process_noise)
        return latest[1:]

    def at(self, theta: FloatArray) -> FloatArray:
        """Residuals sign(z) √ρ(z) of the normalised innovations z, shape (readings,)."""
        return _normalised(*self._predicted(theta))

    def deviance(self, theta: FloatArray) -> float:
        """Deviance."""
        return negative_two_log_likelihood(*self._predicted(theta))

    def jacobian(self, theta: FloatArray, step: FloatArray | float) -> FloatArray:
        """Jacobian of `at` by forward differences over `step`, shape (k,) or one for all; shape (readings, k).

        A step to where the filter diverges, and residuals are not numbers, tells no slope: its column is 0.
        """
        here = self.at(theta)
        inside = (theta + step <= self._highest) & (theta + step >= self._lowest)
        moves = np.where(inside, step, -step)
        ends = list(enumerate(theta + np.diag(moves)))
        slopes = np.column_stack(in_threads(lambda end: self._rise(theta, end[1], end[0], here), ends)) / moves
        return np.where(np.all(np.isfinite(slopes), axis=0), slopes, 0.0)

    def jacobian_over(self, theta: FloatArray, reach: FloatArray) -> FloatArray:
        """Jacobian of `at` by differences over ± `reach`, shape (k,), within the bounds; shape (readings, k)."""
        low, high = np.maximum(theta - reach, self._lowest), np.minimum(theta + reach, self._highest)
        axes = np.eye(len(theta), dtype=bool)

        def rise(number: int) -> FloatArray:
            return self._rise(np.where(axes[number], low, theta), np.where(axes[number], high, theta), number)

        return np.column_stack(in_threads(rise, range(len(theta)))) / (high - low)

    def _rise(self, start: FloatArray, end: FloatArray, number: int, here: FloatArray | None = None) -> FloatArray:
        """Change of `at` between two θ that differ in the parameter of this number, shape (readings,).

        What one recording has of its own changes no other, which then need not be run: with a parameter for each of the
        recordings, a Jacobian would else take time with their square.

        Args:
            here: `at(start)`, where it is known.
        """
        recording = self._recordings[number]
        if recording is None:
            return self.at(end) - (self.at(start) if here is None else here)
        rows, one = self._rows(recording), self._problem.recordings[recording]
        rise = np.zeros(sum(int(each.judged.sum()) for each in self._problem.recordings))
        rise[rows] = self._of(one, end) - (self._of(one, start) if here is None else here[rows])
        return rise

    def change(self, theta: FloatArray, number: int, other: PreparedRecording) -> tuple[slice, FloatArray]:
        """Rows of the recording of this number in `at`, and their change where `other`, as long, is in its place."""
        rows = self._rows(number)
        return rows, self._of(other, theta) - self.at(theta)[rows]

    def _rows(self, number: int) -> slice:
        sizes = [int(one.judged.sum()) for one in self._problem.recordings]
        begin = sum(sizes[:number])
        return slice(begin, begin + sizes[number])

    def _of(self, recording: PreparedRecording, theta: FloatArray) -> FloatArray:
        """`at` for the readings of one recording alone."""
        terms = self._hypothesis.terms(theta, self._problem)
        return _normalised(*innovations_of(Dynamics(self._problem, terms), recording, self.process_noise))


def _normalised(innovation: FloatArray, variance: FloatArray) -> FloatArray:
    """Residuals sign(z) √ρ(z) of the normalised innovations z, same shape."""
    ratio = innovation / np.sqrt(variance)
    return np.sign(ratio) * np.sqrt(penalty(ratio))
