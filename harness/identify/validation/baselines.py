"""Two baselines, which a diagnosis has to beat, fitted to the same recordings and compared on the same windows.

The *double integrator* is s̈ = k (α + α₀). The *output-error model* of order two, s(t) = B(q)/F(q) α(t) with three
coefficients in B and two in F, is a black box (Ljung, System Identification, 2nd ed., section 4.2); its constant input
represents an angle offset.

Both are linear but for F: gains and initial states follow by linear least squares, and only the two parameters of F are
searched for (variable projection, Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973). They are fitted to free runs over
windows as long as the predicted ones, which gives lower errors than whole recordings (docs/diagnosis_experiments.md).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.optimize import least_squares
from scipy.signal import lfilter

from analytic.motion import FloatArray
from harness.identify.problem.windows import Window

# Bounds of F, as λ² + f₁ λ + f₀ = 0 with λ = ln(z)/T: growth by at most e⁵ in a second, decay within one or two
# readings, oscillation below half the sampling rate.
_SLOWEST, _FASTEST = -5.0, 4.0  # [1/s], [1 per step]
_STARTS = ((0.0, 0.0), (1.0, 1.0))  # f₁ [1/s] and f₀ [1/s²]: the double integrator, and a damped oscillator
_DIFFERENCE = 1e-4  # relative step of finite differences in f₁ and f₀


class Law(Protocol):
    """A model that is linear in its gains and in the initial state of a window."""

    def driven(self, window: Window) -> FloatArray:
        """Response to each input from rest at 0, for a gain of 1, shape (m, gains)."""
        ...

    def free(self, window: Window) -> FloatArray:
        """Free response to each of two initial states, shape (m, 2)."""
        ...


@dataclass(frozen=True)
class DoubleIntegrator:
    """s̈ = k α + k α₀."""

    def driven(self, window: Window) -> FloatArray:
        """∬α dt² and ½ t²."""
        rate = cumulative_simpson(window.angle, x=window.grid, initial=0.0)
        return window.at_stamps([cumulative_simpson(rate, x=window.grid, initial=0.0), 0.5 * window.grid**2])

    def free(self, window: Window) -> FloatArray:
        """1 and t."""
        return np.column_stack((np.ones_like(window.time), window.time))


@dataclass(frozen=True)
class OutputError:
    """B(q)/F(q) with poles exp(λ T), λ² + f₁ λ + f₀ = 0; `poles` are f₁ [1/s] and f₀ [1/s²]."""

    poles: tuple[float, float]

    def denominator(self, step: float) -> FloatArray:
        """Coefficients of F(q) in q⁰, q⁻¹, q⁻², shape (3,), for a sampling interval `step` [s]."""
        first, zeroth = self.poles
        square = zeroth - 0.25 * first**2  # of the angular frequency
        cosine = math.cos(step * math.sqrt(square)) if square >= 0.0 else math.cosh(step * math.sqrt(-square))
        return np.array([1.0, -2.0 * math.exp(-0.5 * first * step) * cosine, math.exp(-first * step)])

    def driven(self, window: Window) -> FloatArray:
        """α/F with delays of 0, 1 and 2 steps, and 1/F."""
        F = self.denominator(window.step)
        direct = lfilter([1.0], F, window.angle)
        delayed = (np.concatenate((np.zeros(lag), direct[:-lag])) for lag in (1, 2))
        return window.at_stamps([direct, *delayed, lfilter([1.0], F, np.ones_like(direct))])

    def free(self, window: Window) -> FloatArray:
        """1/F of an impulse at the first and at the second stamp."""
        pulses = np.eye(2, len(window.grid))
        return window.at_stamps(list(lfilter([1.0], self.denominator(window.step), pulses)))


@dataclass(frozen=True)
class Baseline:
    """A fitted law with its gains, shape (gains,)."""

    law: Law
    gains: FloatArray

    def predict(self, window: Window) -> FloatArray:
        """Positions at all stamps of a window, shape (m,) [m]; the initial state by least squares on its known part."""
        driven, free = self.law.driven(window) @ self.gains, self.law.free(window)
        known = window.known
        initial = np.linalg.lstsq(free[known], (window.reading - driven)[known], rcond=None)[0]
        return driven + free @ initial


def fit_double_integrator(windows: Sequence[Window]) -> Baseline:
    """k and k α₀ by least squares over free runs of the windows."""
    law = DoubleIntegrator()
    return Baseline(law, _gains(law, windows)[0])


def fit_output_error(windows: Sequence[Window]) -> Baseline:
    """B and F by least squares over free runs of the windows."""
    fastest = _FASTEST / max(window.step for window in windows)
    low, high = (_SLOWEST, -(_SLOWEST**2)), (fastest, fastest**2)

    def residuals(poles: FloatArray) -> FloatArray:
        return _gains(OutputError((float(poles[0]), float(poles[1]))), windows)[1]

    fits = [least_squares(residuals, start, bounds=(low, high), diff_step=[_DIFFERENCE] * 2) for start in _STARTS]
    best = min(fits, key=lambda fit: float(fit.cost))
    law = OutputError((float(best.x[0]), float(best.x[1])))
    return Baseline(law, _gains(law, windows)[0])


def _gains(law: Law, windows: Sequence[Window]) -> tuple[FloatArray, FloatArray]:
    """Gains by least squares, with an initial state per window, and the residuals, shape (readings,) [m]."""
    driven, reading = [], []
    for window in windows:
        use = np.isfinite(window.reading)
        columns = np.column_stack((law.driven(window), window.reading))[use]
        basis, _ = np.linalg.qr(law.free(window)[use])
        projected = columns - basis @ (basis.T @ columns)  # eliminates the initial state
        driven.append(projected[:, :-1])
        reading.append(projected[:, -1])
    A, y = np.concatenate(driven), np.concatenate(reading)
    gains = np.asarray(np.linalg.lstsq(A, y, rcond=None)[0], dtype=np.float64)
    return gains, y - A @ gains
