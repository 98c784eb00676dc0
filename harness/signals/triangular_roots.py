"""Triangular roots L of covariances L Lᵀ."""

from __future__ import annotations

import math

from analytic.compiled import njit
from analytic.motion import FloatArray

PIVOT = 1e-12  # smallest pivot of a covariance, over its variances: no less than what rounding leaves


@njit(cache=True)
def root_of(covariance: FloatArray, L: FloatArray, first: int) -> None:
    """Cholesky factor of a covariance whose entries span decades, into L from row and column `first` on."""
    for i in range(len(covariance)):
        for j in range(i + 1):
            total = covariance[i, j]
            for a in range(j):
                total -= L[first + i, first + a] * L[first + j, first + a]
            if i == j:
                L[first + i, first + i] = math.sqrt(max(total, PIVOT * covariance[i, i]))
            else:
                root = L[first + j, first + j]
                L[first + i, first + j] = total / root if root > 0.0 else 0.0


@njit(cache=True)
def triangular(M: FloatArray, L: FloatArray) -> None:
    """Replace L, shape (m, m), by the triangular root of M Mᵀ, by modified Gram–Schmidt on the rows of M.

    Args:
        M: shape (m, n), n >= m; overwritten.
    """
    size, wide = M.shape
    for i in range(size):
        for j in range(i):
            L[i, j] = 0.0
            for c in range(wide):
                L[i, j] += M[i, c] * M[j, c]
            for c in range(wide):
                M[i, c] -= L[i, j] * M[j, c]
        square = 0.0
        for c in range(wide):
            square += M[i, c] ** 2
        L[i, i] = math.sqrt(square)
        inverse = 1.0 / L[i, i] if square > 0.0 else 0.0
        for c in range(wide):
            M[i, c] *= inverse
