"""Smoothing of a rounded signal: a count says that the value lay within half a step, not that it was the count.

The likelihood of a count c of step q with sensor noise σ before rounding is P(c − q/2 < x + n < c + q/2). Expectation
propagation (Minka, 2001; Rasmussen and Williams, "Gaussian Processes for Machine Learning", section 3.6) replaces each
by the Gaussian that serves the posterior best, its site. Unlike white noise of variance q²/12 this knows that a change
of count tells exactly when a threshold was crossed.

Sharp counts of a resting signal repeat one piece of information, which is more than propagation can see: site by site
it takes the others for independent Gaussians and makes the hold too certain. Power propagation (Minka, 2004) with a
power as large as the number of repetitions is exact there, because a box to any power is the same box. Counts with
noise are no repetitions, and get the power 1.

Noise, where unknown, is learnt on the way by expectation maximisation, and so is the stiffness.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.motion import FloatArray
from harness.signals.roughness import Stiffness, rescore
from harness.signals.spline_smoother import Smoothed, kalman_smoother

# No encoder's thresholds are spaced better than a twentieth of a count; noise below that does not tell counts apart.
EDGE_NOISE = 0.05
_WANDER = 0.3  # of half a count: a signal that cannot go further than this repeats itself
_PASSES = 60
_PASSES_FOR_NOISE = 30
_DAMPING = 0.7
_SETTLED = 3e-3  # of half a count: far below what any error bar resolves
_SETTLED_STRIDE = 0.05  # of the log density
_HEAD_START = 4  # passes for the sites before stiffness and noise are learnt from them
_OVERRELAXATION = 2.0  # of the noise: the plain M-step creeps where the noise is small
_LEAST_NOISE = 1e-3  # of a count, or of a continuous reading's first guess
# Noise of a continuous reading that shows none [unit]: below it covariances at the least stiffness lose their digits.
_EXACT = 1e-8


@njit(cache=True)
def _normal_cdf(x: float) -> float:
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


@njit(cache=True)
def _boxed(m: float, w: float, low: float, high: float) -> tuple[float, float]:
    """Mean and variance of N(u; m, w²) cut to low < u < high."""
    a, b, sign = (low - m) / w, (high - m) / w, 1.0
    if a > 0.0:  # mirror, so that the tail is always the lower one, where erfc keeps its digits
        a, b, sign = -b, -a, -1.0
    mass = _normal_cdf(b) - _normal_cdf(a)
    if mass > 1e-280:
        pa, pb = math.exp(-0.5 * a * a) / math.sqrt(2 * math.pi), math.exp(-0.5 * b * b) / math.sqrt(2 * math.pi)
        shift = (pa - pb) / mass
        shrink = 1.0 + (a * pa - b * pb) / mass - shift * shift
    else:  # all mass sits at the nearer threshold, exponentially with rate |b|
        shift, shrink = b + 1.0 / b, 1.0 / (b * b)
    return m + sign * w * shift, w * w * min(max(shrink, 1e-12), 1.0)


@njit(cache=True)
def _rest(time: FloatArray, count: FloatArray, half: float) -> tuple[FloatArray, FloatArray]:
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


@njit(cache=True, nogil=True)
def _settle(
    time: FloatArray,
    count: FloatArray,
    half: float,
    noise: float,
    learn_noise: bool,
    passes: int,
    knot: NDArray[np.int64],
    coupling: FloatArray,
    log_density: FloatArray,
    density: FloatArray,
    precision: FloatArray,
    shift: FloatArray,
    mean: FloatArray,
    covariance: FloatArray,
) -> tuple[float, float]:
    """Settle sites (precision, shift = precision · value), stiffness and noise; return log evidence and noise.

    `half` a count is 0 for a continuous reading, whose sites are its values with the noise's variance. A count that is
    NaN has no site. An empty `log_density` leaves `density` as it is given.
    """
    n = len(time)
    value, variance = np.empty(n), np.empty(n)
    surprise, freedom = np.empty(n - 1), np.empty(n - 1)
    many, long = _rest(time, count, half)
    learn_density = len(log_density) > 0
    least_noise = _LEAST_NOISE * 2.0 * half if half > 0.0 else max(_LEAST_NOISE * noise, _EXACT)
    evidence = 0.0
    for turn in range(passes):
        sharp = half > 0.0 and not learn_noise and noise <= 2.0 * half * EDGE_NOISE
        spread = max(noise, 2.0 * half * EDGE_NOISE) if not learn_noise else noise
        for k in range(n):
            informs = precision[k] > 1e-12
            variance[k] = 1.0 / precision[k] if informs else np.inf
            value[k] = shift[k] / precision[k] if informs else 0.0
        if learn_density:
            for k in range(n - 1):
                density[k] = math.exp(log_density[knot[k]])
        evidence = kalman_smoother(time, value, variance, density, mean, covariance, surprise, freedom)
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
                # Time in which the prior wanders by a share of half a count: within it counts are repetitions.
                rigid = (20.0 * (_WANDER * half) ** 2 / density[min(k, n - 2)]) ** 0.2
                # What else is known of the value must remain, so that the cavity stays a distribution.
                power = max(min(many[k] * min(1.0, rigid / long[k]), 0.98 / (V * precision[k])), 1.0)
            cavity = 1.0 / V - power * precision[k]
            if cavity <= 1e-9 * precision[k]:
                continue
            vc = 1.0 / cavity
            mc = vc * (m / V - power * shift[k])
            total = vc + spread**2
            mu, vu = _boxed(mc, math.sqrt(total), count[k] - half, count[k] + half)  # of x + n
            r = vc / total
            mt, vt = mc + r * (mu - mc), vc + r * r * (vu - total)
            noise_energy += ((1.0 - r) * (mu - mc)) ** 2 + (1.0 - r) ** 2 * (vu - total) + spread**2
            informing += 1
            worst = max(worst, abs(m - mt) / half)
            precision[k] += _DAMPING * (max((1.0 / vt - cavity) / power, 1e-12) - precision[k])
            shift[k] += _DAMPING * ((mt / vt - mc * cavity) / power - shift[k])
        if turn < _HEAD_START:
            continue
        stride = rescore(knot, coupling, surprise, freedom, log_density) if learn_density else 0.0
        if learn_noise:
            ratio = max(noise_energy / (informing * spread**2), 1e-3) ** (0.5 * _OVERRELAXATION)
            noise = max(spread * ratio, least_noise)
            if half == 0.0:
                for k in range(n):
                    if precision[k] > 0.0:
                        shift[k] *= 1.0 / (noise**2 * precision[k])
                        precision[k] = 1.0 / noise**2
            worst = max(worst, abs(ratio - 1.0))
        if worst < _SETTLED and stride < _SETTLED_STRIDE:
            break
    return evidence, noise


def smooth_rounded(
    time: FloatArray,
    count: FloatArray,
    step: float,
    noise: float | None = 0.0,
    density: float | None = None,
) -> tuple[Smoothed, FloatArray, float]:
    """Smooth a signal that was rounded to the nearest multiple of `step`, or a continuous one.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        count: readings, shape (n,), NaN where none was taken [unit].
        step: distance of two counts, 0 for a continuous reading [unit].
        noise: standard deviation of the sensor before rounding [unit]; no less than a twentieth of `step` is assumed.
            `None` to estimate it.
        density: of the white third derivative [unit²/s⁵]; by default it is learnt along the record.

    Returns:
        The smoothed signal (its evidence is that of the sites), the variance of the Gaussian measurement that stands
        for each reading, shape (n,) [unit²], infinite where there is none, and the noise, given or estimated [unit].
    """
    n = len(time)
    time, count = np.asarray(time, float), np.asarray(count, float)
    mean, covariance = np.empty((n, 3)), np.empty((n, 3, 3))
    known = np.isfinite(count)
    stiffness = Stiffness.over(time)
    log_density = stiffness.log_density if density is None else np.empty(0)
    path = np.full(n - 1, 1.0 if density is None else density)

    def begin(noise: float) -> tuple[FloatArray, FloatArray]:
        precision = np.where(known, 1.0 / (step**2 / 12.0 + max(noise, EDGE_NOISE * step) ** 2), 0.0)
        return precision, precision * np.where(known, count, 0.0)

    def settle(noise: float, learn: bool, passes: int, sites: tuple[FloatArray, FloatArray]) -> tuple[float, float]:
        found: tuple[float, float] = _settle(
            time, count, 0.5 * step, noise, learn, passes,
            stiffness.knot, stiffness.coupling, log_density, path, *sites, mean, covariance,
        )  # fmt: skip
        return found

    if noise is None:
        guess = max(0.2 * step, rough_noise(count[known]), _EXACT)
        sites = begin(guess)
        _, noise = settle(guess, True, _PASSES_FOR_NOISE, sites)
        # Learning creeps towards zero; what it has not brought above this by now is no dither.
        if noise < 2.0 * EDGE_NOISE * step:
            noise = 0.0
    sites = begin(noise)
    evidence, _ = settle(noise, False, _PASSES, sites)
    with np.errstate(divide="ignore"):
        variance = np.where(sites[0] > 1e-12, 1.0 / sites[0], np.inf)
    return Smoothed(time, mean, covariance, path, evidence), variance, noise


def rough_noise(value: FloatArray) -> float:
    """Noise of a signal from its second differences, robustly: they hardly see a smooth motion [unit of `value`]."""
    second = np.diff(value, 2)
    return 1.4826 * float(np.median(np.abs(second))) / math.sqrt(6.0) if len(second) else 0.0
