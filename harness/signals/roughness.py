"""The stiffness of the prior over time: the density of the white third derivative, estimated along the record.

A servo alternates rests and quick moves. One density for a whole record is a compromise that passes noise of a resting
beam and rounds the corners of a move. Here the log density is a random walk over knots, and its most probable path
is found by Fisher scoring: gradient and information of each knot are sums of what the smoother returns per step
(`kalman_smoother`), the walk couples neighbours, and one tridiagonal solve makes a step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.motion import FloatArray
from harness.signals.spline_smoother import LOG_DENSITIES

# A servo starts and stops within a tenth of a second; closer knots cost time and resolve no more.
KNOT_SPACING = 0.05  # [s]
# The walk's standard deviation after 1 s, in log density: from rest to motion and back is about e¹⁵ (docs/drive.md).
WALK_STD = 12.0
_START = 1.0
_LONGEST_STRIDE = 1.0  # of the log density per scoring step: the quadratic model holds for about that


@dataclass(frozen=True)
class Stiffness:
    """The log density over time.

    Attributes:
        knot: index of the knot whose density a step has, shape (n − 1,).
        log_density: at the knots, shape (m,) [log unit²/s⁵]; changed in place by `scoring_step`.
        coupling: inverse variance of the walk between neighbouring knots, shape (m − 1,).
        lowest: log density below which no knot goes, shape (m,) [log unit²/s⁵].
    """

    knot: NDArray[np.int64]
    log_density: FloatArray
    coupling: FloatArray
    lowest: FloatArray

    @classmethod
    def over(cls, time: FloatArray) -> Stiffness:
        """Knots for the stamps `time`, shape (n,) [s], all at the same density."""
        begin = np.floor((time[:-1] - time[0]) / KNOT_SPACING + 1e-9)
        cells, knot = np.unique(begin, return_inverse=True)
        coupling = 1.0 / (WALK_STD**2 * KNOT_SPACING * np.diff(cells))
        m = len(cells)
        return cls(knot.astype(np.int64), np.full(m, _START), coupling, np.full(m, LOG_DENSITIES[0]))

    @classmethod
    def constant(cls, time: FloatArray, lowest: float = LOG_DENSITIES[0]) -> Stiffness:
        """One density for all the stamps `time`, shape (n,) [s], whose logarithm is no lower [log unit²/s⁵]."""
        return cls(np.zeros(len(time) - 1, np.int64), np.full(1, _START), np.empty(0), np.full(1, lowest))


@njit(cache=True)
def scoring_step(
    knot: NDArray[np.int64],
    coupling: FloatArray,
    lowest: FloatArray,
    energy: FloatArray,
    dof: FloatArray,
    log_density: FloatArray,
) -> float:
    """One step of Fisher scoring on `log_density`, in place; return its largest change.

    With θ the log density, ∂ log evidence / ∂θ = ½ Σ (energy − dof) over the knot's steps (`kalman_smoother`); the
    Fisher information is ½ Σ dof, minus the second derivative where energy equals dof.
    """
    m = len(log_density)
    diagonal, stride, ratio = np.full(m, 1e-3), np.zeros(m), np.zeros(m)
    for k in range(len(knot)):
        stride[knot[k]] += 0.5 * (energy[k] - dof[k])
        diagonal[knot[k]] += 0.5 * max(dof[k], 0.0)
    for j in range(m - 1):
        pull = coupling[j] * (log_density[j + 1] - log_density[j])
        stride[j] += pull
        stride[j + 1] -= pull
        diagonal[j] += coupling[j]
        diagonal[j + 1] += coupling[j]
    for j in range(m):  # Thomas' algorithm
        if j > 0:
            diagonal[j] -= coupling[j - 1] * ratio[j - 1]
            stride[j] += coupling[j - 1] * stride[j - 1]
        if j < m - 1:
            ratio[j] = coupling[j] / diagonal[j]
        stride[j] /= diagonal[j]
    longest = 0.0
    for j in range(m - 1, -1, -1):
        if j < m - 1:
            stride[j] += ratio[j] * stride[j + 1]
        step = min(max(stride[j], -_LONGEST_STRIDE), _LONGEST_STRIDE)
        after = min(max(log_density[j] + step, lowest[j]), LOG_DENSITIES[1])
        longest = max(longest, abs(after - log_density[j]))
        log_density[j] = after
    return longest
