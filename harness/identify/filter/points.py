"""A step over which dry friction may stop the ball, propagated at points instead of by slopes.

Where friction stops the ball, or holds it up, the step is no linear function of the state: slopes at its mean tell the
filter that it knows a ball at rest exactly, or a wrong mean after a stop, and whatever moves the ball a little then
seems to be an effect. Second-order divided differences over ±√3 standard deviations along the columns of the root L
(Nørgaard, Poulsen and Ravn, Automatica 36, 2000) give mean and covariance as well as a Gaussian can have them. A run
without readings goes on from the mean by slopes: it is the path of one ball, not the mean of balls of which some have
stopped. A ball with Dahl friction that turns round, or one whose slip may begin or end, is no different; and were such
steps taken by slopes, a second friction of no size at all would seem to explain what points explain.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.lean_step import path_of
from analytic.motion import FloatArray
from analytic.shared_step import ball_step, beam_step
from harness.identify.filter.arguments import BeamTable, rate_change, rate_noise, shifted

REACH_SQUARE = 3.0  # the kurtosis of a normal variable: the square of the points' distance in standard deviations
REACH = math.sqrt(REACH_SQUARE)
FIRST = 0.5 / REACH  # factor of f(x + √3 l) − f(x − √3 l) in the root of the covariance
SECOND = 0.5 * math.sqrt(REACH_SQUARE - 1.0) / REACH_SQUARE  # factor of f(x + √3 l) + f(x − √3 l) − 2 f(x) in it
SHIFT = 0.5 / REACH_SQUARE  # factor of the same in the mean
_SLOW = 2.0  # standard deviations of the velocity beyond which no point stops, at √3 of them


@njit(cache=True, inline="always")
def may_stop(before: float, after: float, variance: float) -> bool:
    """Whether a ball of these velocities [m/s] and of this variance [m²/s²] may stop in the step between them."""
    return before * after <= 0.0 or min(abs(before), abs(after)) < _SLOW * math.sqrt(variance)


@njit(cache=True)
def step_at_points(
    x: FloatArray,
    s: float,
    v: float,
    L: FloatArray,
    M: FloatArray,
    A: FloatArray,
    B: FloatArray,
    dt: float,
    beam: BeamTable,
    first: int,
    last: int,
    p: FloatArray,
    local: FloatArray,
) -> tuple[float, float]:
    """Mean (s, ṡ) after the steps from `first` to `last`.

    The rows of s and ṡ in the compound root M, shape (5, 10), are replaced: first differences in the columns of L and
    of the error's noise, process noise and second differences, whose covariance is 2 × 2, together in the columns of
    process noise.

    Args:
        x: state (s, ṡ, e, ė, ë) before.
        s, v: after the steps from x.
        L: root of the covariance before, shape (5, 5).
        A, B: transition of (e, ė, ë) over the step and root of its noise, shape (3, 3).
        dt: time between the stamps [s].
        local: workspace, shape (3, 3 or 4).
    """
    L, M, beam, p = borrowed(L), borrowed(M), borrowed(beam), borrowed(p)
    ends, path = np.empty((2, 2)), path_of(p)
    mean_s, mean_v = s, v
    variance_s = M[0, 5] ** 2
    covariance = M[0, 5] * M[1, 5]
    variance_v = M[1, 5] ** 2 + M[1, 6] ** 2
    spread = rate_noise(B)  # all of the error's noise that moves the ball at once
    for j in range(6):
        for side in range(2):
            reach = REACH if side == 0 else -REACH
            a, b, e0, e1, e2, noise = x[0], x[1], x[2], x[3], x[4], 0.0
            if j < 5:
                a, b = a + reach * L[0, j], b + reach * L[1, j]
                e0, e1, e2 = e0 + reach * L[2, j], e1 + reach * L[3, j], e2 + reach * L[4, j]
            else:
                noise = reach * spread
            change = (rate_change(A, e0, e1, e2) + noise) / dt
            since = 0.0
            for i in range(first, last):
                shifted(beam, i, since, e0, e1, e2, change, local)
                since += beam.steps[i]
                on = beam_step(path, local, 0, p)
                a, b, _ = ball_step(path, on, a, b, 0.0, beam.steps[i], local, 0, p)
            ends[side, 0], ends[side, 1] = a, b
        by_s, by_v = FIRST * (ends[0, 0] - ends[1, 0]), FIRST * (ends[0, 1] - ends[1, 1])
        if j < 5:
            M[0, j], M[1, j] = by_s, by_v
        else:
            for c in range(3):
                share = B[1, c] / spread if spread > 0.0 else 0.0
                M[0, 7 + c], M[1, 7 + c] = share * by_s, share * by_v
        bend_s, bend_v = ends[0, 0] + ends[1, 0] - 2.0 * s, ends[0, 1] + ends[1, 1] - 2.0 * v
        mean_s, mean_v = mean_s + SHIFT * bend_s, mean_v + SHIFT * bend_v
        variance_s += (SECOND * bend_s) ** 2
        covariance += SECOND * bend_s * SECOND * bend_v
        variance_v += (SECOND * bend_v) ** 2
    M[0, 5] = math.sqrt(variance_s)
    M[1, 5] = covariance / M[0, 5] if variance_s > 0.0 else 0.0
    M[1, 6] = math.sqrt(max(variance_v - M[1, 5] ** 2, 0.0))
    return mean_s, mean_v
