"""Covariances of fitted parameters: how they are recorded, and what makes one impossible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from harness.identify.record.parts import Number

CovarianceRows = tuple[tuple[Number, ...], ...]

# Relative to the standard deviations: the inverse of an ill-conditioned matrix rounds by as much.
_ROUNDING = 1e-6


def check_square(rows: CovarianceRows, count: int) -> None:
    """Refuse a covariance that is not one of `count` parameters.

    Raises:
        ValueError: it has other rows or columns.
    """
    if [len(row) for row in rows] != [count] * count:
        raise ValueError(f"covariance is not a table of {count} rows and columns, as there are {count} parameters")


def covariance_fault(matrix: NDArray[np.float64]) -> str:
    """Why a matrix, shape (k, k), NaN where unknown, is no covariance within rounding; empty if it is one."""
    known = np.isfinite(matrix).all(axis=0) & np.isfinite(matrix).all(axis=1)
    matrix = matrix[np.ix_(known, known)]
    variances = np.diag(matrix)
    if not len(matrix):
        return ""
    if (variances < 0.0).any():
        return f"has the negative variance {variances.min():g}"
    deviations = np.sqrt(variances)
    deviations[deviations == 0.0] = 1.0
    correlations = matrix / deviations / deviations[:, None]
    if np.abs(correlations - correlations.T).max() > _ROUNDING:
        return "is not symmetric"
    if np.linalg.eigvalsh(correlations)[0] < -_ROUNDING * len(matrix):
        return "is not positive semi-definite"
    return ""
