"""How stiff the prior is, and when: the density of the white third derivative, learnt along the record.

A servo alternates rests and quick moves. One density for a whole record is a compromise that lets a resting beam
tremble and rounds the corners of a move. Here the log density is a random walk over knots, and its most probable path
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

# A servo starts and stops within a tenth of a second; shorter spells cost time and say no more.
SPELL = 0.05
# The walk's standard deviation after 1 s, in log density: from rest to motion and back is about e¹⁵ (docs/drive.md).
RESTLESSNESS = 12.0
_START = 1.0
_LONGEST_STRIDE = 1.0  # of the log density per scoring step: the quadratic model holds for about that


@dataclass(frozen=True)
class Stiffness:
    """The path of the log density.

    Attributes:
        knot: index of the knot whose density a step has, shape (n − 1,).
        log_density: at the knots, shape (m,) [log unit²/s⁵]; changed in place by `rescore`.
        coupling: of neighbouring knots, the walk's inverse variance, shape (m − 1,).
    """

    knot: NDArray[np.int64]
    log_density: FloatArray
    coupling: FloatArray

    @classmethod
    def over(cls, time: FloatArray) -> Stiffness:
        """Knots for the stamps `time`, shape (n,) [s], all at the same density."""
        begin = np.floor((time[:-1] - time[0]) / SPELL + 1e-9)
        spells, knot = np.unique(begin, return_inverse=True)
        coupling = 1.0 / (RESTLESSNESS**2 * SPELL * np.diff(spells))
        return cls(knot.astype(np.int64), np.full(len(spells), _START), coupling)

    @classmethod
    def constant(cls, time: FloatArray) -> Stiffness:
        """One density for all the stamps `time`, shape (n,) [s]."""
        return cls(np.zeros(len(time) - 1, np.int64), np.full(1, _START), np.empty(0))


@njit(cache=True)
def rescore(
    knot: NDArray[np.int64],
    coupling: FloatArray,
    surprise: FloatArray,
    freedom: FloatArray,
    log_density: FloatArray,
    lowest: float = LOG_DENSITIES[0],
) -> float:
    """One Fisher scoring step of `log_density`, in place; return its largest stride.

    With θ the log density, ∂ log evidence / ∂θ = ½ Σ (surprise − freedom) over the knot's steps; the information is
    ½ Σ freedom, what the gradient's second derivative amounts to where surprise equals freedom. No knot goes below
    `lowest`.
    """
    m = len(log_density)
    diagonal, stride, ratio = np.full(m, 1e-3), np.zeros(m), np.zeros(m)
    for k in range(len(knot)):
        stride[knot[k]] += 0.5 * (surprise[k] - freedom[k])
        diagonal[knot[k]] += 0.5 * max(freedom[k], 0.0)
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
        after = min(max(log_density[j] + step, lowest), LOG_DENSITIES[1])
        longest = max(longest, abs(after - log_density[j]))
        log_density[j] = after
    return longest
