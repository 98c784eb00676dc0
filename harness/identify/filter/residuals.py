"""Normalised innovations as residuals of least squares, and their finite-difference Jacobian."""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from harness.identify.filter.ekf import negative_two_log_likelihood, penalty
from harness.identify.filter.run import innovations
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem


class Residuals:
    """Normalised innovations as a function of the scaled parameters θ, shape (k,), at a fixed process noise."""

    def __init__(self, problem: Problem, hypothesis: Hypothesis, process_noise: float) -> None:
        self._problem, self._hypothesis, self.process_noise = problem, hypothesis, process_noise
        self._lowest, self._highest = hypothesis.bounds(problem)
        self._latest: tuple[bytes, FloatArray, FloatArray] | None = None

    def _predicted(self, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Innovations [m] and their variances [m²], shape (readings,) each; cached for the latest θ."""
        key = theta.tobytes()
        if self._latest is None or self._latest[0] != key:
            at = self._hypothesis.terms(theta, self._problem)
            self._latest = key, *innovations(self._problem, at, self.process_noise)
        return self._latest[1:]

    def at(self, theta: FloatArray) -> FloatArray:
        """Residuals sign(z) √ρ(z) of the normalised innovations z, shape (readings,)."""
        innovation, variance = self._predicted(theta)
        ratio = innovation / np.sqrt(variance)
        return np.sign(ratio) * np.sqrt(penalty(ratio))

    def deviance(self, theta: FloatArray) -> float:
        """Deviance."""
        return negative_two_log_likelihood(*self._predicted(theta))

    def slopes(self, theta: FloatArray, step: FloatArray | float) -> FloatArray:
        """Jacobian of `at` by forward differences over `step`, shape (k,) or one for all; shape (readings, k)."""
        here = self.at(theta)
        inside = (theta + step <= self._highest) & (theta + step >= self._lowest)
        moves = np.diag(np.where(inside, step, -step))
        return np.column_stack([(self.at(theta + move) - here) / move.sum() for move in moves])

    def chords(self, theta: FloatArray, reach: FloatArray) -> FloatArray:
        """Jacobian of `at` by differences over ± `reach`, shape (k,), within the bounds; shape (readings, k)."""
        low, high = np.maximum(theta - reach, self._lowest), np.minimum(theta + reach, self._highest)
        ends = [(np.where(axis, low, theta), np.where(axis, high, theta)) for axis in np.eye(len(theta), dtype=bool)]
        rises = [self.at(above) - self.at(below) for below, above in ends]
        return np.column_stack(rises) / (high - low)
