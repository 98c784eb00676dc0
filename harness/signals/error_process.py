"""The error of a smoothed signal as a Gauss–Markov process: how it goes on from stamp to stamp.

The smoother's prior is x₊ = F x + w, w ~ N(0, Q), for x and its first two derivatives. Let Λ₊ be the information that
the measurements after a step hold on x₊. Given all measurements, the error e = x − x̂ then obeys

    e₊ = M F e + w′,   M = (I + Q Λ₊)⁻¹,   w′ ~ N(0, M Q),

with the backward recursion Λ = H Hᵀ/R + Fᵀ Λ₊ M F (Fraser and Potter, IEEE Trans. Automatic Control 14, 1969), H the
first unit vector. A rounded signal that rests on one count keeps its error; one that moves forgets it within some.

With Q = L Lᵀ and C = I + Lᵀ Λ₊ L = G Gᵀ, M = L C⁻¹ L⁻¹ and M Q = (L G⁻ᵀ)(L G⁻ᵀ)ᵀ, whatever the size of Λ₊ and Q; and
Λ₊ M = Mᵀ (Λ₊ + Λ₊ Q Λ₊) M, a sum of squares.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.motion import FloatArray
from harness.signals.spline_smoother import STEP_ROOT, Smoothed

_ROOT_INVERSE = np.linalg.inv(STEP_ROOT)


class ErrorProcess(NamedTuple):
    """Error (e, ė, ë) of a signal at n stamps, and what else it goes on from, all m numbers z: z₊ = A z + B u,
    u ~ N(0, I).

    Attributes:
        covariance: at each stamp, shape (n, m, m).
        transition: A of each step, shape (n − 1, m, m).
        root: B of each step, shape (n − 1, m, k), k <= m.
    """

    covariance: FloatArray
    transition: FloatArray
    root: FloatArray

    def scaled(self, gain: float) -> ErrorProcess:
        """That of `gain` times the signal."""
        return ErrorProcess(gain * gain * self.covariance, self.transition, abs(gain) * self.root)

    def inflated(self, factor: FloatArray) -> ErrorProcess:
        """That of an e whose variance is `factor` times as large at each stamp, while those of ė and ë stay; m = 3.

        Args:
            factor: shape (n,) [1].
        """
        root = np.ones((len(factor), 3))
        root[:, 0] = np.sqrt(factor)
        return ErrorProcess(
            root[:, :, None] * self.covariance * root[:, None, :],
            root[1:, :, None] * self.transition / root[:-1, None, :],
            root[1:, :, None] * self.root,
        )

    def between(self, first: int, last: int) -> ErrorProcess:
        """That of the stamps `first` … `last` − 1 alone."""
        return ErrorProcess(*(part[first:end] for part, end in zip(self, (last, last - 1, last - 1), strict=True)))

    def at(self, stamps: NDArray[np.int64]) -> ErrorProcess:
        """That at some of its stamps, ascending numbers of them, shape (j,)."""
        shape = (len(stamps) - 1, *self.transition.shape[1:])
        transition, root = np.empty(shape), np.empty(shape)
        _compose(self.transition, self.root, stamps, transition, root)
        return ErrorProcess(self.covariance[stamps], transition, root)


@njit(cache=True)
def _compose(
    each: FloatArray, each_root: FloatArray, stamps: NDArray[np.int64], transition: FloatArray, root: FloatArray
) -> None:
    """Fill `transition` and `root` with those of all steps between two of `stamps` together, shape (j − 1, m, m)."""
    size, sources = each_root.shape[1:]
    for k in range(len(stamps) - 1):
        count = stamps[k + 1] - stamps[k]
        A, roots = np.eye(size), np.zeros((max(sources * count, size), size))  # of each step, transposed, as at the end
        for i in range(count):
            step = stamps[k] + i
            carried = np.ascontiguousarray(each[step].T)
            A = A @ carried
            before = sources * i
            roots[:before] = roots[:before] @ carried
            roots[before : before + sources] = each_root[step].T
        transition[k] = A.T
        root[k] = np.linalg.qr(roots)[1].T


def error_process(smoothed: Smoothed, variance: FloatArray) -> ErrorProcess:
    """The process of the error of `smoothed`.

    Args:
        smoothed: the posterior at n stamps.
        variance: of the measurements it was made with, shape (n,), infinite where there was none [unit²]. A signal that
            is known exactly has zeros here and in its densities; its error is zero.
    """
    with np.errstate(divide="ignore"):
        precision = np.where(np.isfinite(variance) & (variance > 0.0), 1.0 / variance, 0.0)
    n = len(smoothed.time)
    transition, root = np.empty((n - 1, 3, 3)), np.empty((n - 1, 3, 3))
    _recur(np.diff(smoothed.time), smoothed.density, precision, STEP_ROOT, _ROOT_INVERSE, transition, root)
    covariance = smoothed.covariance.copy()
    variances = np.einsum("kii->ki", covariance)
    np.maximum(variances, 0.0, out=variances)  # one of an angle that is known exactly may be negative by rounding
    return ErrorProcess(covariance, transition, root)


@njit(cache=True)
def _recur(
    steps: FloatArray,
    density: FloatArray,
    precision: FloatArray,
    unit_root: FloatArray,
    unit_inverse: FloatArray,
    transition: FloatArray,
    root: FloatArray,
) -> None:
    """Fill `transition` and `root`, shape (n − 1, 3, 3), from the last step backwards."""
    information, scale = np.zeros((3, 3)), np.empty(3)
    F, G, inverse = np.eye(3), np.zeros((3, 3)), np.zeros((3, 3))
    for k in range(len(steps) - 1, -1, -1):
        h = steps[k]
        information[0, 0] += precision[k + 1]
        F[0, 1] = F[1, 2] = h
        F[0, 2] = 0.5 * h * h
        if density[k] == 0.0:
            transition[k], root[k] = F, 0.0
            continue
        scale[:] = math.sqrt(density[k] * h)
        scale[0] *= h * h
        scale[1] *= h
        L = unit_root * scale.reshape((3, 1))
        C = np.eye(3) + L.T @ information @ L
        for i in range(3):  # G Gᵀ = C, then G⁻¹
            for j in range(i + 1):
                total = C[i, j]
                for a in range(j):
                    total -= G[i, a] * G[j, a]
                G[i, j] = math.sqrt(max(total, 1.0)) if i == j else total / G[j, j]
        for i in range(3):
            inverse[i, i] = 1.0 / G[i, i]
            for j in range(i):
                total = 0.0
                for a in range(j, i):
                    total -= G[i, a] * inverse[a, j]
                inverse[i, j] = total / G[i, i]
        B = L @ inverse.T
        root[k] = B
        M = B @ inverse @ (unit_inverse / scale.reshape((1, 3)))
        transition[k] = M @ F
        T, U = information @ M, L.T @ information @ M
        before = F.T @ (M.T @ T + U.T @ U) @ F
        information[:] = 0.5 * (before + before.T)
