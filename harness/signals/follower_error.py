"""The error of the angle of a beam that follows the measured one with a lag, as a Gauss–Markov process.

Behind T₂ b̈ + T ḃ + b = e the error e of the measured angle is smoothed: rounding that changes from count to count
hardly reaches the beam. Between two stamps e is taken for the quintic of (e, ė, ë) at both, as the angle itself is.
Then b and ḃ at the later stamp are linear in those and in b and ḃ at the earlier one, and (e, ė, ë, b, ḃ) is a
Gauss–Markov process; so is (b, ḃ, b̈, ė, ë), as e = T₂ b̈ + T ḃ + b.
"""

from __future__ import annotations

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
_LEAST = 1e-6  # of a lag, as of the motion behind it [s]
_ALIKE = 1e-9  # steps that differ by less are one [s]


def behind_follower(error: ErrorProcess, stamps: FloatArray, follower: Follower) -> ErrorProcess:
    """The error of the angle of a beam that has settled behind another one at the first stamp.

    Args:
        error: of the angle that is followed, m numbers; that of the beam has m + 2.
        stamps: at which both are, shape (n,) [s].
    """
    if follower.lag < _LEAST:
        return error
    (n, m, _), sources = error.covariance.shape, error.root.shape[2]
    size = m + 2
    made = ErrorProcess(np.empty((n, size, size)), np.empty((n - 1, size, size)), np.empty((n - 1, size, sources)))
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
    """Fill covariance, transition and root of the beam's error from those of the angle: `known`, `forgets`, `draws`.

    With z, shape (m,), of the angle, the rows of z, b and ḃ at the later stamp by those at the earlier one come first,
    then those of what goes on, (b, ḃ, b̈) and z without e.
    """
    m, sources = forgets.shape[1], draws.shape[2]
    P, M = np.zeros((m + 2, m + 2)), np.zeros((m + 2, m + 2 + sources))
    rows, noise, response = np.zeros((m + 2, m + 2)), np.zeros((m + 2, sources)), np.empty((2, 8))
    of_known = np.zeros((m, m))
    root_of(known[0], of_known, 0)
    rows[:m, :m] = of_known
    rows[m, :m], rows[m + 1, :m] = of_known[0] - lag * of_known[1], of_known[1]
    _seen(rows, lag, square, M)
    covariance[0] = M @ M.T
    triangular(M, P)
    rows[:] = 0.0
    h = 0.0
    for k in range(len(steps)):
        if abs(steps[k] - h) > _ALIKE:
            h = steps[k]
            _respond(h, lag, square, response)
            rows[m:, m:] = response[:, 3:5]
        rows[:m, :m], noise[:m] = forgets[k], draws[k]
        for i in range(2):
            for c in range(m):
                rows[m + i, c] = response[i, c] if c < 3 else 0.0
                for a in range(3):
                    rows[m + i, c] += response[i, 5 + a] * forgets[k, a, c]
            for c in range(sources):
                noise[m + i, c] = 0.0
                for a in range(3):
                    noise[m + i, c] += response[i, 5 + a] * draws[k, a, c]
        _seen(noise, lag, square, root[k])
        _seen(rows, lag, square, M)
        for i in range(m + 2):  # by (b, ḃ, b̈) and z without e, of which e = b + T ḃ + T₂ b̈ is made up
            by_e = M[i, 0]
            transition[k, i, 0], transition[k, i, 1] = M[i, m] + by_e, M[i, m + 1] + lag * by_e
            transition[k, i, 2] = square * by_e
            for c in range(1, m):
                transition[k, i, 2 + c] = M[i, c]
        M[:] = 0.0
        for i in range(m + 2):
            for a in range(m + 2):
                for c in range(a + 1):
                    M[i, c] += transition[k, i, a] * P[a, c]
            for c in range(sources):
                M[i, m + 2 + c] = root[k, i, c]
        triangular(M, P)
        for i in range(m + 2):
            for j in range(i + 1):
                total = 0.0
                for c in range(j + 1):
                    total += P[i, c] * P[j, c]
                covariance[k + 1, i, j] = covariance[k + 1, j, i] = total


@njit(cache=True, inline="always")
def _seen(rows: FloatArray, lag: float, square: float, out: FloatArray) -> None:
    """Rows of (b, ḃ, b̈) and z without e into the first columns of `out`; `rows` of z, b, ḃ, shape (m + 2, any)."""
    m = len(rows) - 2
    for c in range(rows.shape[1]):
        out[0, c], out[1, c] = rows[m, c], rows[m + 1, c]
        out[2, c] = (rows[0, c] - lag * rows[m + 1, c] - rows[m, c]) / square
        for i in range(1, m):
            out[2 + i, c] = rows[i, c]
