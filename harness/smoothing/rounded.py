"""Smoothing of a rounded signal: a count says that the value lay within half a step, not that it was the count.

The likelihood of a count c of step q with sensor noise σ before rounding is P(c − q/2 < x + n < c + q/2). Expectation
propagation (Minka, 2001; Rasmussen and Williams, "Gaussian Processes for Machine Learning", section 3.6) replaces each
by the Gaussian that serves the posterior best. Unlike white noise of variance q²/12 this knows that a thousand equal
counts are one piece of information (a hold stays uncertain by its count) and that a change of count tells exactly when
a threshold was crossed.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray
from harness.smoothing.wiener import Smoothed, kalman_smoother

# A threshold sharper than a tenth of a count makes the propagation stall and the error bars too short: no encoder's
# edges are spaced better than that.
EDGE_NOISE = 0.1
_PASSES = 40
_DAMPING = 0.7
_SETTLED = 3e-3  # of half a count: far below what any error bar resolves


@njit(cache=True, inline="always")
def _normal_cdf(x: float) -> float:
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


@njit(cache=True)
def _tilted(m: float, v: float, low: float, high: float, noise: float) -> tuple[float, float, float]:
    """Log mass, mean and variance of N(x; m, v) · P(low < x + n < high), n of variance `noise`."""
    w = math.sqrt(v + noise)
    a, b, sign = (low - m) / w, (high - m) / w, 1.0
    if a > 0.0:  # mirror, so that the tail is always the lower one, where erfc keeps its digits
        a, b, sign = -b, -a, -1.0
    mass = _normal_cdf(b) - _normal_cdf(a)
    if mass > 1e-280:
        pa, pb = math.exp(-0.5 * a * a) / math.sqrt(2 * math.pi), math.exp(-0.5 * b * b) / math.sqrt(2 * math.pi)
        shift = (pa - pb) / mass
        shrink = 1.0 + (a * pa - b * pb) / mass - shift * shift
        log_mass = math.log(mass)
    else:  # all mass sits at the nearer threshold, exponentially with rate |b|
        shift, shrink, log_mass = b + 1.0 / b, 1.0 / (b * b), -0.5 * b * b
    r = v / w
    return log_mass, m + sign * r * shift, v - r * r * (1.0 - max(shrink, 1e-12))


@njit(cache=True, nogil=True)
def _propagate(
    time: FloatArray,
    count: FloatArray,
    half: float,
    noise: float,
    density: float,
    precision: FloatArray,
    shift: FloatArray,
    mean: FloatArray,
    covariance: FloatArray,
) -> float:
    """Settle the sites (precision, shift = precision · value) in place; return the log evidence."""
    n = len(time)
    value, variance, log_site = np.empty(n), np.empty(n), np.zeros(n)
    evidence = 0.0
    for _ in range(_PASSES):
        for k in range(n):
            informs = precision[k] > 1e-12
            variance[k] = 1.0 / precision[k] if informs else np.inf
            value[k] = shift[k] / precision[k] if informs else 0.0
        evidence = kalman_smoother(time, value, variance, density, mean, covariance)
        worst = 0.0
        for k in range(n):
            V, m = covariance[k, 0, 0], mean[k, 0]
            cavity = 1.0 / V - precision[k]
            if cavity <= 1e-9:
                continue
            vc = 1.0 / cavity
            mc = vc * (m / V - shift[k])
            log_mass, mt, vt = _tilted(mc, vc, count[k] - half, count[k] + half, noise)
            new = max(1.0 / vt - cavity, 1e-12)
            new_shift = mt / vt - mc * cavity
            apart = mc - new_shift / new
            log_site[k] = log_mass + 0.5 * math.log(2 * math.pi * (vc + 1.0 / new)) + 0.5 * apart**2 / (vc + 1.0 / new)
            worst = max(worst, abs(m - mt) / half)
            precision[k] += _DAMPING * (new - precision[k])
            shift[k] += _DAMPING * (new_shift - shift[k])
        if worst < _SETTLED:
            break
    return evidence + log_site.sum()


def smooth_rounded(
    time: FloatArray, count: FloatArray, step: float, noise: float = 0.0, density: float | None = None
) -> tuple[Smoothed, FloatArray]:
    """Smooth a signal that was rounded to the nearest multiple of `step`.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        count: rounded values, shape (n,) [unit].
        step: distance of two counts [unit].
        noise: standard deviation of the sensor before rounding [unit]; no less than a tenth of `step` is assumed.
        density: of the white third derivative [unit²/s⁵]; by default the one of greatest evidence.

    Returns:
        The smoothed signal, and the variance of the Gaussian measurement that stands for each count, shape (n,).
    """
    n = len(time)
    time, count = np.asarray(time, float), np.asarray(count, float)
    variance = max(noise, EDGE_NOISE * step) ** 2
    mean, covariance = np.empty((n, 3)), np.empty((n, 3, 3))
    precision, shift = np.empty(n), np.empty(n)

    def settle(log_density: float) -> float:
        precision[:] = 1.0 / (step**2 / 12.0 + variance)
        shift[:] = precision * count
        return _propagate(
            time, count, 0.5 * step, variance, math.exp(log_density), precision, shift, mean, covariance
        )

    if density is None:
        # Where counts are many per move the Gaussian answer is close: search its neighbourhood only.
        flat = np.full(n, step**2 / 12.0 + variance)
        rough = minimize_scalar(
            lambda x: -kalman_smoother(time, count, flat, math.exp(x), mean, covariance),
            bounds=(-18.0, 20.0),
            method="bounded",
            options={"xatol": 0.1},
        ).x
        found = minimize_scalar(
            lambda x: -settle(x), bounds=(rough - 3.0, rough + 3.0), method="bounded", options={"xatol": 0.15}
        )
        density = math.exp(found.x)
    evidence = settle(math.log(density))
    return Smoothed(time, mean, covariance, density, evidence), 1.0 / precision
