"""Innovations over their standard deviations as residuals: what least squares make small, and their slopes."""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from harness.identify.filter.ekf import negative_two_log_likelihood, penalty
from harness.identify.filter.run import innovations
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem


class Misses:
    """Innovations over their standard deviations as a function of the scaled numbers, at a given process noise."""

    def __init__(self, problem: Problem, hypothesis: Hypothesis, density: float) -> None:
        self._problem, self._hypothesis, self.density = problem, hypothesis, density
        self._lowest, self._highest = hypothesis.bounds(problem)
        self._latest: tuple[bytes, FloatArray, FloatArray] | None = None

    def _predicted(self, numbers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Innovations [m] and variances [m²], shape (readings,) each; the latest are kept, for slopes ask again."""
        key = numbers.tobytes()
        if self._latest is None or self._latest[0] != key:
            at = self._hypothesis.read(numbers, self._problem)
            self._latest = key, *innovations(self._problem, at, self.density)
        return self._latest[1:]

    def at(self, numbers: FloatArray) -> FloatArray:
        """Signed roots of the penalties, shape (readings,)."""
        innovation, variance = self._predicted(numbers)
        ratio = innovation / np.sqrt(variance)
        return np.sign(ratio) * np.sqrt(penalty(ratio))

    def deviance(self, numbers: FloatArray) -> float:
        """−2 log likelihood, but for a constant."""
        return negative_two_log_likelihood(*self._predicted(numbers))

    def slopes(self, numbers: FloatArray, step: FloatArray | float) -> FloatArray:
        """Differences of `at` over a step of each number, shape (readings, k)."""
        here = self.at(numbers)
        inside = (numbers + step <= self._highest) & (numbers + step >= self._lowest)
        moves = np.diag(np.where(inside, step, -step))
        return np.column_stack([(self.at(numbers + move) - here) / move.sum() for move in moves])

    def chords(self, numbers: FloatArray, reach: FloatArray) -> FloatArray:
        """Slopes of `at` between `reach` below and above each scaled number, shape (k,), as far as bounds go; shape
        (readings, k)."""
        low, high = np.maximum(numbers - reach, self._lowest), np.minimum(numbers + reach, self._highest)
        ends = [(np.where(one, low, numbers), np.where(one, high, numbers)) for one in np.eye(len(numbers), dtype=bool)]
        rises = [self.at(above) - self.at(below) for below, above in ends]
        return np.column_stack(rises) / (high - low)
