"""Smoothing of a rounded signal: a count says that the value lay within half a step, not that it was the count.

The likelihood of a count c of step q with sensor noise σ before rounding is P(c − q/2 < x + n < c + q/2). Expectation
propagation (Minka, 2001; Rasmussen and Williams, "Gaussian Processes for Machine Learning", section 3.6) replaces each
by the Gaussian of the same posterior moments, its site. Unlike white noise of variance q²/12 this uses that a change of
count tells exactly when a threshold was crossed.

Equal noiseless counts of a resting signal repeat one piece of information. Expectation propagation takes them for
independent and makes the hold too certain. Power expectation propagation (Minka, 2004) with the number of repetitions
as its power is exact there, because a box to any power is the same box. Counts with noise are independent: power 1.

Noise, where unknown, is estimated by expectation maximisation in the same passes, and so is the stiffness.

Where a value moves up and down about a threshold, its counts tell when it crosses, and not how far it goes: a motion
of a hundredth of a count crosses at the same times as one of half a count, and the stiffest prior comes out. Without
noise, counts between a change up and one down are a motion that turns within the count. The prior's standard deviation
over their time is there at least that of a place within a count, q/√12.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.motion import FloatArray
from harness.signals.roughness import Stiffness, scoring_step
from harness.signals.spline_smoother import Smoothed, kalman_smoother

# No encoder's thresholds are spaced better than a twentieth of a count: noise below that has no effect.
EDGE_NOISE = 0.05
_REPEATED = 0.3  # of half a count: equal counts are repetitions while the prior's deviation is below this
_TURN = 3  # stamps: fewer counts between opposite changes may be those of a creep whose threshold is uncertain
_PASSES = 60
_PASSES_FOR_NOISE = 30
_DAMPING = 0.7
_CONVERGED = 3e-3  # of half a count: far below any error bar
_CONVERGED_STRIDE = 0.05  # of the log density
_HEAD_START = 4  # passes over the sites before stiffness and noise are estimated from them
_OVERRELAXATION = 2.0  # of the noise: the plain M-step converges slowly where the noise is small
_LEAST_NOISE = 1e-3  # of a count, or of a continuous reading's first guess
# Noise of a continuous reading without any [unit], and the finest count: of a constant that is known more exactly than
# that, the filter's wide prior leaves no digits of the covariances (one in ten came out infinite at a tenth of it).
_EXACT = 1e-7


@njit(cache=True)
def _normal_cdf(x: float) -> float:
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


@njit(cache=True)
def _truncated_normal(m: float, w: float, low: float, high: float) -> tuple[float, float]:
    """Mean and variance of N(u; m, w²) truncated to low < u < high."""
    a, b, sign = (low - m) / w, (high - m) / w, 1.0
    if a > 0.0:  # mirrored, so that the tail is always the lower one, where erfc keeps its digits
        a, b, sign = -b, -a, -1.0
    mass = _normal_cdf(b) - _normal_cdf(a)
    if mass > 1e-280:
        pa, pb = math.exp(-0.5 * a * a) / math.sqrt(2 * math.pi), math.exp(-0.5 * b * b) / math.sqrt(2 * math.pi)
        shift = (pa - pb) / mass
        shrink = 1.0 + (a * pa - b * pb) / mass - shift * shift
    else:  # asymptotically an exponential distribution at the nearer threshold, of rate |b|
        shift, shrink = b + 1.0 / b, 1.0 / (b * b)
    return m + sign * w * shift, w * w * min(max(shrink, 1e-12), 1.0)


@njit(cache=True)
def _runs(time: FloatArray, count: FloatArray, half: float) -> tuple[FloatArray, FloatArray]:
    """How many equal counts in a row each one belongs to [1], and how long they last [s]; shape (n,) each."""
    n = len(time)
    many, long = np.ones(n), np.zeros(n)
    begin = 0
    for k in range(1, n + 1):
        if k == n or not abs(count[k] - count[begin]) < half:
            many[begin:k] = k - begin
            long[begin:k] = time[k - 1] - time[begin]
            begin = k
    return many, long


def _let_turn(
    time: FloatArray, count: FloatArray, half: float, knot: NDArray[np.int64], lowest: FloatArray
) -> FloatArray:
    """Least log density at the knots, shape (m,), where the value moves up and down about a threshold.

    No lower than `lowest`. Such a motion turns within two counts in a row at least; a large one passes those beside the
    one in which it turns. There the prior's variance over the time t of equal counts, d t⁵/20, is that of a place
    within a count. Stamps without a reading are passed over.

    Args:
        time: stamps, shape (n,) [s].
        count: readings, shape (n,), NaN where none was taken [unit].
        half: half the distance of two counts [unit].
        knot: of each step, shape (n − 1,).
        lowest: log density at the knots, shape (m,) [log unit²/s⁵].
    """
    known = np.flatnonzero(np.isfinite(count))
    change = np.diff(count[known])
    changes = np.flatnonzero(np.abs(change) > half)
    up = change[changes] > 0.0
    turns = (up[1:] != up[:-1]) & (np.diff(changes) >= _TURN)  # of the counts between two changes
    dithers = turns & (np.append(False, turns[:-1]) | np.append(turns[1:], False))
    least, first = lowest.copy(), known[changes + 1]
    for i in np.flatnonzero(dithers):
        begin, end = first[i], first[i + 1]
        turning = math.log(20.0 * half**2 / 3.0 / (time[end] - time[begin]) ** 5)
        np.maximum.at(least, knot[begin:end], turning)
    return least


class _Readings(NamedTuple):
    """Stamps [s] and values [unit], NaN where none was taken, shape (n,); half a count, 0 for continuous readings."""

    time: FloatArray
    value: FloatArray
    half: float


class _Prior(NamedTuple):
    """As in `Stiffness`; density of each step, shape (n − 1,), which an empty `log_density` leaves as it is given."""

    knot: NDArray[np.int64]
    coupling: FloatArray
    lowest: FloatArray
    log_density: FloatArray
    density: FloatArray


class _Sites(NamedTuple):
    """Gaussian measurements that stand for the readings: precision, and precision · value; shape (n,)."""

    precision: FloatArray
    shift: FloatArray


@njit(cache=True)
def _propagate(
    readings: _Readings,
    prior: _Prior,
    sites: _Sites,
    noise: float,
    learn_noise: bool,
    passes: int,
    mean: FloatArray,
    covariance: FloatArray,
) -> tuple[float, float]:
    """Iterate sites, stiffness and noise to convergence, in place; return log evidence and noise.

    The sites of continuous readings are their values with the noise's variance.
    """
    time, count, half = readings
    knot, coupling, lowest, log_density, density = prior
    precision, shift = sites
    n = len(time)
    value, variance = np.empty(n), np.empty(n)
    energy, dof = np.empty(n - 1), np.empty(n - 1)
    many, long = _runs(time, count, half)
    learn_density = len(log_density) > 0
    least_noise = _LEAST_NOISE * 2.0 * half if half > 0.0 else max(_LEAST_NOISE * noise, _EXACT)
    evidence = 0.0
    for turn in range(passes):
        sharp = half > 0.0 and not learn_noise and noise <= 2.0 * half * EDGE_NOISE
        deviation = max(noise, 2.0 * half * EDGE_NOISE) if not learn_noise else noise
        for k in range(n):
            informs = precision[k] > 1e-12
            variance[k] = 1.0 / precision[k] if informs else np.inf
            value[k] = shift[k] / precision[k] if informs else 0.0
        if learn_density:
            for k in range(n - 1):
                density[k] = math.exp(log_density[knot[k]])
        evidence = kalman_smoother(time, value, variance, density, mean, covariance, energy, dof)
        worst, noise_energy, informing = 0.0, 0.0, 0
        for k in range(n):
            if math.isnan(count[k]):
                continue
            V, m = covariance[k, 0, 0], mean[k, 0]
            if half == 0.0:
                noise_energy += (count[k] - m) ** 2 + V
                informing += 1
                continue
            power = 1.0
            if sharp and long[k] > 0.0:
                # Within this time the prior's standard deviation stays below a share of half a count.
                rigid = (20.0 * (_REPEATED * half) ** 2 / density[min(k, n - 2)]) ** 0.2
                # Some precision must remain, so that the cavity stays a distribution.
                power = max(min(many[k] * min(1.0, rigid / long[k]), 0.98 / (V * precision[k])), 1.0)
            cavity = 1.0 / V - power * precision[k]
            if cavity <= 1e-9 * precision[k]:
                continue
            vc = 1.0 / cavity
            mc = vc * (m / V - power * shift[k])
            total = vc + deviation**2
            mu, vu = _truncated_normal(mc, math.sqrt(total), count[k] - half, count[k] + half)  # of x + n
            r = vc / total
            mt, vt = mc + r * (mu - mc), vc + r * r * (vu - total)
            noise_energy += ((1.0 - r) * (mu - mc)) ** 2 + (1.0 - r) ** 2 * (vu - total) + deviation**2
            informing += 1
            worst = max(worst, abs(m - mt) / half)
            precision[k] += _DAMPING * (max((1.0 / vt - cavity) / power, 1e-12) - precision[k])
            shift[k] += _DAMPING * ((mt / vt - mc * cavity) / power - shift[k])
        if turn < _HEAD_START:
            continue
        stride = scoring_step(knot, coupling, lowest, energy, dof, log_density) if learn_density else 0.0
        if learn_noise:
            ratio = max(noise_energy / (informing * deviation**2), 1e-3) ** (0.5 * _OVERRELAXATION)
            noise = max(deviation * ratio, least_noise)
            if half == 0.0:
                for k in range(n):
                    if precision[k] > 0.0:
                        shift[k] *= 1.0 / (noise**2 * precision[k])
                        precision[k] = 1.0 / noise**2
            worst = max(worst, abs(ratio - 1.0))
        if worst < _CONVERGED and stride < _CONVERGED_STRIDE:
            break
    return evidence, noise


def smooth_rounded(
    time: FloatArray,
    count: FloatArray,
    step: float,
    noise: float | None = 0.0,
    density: float | FloatArray | None = None,
) -> tuple[Smoothed, FloatArray, float]:
    """Smooth a signal that was rounded to the nearest multiple of `step`, or a continuous one.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        count: readings, shape (n,), NaN where none was taken [unit].
        step: distance of two counts, 0 for a continuous reading [unit]; one below 1e-7 is taken for 0.
        noise: standard deviation of the sensor before rounding [unit]; no less than a twentieth of `step` is assumed.
            `None` to estimate it.
        density: of the white third derivative, one or that of each step, shape (n − 1,) [unit²/s⁵]; by default it is
            estimated along the record.

    Returns:
        The smoothed signal (its evidence is that of the sites), the variance of the Gaussian measurement equivalent
        to each reading, shape (n,) [unit²], infinite where there is none, and the noise, given or estimated [unit].
    """
    n = len(time)
    step = step if step >= _EXACT else 0.0
    time, count = np.asarray(time, float), np.asarray(count, float)
    mean, covariance = np.empty((n, 3)), np.empty((n, 3, 3))
    known = np.isfinite(count)
    stiffness = Stiffness.over(time)
    log_density = stiffness.log_density if density is None else np.empty(0)
    path = np.full(n - 1, 1.0 if density is None else density)

    readings = _Readings(time, count, 0.5 * step)
    prior = _Prior(stiffness.knot, stiffness.coupling, stiffness.lowest, log_density, path)

    def begin(noise: float) -> _Sites:
        precision = np.where(known, 1.0 / (step**2 / 12.0 + max(noise, EDGE_NOISE * step) ** 2), 0.0)
        return _Sites(precision, precision * np.where(known, count, 0.0))

    if noise is None:
        guess = max(0.2 * step, rough_noise(count[known]), _EXACT)
        _, noise = _propagate(readings, prior, begin(guess), guess, True, _PASSES_FOR_NOISE, mean, covariance)
        # The estimate converges slowly towards zero: below this it is no dither.
        if noise < 2.0 * EDGE_NOISE * step:
            noise = 0.0
    if step > 0.0 and noise <= EDGE_NOISE * step:
        prior = prior._replace(lowest=_let_turn(time, count, 0.5 * step, prior.knot, prior.lowest))
    sites = begin(noise)
    evidence, _ = _propagate(readings, prior, sites, noise, False, _PASSES, mean, covariance)
    with np.errstate(divide="ignore"):
        variance = np.where(sites.precision > 1e-12, 1.0 / sites.precision, np.inf)
    return Smoothed(time, mean, covariance, path, evidence), variance, noise


def rough_noise(value: FloatArray) -> float:
    """Robust estimate of a signal's noise from its second differences, which hardly contain a smooth motion [unit]."""
    second = np.diff(value, 2)
    return 1.4826 * float(np.median(np.abs(second))) / math.sqrt(6.0) if len(second) else 0.0
