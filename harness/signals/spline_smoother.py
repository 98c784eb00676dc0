"""Smoothing under a prior whose third derivative is white noise: a quintic smoothing spline with error bars.

The posterior mean of this prior is the quintic spline that minimises roughness ∫ x‴² dt against the squared residuals
(Wahba, "Improper priors, spline smoothing …", JRSS B 40, 1978), and a Kalman smoother computes it with its covariance
and evidence in O(n) at any stamps (Kohn and Ansley, SIAM J. Sci. Stat. Comput. 8, 1987). The density of the white
noise may differ from step to step (`harness.signals.roughness`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from analytic.compiled import njit
from analytic.motion import FloatArray

# Prior variances of value, first and second derivative at the first stamp: wide for angles in rad and positions in m.
_DIFFUSE = np.array([1e2, 1e3, 1e4])
# Bounds of the log density of the third derivative [unit²/s⁵]: from a signal at rest to one no servo can follow.
LOG_DENSITIES = (-22.0, 20.0)
STEP_ROOT = np.linalg.cholesky(np.array([[1 / 20, 1 / 8, 1 / 6], [1 / 8, 1 / 3, 1 / 2], [1 / 6, 1 / 2, 1.0]]))
"""Lower root of K in the covariance of the disturbance of a step, Q = density · h · diag(h², h, 1) K diag(h², h, 1)."""


@dataclass(frozen=True)
class Smoothed:
    """A smoothed signal x at its n stamps.

    Attributes:
        time: shape (n,) [s].
        mean: x, ẋ, ẍ, shape (n, 3).
        covariance: of x, ẋ, ẍ, shape (n, 3, 3).
        density: of the white third derivative between the stamps, shape (n − 1,) [x-unit²/s⁵].
        log_evidence: log probability of the measured values under prior and noise.
    """

    time: FloatArray
    mean: FloatArray
    covariance: FloatArray
    density: FloatArray
    log_evidence: float


@njit(cache=True)
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
def _inverse(P: FloatArray, out: FloatArray, L: FloatArray, M: FloatArray) -> None:
    """P⁻¹ of a symmetric positive definite 3 × 3 matrix whose entries span many decades, by a scaled Cholesky.

    L and M, 3 × 3, are workspace: they receive the factor and its inverse.
    """
    for i in range(3):
        for j in range(i + 1):
            total = P[i, j] / math.sqrt(P[i, i] * P[j, j])
            for a in range(j):
                total -= L[i, a] * L[j, a]
            # Rounding can spend what little is left of a pivot; it is never below the rounding itself.
            L[i, j] = math.sqrt(max(total, 1e-15)) if i == j else total / L[j, j]
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
            out[i, j] = total / math.sqrt(P[i, i] * P[j, j])


@njit(cache=True)
def _multiply(A: FloatArray, B: FloatArray, out: FloatArray) -> None:
    """`out` ← A B for 3 × 3 matrices; BLAS costs more than it saves here."""
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * B[0, j] + A[i, 1] * B[1, j] + A[i, 2] * B[2, j]


@njit(cache=True)
def _filter(
    time: FloatArray,
    value: FloatArray,
    variance: FloatArray,
    density: FloatArray,
    mean: FloatArray,
    covariance: FloatArray,
) -> float:
    """Fill filtered means and covariances; return the log evidence."""
    m = np.zeros(3)
    P = np.diag(_DIFFUSE)
    gain = np.empty(3)
    evidence = 0.0
    for k in range(len(time)):
        if k > 0:
            _advance(m, P, time[k] - time[k - 1], density[k - 1])
        if math.isfinite(variance[k]):
            S = P[0, 0] + variance[k]
            e = value[k] - m[0]
            gain[:] = P[0] / S
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
    return evidence


@njit(cache=True)
def kalman_smoother(
    time: FloatArray,
    value: FloatArray,
    variance: FloatArray,
    density: FloatArray,
    mean: FloatArray,
    covariance: FloatArray,
    energy: FloatArray,
    dof: FloatArray,
) -> float:
    """Smooth; return the log evidence. An infinite variance is no measurement.

    Let w = x₊ − F x be the disturbance by the white noise in a step, with prior covariance Q. Given the data,
    E[wᵀ Q⁻¹ w] − 3 = energy − dof, and half of it is the derivative of the log evidence by the log of the step's
    density (Fisher's identity). The effective degrees of freedom, 0 … 3, say how much of w the data determine.

    Rauch, Tung and Striebel's gain G = P Fᵀ P₊⁻¹ is written F⁻¹ (I − Q P₊⁻¹) = F⁻¹ (I − W), and the covariance as a
    sum of squares, F⁻¹ [W (P₊ − Q) Wᵀ + (I − W)(P′ + Q)(I − W)ᵀ] F⁻ᵀ, which stays positive from a diffuse start.

    Args:
        time, value, variance: stamps [s], measured values, their variances, shape (n,).
        density: of the white third derivative in each step, shape (n − 1,).
        mean, covariance: outputs, shape (n, 3) and (n, 3, 3).
        energy, dof: outputs, ŵᵀ Q⁻¹ ŵ and the effective degrees of freedom of each step, shape (n − 1,) [1].
    """
    evidence = _filter(time, value, variance, density, mean, covariance)
    Q, P, inverse = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    W, V, A, B, T = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    ahead, apart, force, disturbance, nothing = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.zeros(3)
    for k in range(len(time) - 2, -1, -1):
        dt = time[k + 1] - time[k]
        Q[:] = 0.0
        _advance(nothing, Q, dt, density[k])
        P[:] = covariance[k]
        ahead[:] = mean[k]
        _advance(ahead, P, dt, density[k])
        _inverse(P, inverse, A, B)
        _multiply(Q, inverse, W)
        for i in range(3):
            apart[i] = mean[k + 1, i] - ahead[i]
            for j in range(3):
                V[i, j] = (1.0 if i == j else 0.0) - W[i, j]
        for i in range(3):
            disturbance[i] = W[i, 0] * apart[0] + W[i, 1] * apart[1] + W[i, 2] * apart[2]
            force[i] = inverse[i, 0] * apart[0] + inverse[i, 1] * apart[1] + inverse[i, 2] * apart[2]
        energy[k] = disturbance[0] * force[0] + disturbance[1] * force[1] + disturbance[2] * force[2]
        _multiply(inverse, W, A)
        dof[k] = W[0, 0] + W[1, 1] + W[2, 2]
        for i in range(3):
            for j in range(3):
                dof[k] -= A[i, j] * covariance[k + 1, j, i]
                P[i, j] -= Q[i, j]
                Q[i, j] += covariance[k + 1, i, j]
        _multiply(W, P, A)
        _multiply(V, Q, B)
        for i in range(3):
            for j in range(3):
                T[i, j] = 0.0
                for a in range(3):
                    T[i, j] += A[i, a] * W[j, a] + B[i, a] * V[j, a]
        # F⁻¹ is F with −dt in place of dt.
        for i in range(3):
            apart[i] -= disturbance[i]
        _advance(apart, T, -dt, 0.0)
        for i in range(3):
            mean[k, i] += apart[i]
        covariance[k] = T
    return evidence


def smooth(
    time: FloatArray, value: FloatArray, variance: FloatArray | float, density: FloatArray | float | None = None
) -> Smoothed:
    """Smooth a signal.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        value: measured values, shape (n,); ignored where the variance is infinite.
        variance: of the measurement noise, shape (n,) or one for all [unit²].
        density: of the white third derivative, shape (n − 1,) or one for all [unit²/s⁵]; by default the constant of
            greatest evidence.
    """
    time, value = np.asarray(time, float), np.asarray(value, float)
    n = len(time)
    variance = np.broadcast_to(np.asarray(variance, float), n).copy()
    value = np.where(np.isfinite(variance), value, 0.0)
    mean, covariance, workspace = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((2, n - 1))

    def run(density: FloatArray) -> float:
        return float(kalman_smoother(time, value, variance, density, mean, covariance, workspace[0], workspace[1]))

    if density is None:
        density = math.exp(
            minimize_scalar(
                lambda x: -run(np.full(n - 1, math.exp(x))),
                bounds=LOG_DENSITIES,
                method="bounded",
                options={"xatol": 0.05},
            ).x
        )
    density = np.broadcast_to(np.asarray(density, float), n - 1).copy()
    evidence = run(density)
    return Smoothed(time, mean, covariance, density, evidence)


def draw(smoothed: Smoothed, variance: FloatArray, count: int, generator: np.random.Generator) -> FloatArray:
    """Draw signals from the posterior, shape (count, n, 3), by Matheron's rule.

    A path of the prior and its measurement are simulated; the error of smoothing that measurement is distributed as
    the posterior's error (Doucet, "A note on efficient conditional simulation …", 2010).

    Args:
        smoothed: the posterior.
        variance: of the measurement noise the posterior was made with, shape (n,) [unit²].
        count: how many signals.
        generator: of random numbers.
    """
    time, n = smoothed.time, len(smoothed.time)
    steps = np.diff(time)
    scale = np.sqrt(smoothed.density * steps)[:, None] * np.column_stack((steps**2, steps, np.ones(n - 1)))
    deviation = np.sqrt(np.where(np.isfinite(variance), variance, 0.0))
    paths = np.empty((count, n, 3))
    for path in paths:
        path[0] = 0.0  # the prior is diffuse there, so that any start will do
        disturbances = scale * (generator.standard_normal((n - 1, 3)) @ STEP_ROOT.T)
        # ẍ, ẋ, x in turn: each is the sum of its disturbances and of the integral of the one before
        path[1:, 2] = np.cumsum(disturbances[:, 2])
        path[1:, 1] = np.cumsum(disturbances[:, 1] + steps * path[:-1, 2])
        path[1:, 0] = np.cumsum(disturbances[:, 0] + steps * path[:-1, 1] + 0.5 * steps**2 * path[:-1, 2])
        measured = path[:, 0] + deviation * generator.standard_normal(n)
        path[:] = smoothed.mean + path - smooth(time, measured, variance, smoothed.density).mean
    return paths
