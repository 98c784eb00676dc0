"""Innovations: what makes errors independent that a ball's wandering velocity has correlated.

A ball whose acceleration carries white noise of density q (what an angle's error and a model's defects push it with)
has a velocity that wanders, and position errors that grow and are correlated. The Kalman filter of this two-state
process turns any signal on the same stamps into innovations of unit variance; least squares on innovations is the
generalised least squares of the signal itself (Harvey, "Forecasting, Structural Time Series Models …", 1989, §3.4).
"""

from __future__ import annotations

import math

import numpy as np

from analytic.compiled import njit
from analytic.motion import FloatArray

_DIFFUSE = 1e4  # prior variance of start position [m²] and velocity [m²/s²]: the start is free


@njit(cache=True)
def innovations(
    time: FloatArray, signals: FloatArray, variance: FloatArray, density: float
) -> tuple[FloatArray, float]:
    """Whiten `signals`, all with the same filter.

    Args:
        time: stamps, shape (n,), increasing [s].
        signals: one a column, shape (n, k) [m].
        variance: of a reading, shape (n,); infinite where there is none [m²].
        density: q of the white acceleration [m²/s³].

    Returns:
        Innovations over their standard deviations, shape (n, k), 0 where there is no reading and at the first two,
        which the free start takes; and the sum of their log variances.
    """
    n, k = signals.shape
    position, velocity = np.zeros(k), np.zeros(k)
    a, b, c = _DIFFUSE, 0.0, _DIFFUSE  # covariance of position and velocity
    out = np.zeros((n, k))
    log_variances, seen = 0.0, 0
    for i in range(n):
        if i > 0:
            h = time[i] - time[i - 1]
            position += h * velocity
            a += 2.0 * h * b + h * h * c + density * h**3 / 3.0
            b += h * c + density * h * h / 2.0
            c += density * h
        if math.isfinite(variance[i]):
            total = a + variance[i]
            error = signals[i] - position
            if seen >= 2:
                out[i] = error / math.sqrt(total)
                log_variances += math.log(total)
            seen += 1
            position += a / total * error
            velocity += b / total * error
            c -= b * b / total
            a, b = a * variance[i] / total, b * variance[i] / total
    return out, log_variances
