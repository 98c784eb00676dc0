"""The posterior of a smoothed signal by brute force: one dense solve of its precision matrix in many digits."""

from __future__ import annotations

import numpy as np
from mpmath import matrix, mp, mpf

from analytic.motion import FloatArray
from harness.signals.spline_smoother import _DIFFUSE

# Covariance of value and derivatives that white noise of density 1 on the third gives in a step of 1.
KICK = [[mpf(1) / 20, mpf(1) / 8, mpf(1) / 6], [mpf(1) / 8, mpf(1) / 3, mpf(1) / 2], [mpf(1) / 6, mpf(1) / 2, mpf(1)]]


def posterior_covariance(time: FloatArray, variance: FloatArray, density: FloatArray) -> FloatArray:
    """Covariance of value, first and second derivative at all stamps together, shape (n, 3, n, 3).

    Args:
        time: stamps, shape (n,) [s].
        variance: of the measured values, shape (n,), infinite where there is none.
        density: of the white third derivative, shape (n − 1,).
    """
    mp.dps = 60
    n = len(time)
    precision = matrix(3 * n, 3 * n)
    for i in range(3):
        precision[i, i] += 1 / mpf(_DIFFUSE[i])
    for k in range(n):
        if np.isfinite(variance[k]):
            precision[3 * k, 3 * k] += 1 / mpf(variance[k])
    for k in range(n - 1):
        h = mpf(time[k + 1]) - mpf(time[k])
        Q = matrix(3, 3)
        for i in range(3):
            for j in range(3):
                Q[i, j] = mpf(density[k]) * h ** (5 - i - j) * KICK[i][j]
        # the disturbance x₊ − F x as a function of both states
        D = matrix([[-1, -h, -h * h / 2, 1, 0, 0], [0, -1, -h, 0, 1, 0], [0, 0, -1, 0, 0, 1]])
        share = D.T * Q**-1 * D
        for i in range(6):
            for j in range(6):
                precision[3 * k + i, 3 * k + j] += share[i, j]
    covariance = precision**-1
    return np.array(covariance.tolist(), float).reshape(n, 3, n, 3)
