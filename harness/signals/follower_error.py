"""The error of the angle of a beam that follows the measured one with a lag, as a Gauss–Markov process.

Behind T₂ b̈ + T ḃ + b = e the error e of the measured angle is smoothed: rounding that changes from count to count
hardly reaches the beam. Between two stamps e is taken for the quintic of (e, ė, ë) at both, as the angle itself is.
Then b and ḃ at the later stamp are linear in those and in b and ḃ at the earlier one, and (e, ė, ë, b, ḃ) is a
Gauss–Markov process. That of (b, ḃ, b̈) alone is the one with the same covariances at each stamp and between
neighbouring ones.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.compiled import njit
from analytic.effects import Follower
from analytic.effects.servo import swung
from analytic.motion import FloatArray
from harness.signals.error_process import ErrorProcess
from harness.signals.triangular_roots import root_of, triangular

# By the value and two derivatives of a quintic on 0 ≤ x ≤ 1 at 0, then at 1: coefficients of 1, x, …, x⁵,
_QUINTIC = np.array(
    [
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.5, 0.0, 0.0, 0.0],
        [-10.0, -6.0, -1.5, 10.0, -4.0, 0.5],
        [15.0, 8.0, 1.5, -15.0, 7.0, -1.0],
        [-6.0, -3.0, -0.5, 6.0, -3.0, 0.5],
    ]
)
# its derivatives of order 0 … 6 at 0 and at 1,
_ORDERS = [np.linalg.matrix_power(np.diag(np.arange(1.0, 6.0), 1), order) @ _QUINTIC for order in range(7)]
_AT_BEGIN, _AT_END = np.array([each[0] for each in _ORDERS]), np.array([each.sum(axis=0) for each in _ORDERS])
# and its values at eight points, with their weights in an integral.
_ROOTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_POINTS, _SHARES = 0.5 * (1.0 + _ROOTS), 0.5 * _WEIGHTS
_AT_POINTS = np.vander(_POINTS, 6, increasing=True) @ _QUINTIC
_LONG = 5.0  # lag over step, above which these points integrate the response; below it the series behaves well
_DAMPED = 0.1  # least root of `square` over lag: what is quicker is a first-order lag here
_ALIKE = 1e-9  # steps that differ by less are one [s]
_LEAST = 1e-8  # part of a number of the state that the ones before do not tell, below which it is rounding [1]


def behind_follower(error: ErrorProcess, stamps: FloatArray, follower: Follower) -> ErrorProcess:
    """The error of the angle of a beam that has settled behind another one at the first stamp.

    Args:
        error: of the angle that is followed.
        stamps: at which both are, shape (n,) [s].
    """
    made = ErrorProcess(*(np.empty_like(part) for part in error))
    square = max(follower.square, (_DAMPED * follower.lag) ** 2)
    _pass_on(np.diff(stamps), *error, follower.lag, square, *made)
    return made


@njit(cache=True)
def _respond(h: float, lag: float, square: float, out: FloatArray) -> None:
    """Fill `out`, shape (2, 8), with the derivatives of b and ḃ after `h` [s] by e, ė, ë, b, ḃ before and e, ė, ë."""
    lag, square = lag / h, square / h**2  # with h as the unit of time
    value, rate = swung(1.0, 0.0, 1.0, lag, square)
    by_rate, rate_by_rate = swung(0.0, 1.0, 1.0, lag, square)
    out[:] = 0.0
    out[0, 3], out[0, 4], out[1, 3], out[1, 4] = value, by_rate, rate, rate_by_rate
    if lag > _LONG:
        for i in range(len(_POINTS)):
            then, then_rate = swung(0.0, _SHARES[i] / square, 1.0 - _POINTS[i], lag, square)
            for c in range(6):
                at = c if c < 3 else c + 2
                out[0, at] += then * _AT_POINTS[i, c]
                out[1, at] += then_rate * _AT_POINTS[i, c]
    else:  # what follows the quintic in the long run, and what is left beside it
        factor, after = 1.0, -lag
        for order in range(6):
            for c in range(6):
                at = c if c < 3 else c + 2
                left, left_rate = _AT_BEGIN[order, c], _AT_BEGIN[order + 1, c]
                out[0, at] += factor * (_AT_END[order, c] - value * left - by_rate * left_rate)
                out[1, at] += factor * (_AT_END[order + 1, c] - rate * left - rate_by_rate * left_rate)
            factor, after = after, -lag * after - square * factor
    scale = 1.0
    for c in range(3):
        for i in range(2):
            out[i, c] *= scale
            out[i, 5 + c] *= scale
        scale *= h
    out[0, 4] *= h
    for c in range(8):
        out[1, c] /= h
    out[1, 4] *= h


@njit(cache=True)
def _pass_on(
    steps: FloatArray,
    known: FloatArray,
    forgets: FloatArray,
    draws: FloatArray,
    lag: float,
    square: float,
    covariance: FloatArray,
    transition: FloatArray,
    root: FloatArray,
) -> None:
    """Fill covariance, transition and root of the beam's error from those of the angle: `known`, `forgets`, `draws`."""
    P, L = np.zeros((5, 5)), np.zeros((6, 6))  # roots: of the five, and of b, ḃ, b̈ at both stamps of a step
    F, M, both, response = np.zeros((5, 5)), np.zeros((5, 8)), np.zeros((6, 8)), np.empty((2, 8))
    root_of(known[0], P, 0)
    for c in range(3):
        P[3, c], P[4, c] = P[0, c] - lag * P[1, c], P[1, c]
    _seen(P, lag, square, both, 0)
    _square(both[:3], covariance[0])
    h = 0.0
    for k in range(len(steps)):
        if abs(steps[k] - h) > _ALIKE:
            h = steps[k]
            _respond(h, lag, square, response)
        for c in range(3):
            for i in range(3):
                F[i, c], M[i, 5 + c] = forgets[k, i, c], draws[k, i, c]
            for i in range(2):
                F[3 + i, c], M[3 + i, 5 + c] = response[i, c], 0.0
                for a in range(3):
                    F[3 + i, c] += response[i, 5 + a] * forgets[k, a, c]
                    M[3 + i, 5 + c] += response[i, 5 + a] * draws[k, a, c]
        for c in range(2):
            for i in range(2):
                F[3 + i, 3 + c] = response[i, 3 + c]
        for i in range(5):
            for c in range(5):
                M[i, c] = 0.0
                for a in range(5):
                    M[i, c] += F[i, a] * P[a, c]
        both[:] = 0.0
        _seen(P, lag, square, both, 0)
        _seen(M, lag, square, both, 3)
        _square(both[3:], covariance[k + 1])
        triangular(both, L)
        for i in range(3):
            for c in range(2, -1, -1):  # what the state before tells
                total = L[3 + i, c]
                for a in range(c + 1, 3):
                    total -= transition[k, i, a] * L[a, c]
                tells = L[c, c] > _LEAST * math.sqrt(covariance[k, c, c])
                transition[k, i, c] = total / L[c, c] if tells else 0.0
                root[k, i, c] = L[3 + i, 3 + c] if c <= i else 0.0
        triangular(M, P)


@njit(cache=True, inline="always")
def _seen(rows: FloatArray, lag: float, square: float, out: FloatArray, first: int) -> None:
    """Those of b, ḃ, b̈ into `out` from row `first` on; `rows` of e, ė, ë, b, ḃ, as many columns or less."""
    for c in range(rows.shape[1]):
        out[first, c], out[first + 1, c] = rows[3, c], rows[4, c]
        out[first + 2, c] = (rows[0, c] - lag * rows[4, c] - rows[3, c]) / square


@njit(cache=True, inline="always")
def _square(rows: FloatArray, out: FloatArray) -> None:
    """`rows` `rows`ᵀ, shape (3, 3), into `out`."""
    for i in range(3):
        for j in range(3):
            out[i, j] = 0.0
            for c in range(rows.shape[1]):
                out[i, j] += rows[i, c] * rows[j, c]
