"""Triangular roots L of covariances L Lᵀ."""

from __future__ import annotations

import math

from analytic.compiled import njit
from analytic.motion import FloatArray

_PIVOT = 1e-12  # smallest pivot of a covariance, over its variances: no less than what rounding leaves


@njit(cache=True)
def root_of(covariance: FloatArray, L: FloatArray, first: int) -> None:
    """Cholesky factor of a covariance whose entries span decades, into L from row and column `first` on."""
    for i in range(len(covariance)):
        for j in range(i + 1):
            total = covariance[i, j]
            for a in range(j):
                total -= L[first + i, first + a] * L[first + j, first + a]
            if i == j:
                L[first + i, first + i] = math.sqrt(max(total, _PIVOT * covariance[i, i]))
            else:
                root = L[first + j, first + j]
                L[first + i, first + j] = total / root if root > 0.0 else 0.0


@njit(cache=True)
def triangular(M: FloatArray, L: FloatArray) -> None:
    """Replace L, shape (m, m), by the triangular root of M Mᵀ, by modified Gram–Schmidt on the rows of M.

    Args:
        M: shape (m, n), n >= m; overwritten.
    """
    size = len(M)
    for j in range(size):
        square = _dot(M[j], M[j])
        L[j, j] = math.sqrt(square)
        inverse = 1.0 / square if square > 0.0 else 0.0
        for i in range(j + 1, size):
            share = _dot(M[i], M[j]) * inverse
            L[i, j] = share * L[j, j]
            for c in range(M.shape[1]):
                M[i, c] -= share * M[j, c]


@njit(cache=True, inline="always")
def _dot(a: FloatArray, b: FloatArray) -> float:
    """Σ aᵢ bᵢ in four sums, which a processor does side by side."""
    n = len(a)
    even = n - n % 4
    p, q, r, s = 0.0, 0.0, 0.0, 0.0
    for i in range(0, even, 4):
        p += a[i] * b[i]
        q += a[i + 1] * b[i + 1]
        r += a[i + 2] * b[i + 2]
        s += a[i + 3] * b[i + 3]
    for i in range(even, n):
        p += a[i] * b[i]
    return (p + q) + (r + s)
