"""Triangular roots L of covariances L Lᵀ."""

from __future__ import annotations

import math

import numpy as np

from analytic.compiled import njit
from analytic.motion import FloatArray

_APART = 1e-8  # product of what is left of the variances, over these, above which rounding leaves 1e-8 of any
_LEAST = 1e-13  # of what is left of a variance, over that variance: no less than what rounding leaves


@njit(cache=True)
def root_of(covariance: FloatArray, L: FloatArray, first: int) -> None:
    """Triangular root of a covariance whose entries span decades, shape (m, m), into L from row and column `first` on.

    What lies above the diagonal stays; the diagonal has zeros where nothing is left of a variance.
    By Cholesky's factor in the order of the rows. Where numbers depend on each other nearly linearly, as those of an
    angle behind a servo, a hold and a lag do, that would grow without bound; it is then taken in the order of what is
    left of each variance, until that is rounding (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed.,
    2002, section 10.3).
    """
    if not _by_rows(covariance, L, first):
        _by_size(covariance, L, first)


@njit(cache=True)
def _by_rows(covariance: FloatArray, L: FloatArray, first: int) -> bool:
    """Fill L by rows; false where rounding spoils that."""
    apart = 1.0
    for i in range(len(covariance)):
        for j in range(i + 1):
            total = covariance[i, j]
            for a in range(j):
                total -= L[first + i, first + a] * L[first + j, first + a]
            if i == j:
                if covariance[i, i] > 0.0:
                    apart *= total / covariance[i, i]
                if not apart > _APART:
                    return False
                L[first + i, first + i] = math.sqrt(total)
            else:
                root = L[first + j, first + j]
                L[first + i, first + j] = total / root if root > 0.0 else 0.0
    return True


@njit(cache=True)
def _by_size(covariance: FloatArray, L: FloatArray, first: int) -> None:
    """Fill L by the largest of the correlations that are left."""
    size = len(covariance)
    deviations = np.sqrt(np.diag(covariance))
    left, M, own = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size))
    for i in range(size):
        for j in range(size):
            scale = deviations[i] * deviations[j]
            left[i, j] = covariance[i, j] / scale if scale > 0.0 else 0.0
    for k in range(size):
        at = int(np.argmax(np.diag(left)))
        if left[at, at] < _LEAST:
            break
        M[:, k] = left[:, at] / math.sqrt(left[at, at])
        for i in range(size):
            for j in range(size):
                left[i, j] -= M[i, k] * M[j, k]
    for i in range(size):
        M[i] *= deviations[i]
    triangular(M, own)
    for i in range(size):
        L[first + i, first : first + i + 1] = own[i, : i + 1]


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
