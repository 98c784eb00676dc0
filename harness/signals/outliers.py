"""Smoothing of a signal with outliers ("spikes"), on both sides of it or on one.

A reading is the signal plus core noise N(0, σ²), or, with probability ε, a spike N(b, τ²) about it. All of σ, ε, b, τ
are estimated by expectation maximisation together with the density of the prior: each pass weighs a reading by the
probability that it is no spike. With the offset b, the signal of a sensor that drops out to one side follows the core
of the readings instead of their mean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.signals.quantised import rough_noise
from harness.signals.roughness import Stiffness, scoring_step
from harness.signals.spline_smoother import LOG_DENSITIES, Smoothed, kalman_smoother

_PASSES = 80
_SETTLED = 2e-3  # of the core's variance
_SETTLED_STRIDE = 0.02  # of the log density
_HEAD_START = 4  # passes before the noise is estimated from the signal's residuals
_WITHOUT_SPIKES = 20  # passes in which all is noise: looked for at once, spikes are found wherever the start is wrong
_REACH = 3.0  # standard deviations of the core within which a reading is noise and no spike
_DISTINCT = 5.0  # times the core's standard deviation: no sensor's noise varies so much over its range
_PRIOR_READINGS = 2.0  # weight of the prior that there are no spikes
_DECLARED_READINGS = 20.0  # for how many readings a declared noise counts


@dataclass(frozen=True)
class Noise:
    """The mixture: core variance σ² [unit²], share of spikes ε [1], their offset b [unit] and variance τ² [unit²]."""

    core: float
    share: float
    offset: float
    spike_variance: float

    @property
    def has_spikes(self) -> bool:
        """Whether the spikes are distinct from the core, to one side or far wider; if not, they are noise of a variance
        that differs between readings, as a laser's with the distance."""
        return abs(self.offset) > math.sqrt(self.spike_variance) or self.spike_variance > _DISTINCT**2 * self.core

    @property
    def total(self) -> float:
        """Variance of core and spikes together, about the signal [unit²]."""
        return (1.0 - self.share) * self.core + self.share * (self.spike_variance + self.offset**2)

    def probability(self, residual: FloatArray, posterior: FloatArray) -> FloatArray:
        """That a reading is no spike, from its residual and the signal's variance there, shape (n,) each [1]."""
        log_odds = (
            math.log((1.0 - self.share) / self.share)
            - 0.5 * (math.log(self.core / self.spike_variance) + (residual**2 + posterior) / self.core)
            + 0.5 * ((residual - self.offset) ** 2 + posterior) / self.spike_variance
        )
        return np.asarray(1.0 / (1.0 + np.exp(-np.clip(log_odds, -500.0, 500.0))))


@dataclass(frozen=True)
class Spiky:
    """A smoothed signal and the estimated noise.

    Attributes:
        smoothed: the signal.
        variance: of the Gaussian measurement equivalent to each reading, shape (n,), infinite where none [unit²].
        noise: the estimate, rounding included.
        core: probability that a reading is no spike, shape (n,); 0 where none was taken.
    """

    smoothed: Smoothed
    variance: FloatArray
    noise: Noise
    core: FloatArray


def _learn(
    weight: FloatArray, residual: FloatArray, posterior: FloatArray, least: float, declared: float, prior_weight: float
) -> Noise:
    """The M-step: the mixture given each reading's probability `weight` of being no spike, shape (n,)."""
    total, spikes = float(weight.sum()), float((1.0 - weight).sum())
    energy = float(weight @ (residual**2 + posterior))
    core = max((prior_weight * declared**2 + energy) / (prior_weight + total), least**2)
    offset = float((1.0 - weight) @ residual) / (spikes + _PRIOR_READINGS)
    spread = float((1.0 - weight) @ ((residual - offset) ** 2 + posterior)) / (spikes + _PRIOR_READINGS)
    share = (spikes + 1e-3 * _PRIOR_READINGS) / (total + spikes + _PRIOR_READINGS)
    return Noise(core, share, offset, max(spread, _REACH**2 * core - offset**2, core))


def smooth_spiky(
    time: FloatArray,
    value: FloatArray,
    *,
    least: float = 0.0,
    declared: float | None = None,
    least_density: float = 0.0,
) -> Spiky:
    """Smooth a signal with spikes.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        value: readings, shape (n,), NaN where none was taken [unit].
        least: the core noise is no smaller, e.g. that of rounding [unit].
        declared: the declared core noise, which counts for 20 readings [unit].
        least_density: the density of the white third derivative is no smaller [unit²/s⁵].
    """
    n = len(time)
    known = np.isfinite(value)
    value = np.where(known, value, 0.0)
    least = max(least, 1e-9)
    lowest = math.log(least_density) if least_density > 0.0 else LOG_DENSITIES[0]
    declared, weight = (0.0, 0.0) if declared is None else (declared, _DECLARED_READINGS)
    core = known.astype(float)
    noise = Noise(max(rough_noise(value[known]), least) ** 2, 0.0, 0.0, 0.0)
    stiffness = Stiffness.constant(time, lowest)
    mean, covariance, energy, dof = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty(n - 1), np.empty(n - 1)
    for turn in range(_PASSES):
        with np.errstate(divide="ignore"):
            variance = np.where(core > 1e-6, noise.core / core, np.inf)
        density = np.exp(stiffness.log_density)[stiffness.knot]
        evidence = kalman_smoother(time, value, variance, density, mean, covariance, energy, dof)
        stride = scoring_step(stiffness.knot, stiffness.coupling, stiffness.lowest, energy, dof, stiffness.log_density)
        if turn < _HEAD_START:
            continue
        residual, posterior = (value - mean[:, 0])[known], covariance[known, 0, 0]
        if turn == _WITHOUT_SPIKES:
            # The mean lies between core and spikes; most readings are core, so that their median lies within it.
            residual = residual - np.median(residual)
            far = np.abs(residual)
            core[known] = far <= _REACH * 1.4826 * np.median(far)
        elif turn > _WITHOUT_SPIKES:
            core[known] = noise.probability(residual, posterior)
        before, noise = noise, _learn(core[known], residual, posterior, least, declared, weight)
        settled = stride < _SETTLED_STRIDE and abs(noise.core / before.core - 1.0) < _SETTLED
        if turn > _WITHOUT_SPIKES and settled:
            break
    return Spiky(Smoothed(time, mean, covariance, density, float(evidence)), variance, noise, core)
