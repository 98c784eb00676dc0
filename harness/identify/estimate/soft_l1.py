"""The soft L1 loss of a residual e, 2 c² (√(1 + (e/c)²) − 1): quadratic for small ones, linear for large ones.

And the covariance of parameters that minimise its sum.
"""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray

_LEAST_SCALE = 1e-4  # of the loss [m]
_MEDIAN = 0.6745  # median absolute value of a standard normal variable


def scale_of(residual: FloatArray) -> float:
    """c: the standard deviation that the median of residuals [m], any shape, has of normal ones [m]."""
    return max(float(np.median(np.abs(residual))) / _MEDIAN, _LEAST_SCALE)


def loss(residual: FloatArray, scale: float) -> float:
    """Sum of the losses of residuals [m], any shape, with c = `scale` [m]; in m²."""
    return float(np.sum(2.0 * scale**2 * (np.sqrt(1.0 + (residual / scale) ** 2) - 1.0)))


def weights(residual: FloatArray, scale: float) -> FloatArray:
    """Roots of the weights [1] with which least squares follow the loss of residuals [m], same shape."""
    return np.asarray((1.0 + (residual / scale) ** 2) ** -0.25)


def sandwich_covariance(jacobian: FloatArray, scores: FloatArray, scale: FloatArray) -> FloatArray:
    """Covariance of parameters in their units, shape (k, k), with windows as clusters (Liang and Zeger, 1986).

    Args:
        jacobian: weighted derivatives of the residuals by the scaled parameters, shape (readings, k) [m].
        scores: sums over each window of `jacobian` times the weighted residual, shape (windows, k) [m²].
        scale: typical sizes of the parameters, shape (k,).
    """
    windows, k = scores.shape
    bread = np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)
    correction = windows / max(windows - k, 1)
    return np.asarray(correction * (bread @ (scores.T @ scores) @ bread) * np.outer(scale, scale))
