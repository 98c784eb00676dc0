"""Smoothing under a prior whose third derivative is white noise: a quintic smoothing spline with error bars.

The posterior mean of this prior is the quintic spline that minimises roughness ∫ x‴² dt against the squared residuals
(Wahba, "Improper priors, spline smoothing …", JRSS B 40, 1978), and a Kalman smoother computes it with its covariance
and evidence in O(n) on any stamps (Kohn and Ansley, SIAM J. Sci. Stat. Comput. 8, 1987).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray

# Prior variances of value, first and second derivative at the first stamp: wide for angles in rad and positions in m.
_DIFFUSE = np.array([1e2, 1e3, 1e4])
# Searched densities of the third derivative [unit²/s⁵]: from a signal at rest to one that a servo cannot follow.
_LOG_DENSITIES = (-18.0, 20.0)


@dataclass(frozen=True)
class Smoothed:
    """A smoothed signal x at its n stamps.

    Attributes:
        time: shape (n,) [s].
        mean: x, ẋ, ẍ, shape (n, 3).
        covariance: of x, ẋ, ẍ, shape (n, 3, 3).
        density: of the white third derivative, x-units² / s⁵.
        log_evidence: log probability of the measured values under prior and noise.
    """

    time: FloatArray
    mean: FloatArray
    covariance: FloatArray
    density: float
    log_evidence: float


@njit(cache=True, inline="always")
def _advance(m: FloatArray, P: FloatArray, dt: float, density: float) -> None:
    """Predict mean and covariance over `dt`, in place: x ← F x, P ← F P Fᵀ + Q."""
    half = 0.5 * dt * dt
    m[0] += dt * m[1] + half * m[2]
    m[1] += dt * m[2]
    for j in range(3):
        P[0, j] += dt * P[1, j] + half * P[2, j]
        P[1, j] += dt * P[2, j]
    for i in range(3):
        P[i, 0] += dt * P[i, 1] + half * P[i, 2]
        P[i, 1] += dt * P[i, 2]
    P[0, 0] += density * dt**5 / 20.0
    P[0, 1] += density * dt**4 / 8.0
    P[0, 2] += density * dt**3 / 6.0
    P[1, 1] += density * dt**3 / 3.0
    P[1, 2] += density * dt**2 / 2.0
    P[2, 2] += density * dt
    P[1, 0], P[2, 0], P[2, 1] = P[0, 1], P[0, 2], P[1, 2]


@njit(cache=True)
def _inverse(P: FloatArray, out: FloatArray) -> None:
    """P⁻¹ of a symmetric positive definite 3 × 3 matrix whose entries span many decades, by a scaled Cholesky."""
    L = np.zeros((3, 3))
    scale = np.empty(3)
    for i in range(3):
        scale[i] = 1.0 / math.sqrt(P[i, i])
    for i in range(3):
        for j in range(i + 1):
            total = P[i, j] * scale[i] * scale[j]
            for a in range(j):
                total -= L[i, a] * L[j, a]
            # Rounding can spend what little is left of a pivot; it is never below the rounding itself.
            L[i, j] = math.sqrt(max(total, 1e-15)) if i == j else total / L[j, j]
    M = np.zeros((3, 3))  # L⁻¹
    for i in range(3):
        M[i, i] = 1.0 / L[i, i]
        for j in range(i):
            total = 0.0
            for a in range(j, i):
                total -= L[i, a] * M[a, j]
            M[i, j] = total / L[i, i]
    for i in range(3):
        for j in range(3):
            total = 0.0
            for a in range(max(i, j), 3):
                total += M[a, i] * M[a, j]
            out[i, j] = total * scale[i] * scale[j]


@njit(cache=True, nogil=True)
def kalman_smoother(
    time: FloatArray, value: FloatArray, variance: FloatArray, density: float, mean: FloatArray, covariance: FloatArray
) -> float:
    """Fill `mean` (n, 3) and `covariance` (n, 3, 3); return the log evidence. An infinite variance is no measurement."""
    n = len(time)
    m = np.zeros(3)
    P = np.diag(_DIFFUSE)
    evidence = 0.0
    for k in range(n):
        if k > 0:
            _advance(m, P, time[k] - time[k - 1], density)
        if math.isfinite(variance[k]):
            S = P[0, 0] + variance[k]
            e = value[k] - m[0]
            gain = P[0] / S
            for i in range(3):
                m[i] += gain[i] * e
                for j in range(i, 3):
                    P[i, j] -= gain[i] * gain[j] * S
                    P[j, i] = P[i, j]
            # The subtraction above loses digits where the prior was wide; the exact form is P R / S.
            P[0, 0] = gain[0] * variance[k]
            evidence -= 0.5 * (math.log(2.0 * math.pi * S) + e * e / S)
        mean[k] = m
        covariance[k] = P
    _smooth_backward(time, density, mean, covariance)
    return evidence


@njit(cache=True, nogil=True)
def _smooth_backward(time: FloatArray, density: float, mean: FloatArray, covariance: FloatArray) -> None:
    """Turn filtered means and covariances into smoothed ones, in place.

    Rauch, Tung and Striebel's gain G = P Fᵀ P⁻¹₊ is written F⁻¹ (I − Q P⁻¹₊) = F⁻¹ (I − W), and the covariance as a
    sum of squares, F⁻¹ [W (P₊ − Q) Wᵀ + (I − W)(P′ + Q)(I − W)ᵀ] F⁻ᵀ, which stays positive from a diffuse start.
    """
    Q, inverse, W, V, T = np.zeros((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    nothing = np.zeros(3)
    for k in range(len(time) - 2, -1, -1):
        dt = time[k + 1] - time[k]
        before, ahead = covariance[k].copy(), mean[k].copy()
        Q[:] = 0.0
        _advance(nothing, Q, dt, density)
        predicted = before
        _advance(ahead, predicted, dt, density)
        _inverse(predicted, inverse)
        for i in range(3):
            for j in range(3):
                W[i, j] = Q[i, 0] * inverse[0, j] + Q[i, 1] * inverse[1, j] + Q[i, 2] * inverse[2, j]
                V[i, j] = (1.0 if i == j else 0.0) - W[i, j]
        step = np.empty(3)
        for i in range(3):
            step[i] = 0.0
            for a in range(3):
                step[i] += V[i, a] * (mean[k + 1, a] - ahead[a])
        for i in range(3):
            for j in range(3):
                total = 0.0
                for a in range(3):
                    for b in range(3):
                        total += W[i, a] * (predicted[a, b] - Q[a, b]) * W[j, b]
                        total += V[i, a] * (covariance[k + 1, a, b] + Q[a, b]) * V[j, b]
                T[i, j] = total
        half = 0.5 * dt * dt
        # F⁻¹ is F with −dt in place of dt.
        mean[k, 0] += step[0] - dt * step[1] + half * step[2]
        mean[k, 1] += step[1] - dt * step[2]
        mean[k, 2] += step[2]
        _advance(nothing, T, -dt, 0.0)
        covariance[k] = T


def smooth(time: FloatArray, value: FloatArray, variance: FloatArray | float, density: float | None = None) -> Smoothed:
    """Smooth a signal.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        value: measured values, shape (n,); where the variance is infinite they do not matter.
        variance: of the measurement noise, shape (n,) or one for all [unit²].
        density: of the white third derivative [unit²/s⁵]; by default the one of greatest evidence.
    """
    time, value = np.asarray(time, float), np.asarray(value, float)
    variance = np.broadcast_to(np.asarray(variance, float), time.shape).copy()
    value = np.where(np.isfinite(variance), value, 0.0)
    mean, covariance = np.empty((len(time), 3)), np.empty((len(time), 3, 3))
    if density is None:
        found = minimize_scalar(
            lambda x: -kalman_smoother(time, value, variance, math.exp(x), mean, covariance),
            bounds=_LOG_DENSITIES,
            method="bounded",
            options={"xatol": 0.05},
        )
        density = math.exp(found.x)
    evidence = kalman_smoother(time, value, variance, density, mean, covariance)
    return Smoothed(time, mean, covariance, density, evidence)


def draw(
    smoothed: Smoothed, variance: FloatArray, count: int, generator: np.random.Generator
) -> FloatArray:
    """Draw signals from the posterior, shape (count, n, 3), by Matheron's rule.

    A path of the prior and its measurement are simulated; what smoothing leaves of their difference is distributed as
    the posterior's error (Doucet, "A note on efficient conditional simulation …", 2010).

    Args:
        variance: of the measurement noise the posterior was made with, shape (n,) [unit²].
    """
    time, density = smoothed.time, smoothed.density
    n = len(time)
    steps = np.diff(time)
    root = np.linalg.cholesky(np.array([[1 / 20, 1 / 8, 1 / 6], [1 / 8, 1 / 3, 1 / 2], [1 / 6, 1 / 2, 1.0]]))
    paths = np.empty((count, n, 3))
    mean, covariance = np.empty((n, 3)), np.empty((n, 3, 3))
    measured = np.isfinite(variance)
    for path in paths:
        path[0] = 0.0  # the prior is diffuse there: any start does
        scale = np.sqrt(density * steps)[:, None] * np.column_stack((steps**2, steps, np.ones(n - 1)))
        kicks = scale * (generator.standard_normal((n - 1, 3)) @ root.T)
        # ẍ, ẋ, x in turn: each is the sum of its kicks and the drift from the one before
        path[1:, 2] = np.cumsum(kicks[:, 2])
        path[1:, 1] = np.cumsum(kicks[:, 1] + steps * path[:-1, 2])
        path[1:, 0] = np.cumsum(kicks[:, 0] + steps * path[:-1, 1] + 0.5 * steps**2 * path[:-1, 2])
        noise = np.where(measured, generator.standard_normal(n) * np.sqrt(np.where(measured, variance, 0.0)), 0.0)
        kalman_smoother(time, np.where(measured, path[:, 0] + noise, 0.0), variance, density, mean, covariance)
        path[:] = smoothed.mean + path - mean
    return paths
