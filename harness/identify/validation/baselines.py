"""Two simple models that a diagnosis has to beat, fitted to the same pieces and asked to predict the same windows.

The *plain double integrator*, s̈ = k (α + α₀), knows that a ball rolls downhill and no more. The *output-error model* of
order two, s(t) = B(q)/F(q) α(t) with three coefficients in B and two in F, is what one fits who knows nothing of balls
(Ljung, System Identification, 2nd ed., section 4.2); its constant input stands for an angle that is off.

Both are linear but for F: gains and the start of every piece follow by linear least squares, and only two numbers are
searched for (variable projection, Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973). They are fitted to free runs over
windows as long as those judged, which suits them better than runs over whole recordings do (docs/diagnosis.md).
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

# Where F is looked for, as λ² + f₁ λ + f₀ = 0 with λ = ln(z)/T: from growth or decay by e⁵ within a second to what is
# over within one or two readings, the fastest oscillation below half the rate.
_SLOWEST, _FASTEST = -5.0, 4.0  # [1/s], [1 per step]
_BEGINS = ((0.0, 0.0), (1.0, 1.0))  # f₁ [1/s] and f₀ [1/s²]: the double integrator, and a damped swing
_DIFFERENCE = 1e-4  # of these, for slopes


class Law(Protocol):
    """A model that is linear in its gains and in the start of a window."""

    def driven(self, window: Window) -> FloatArray:
        """What each gain moves the ball by from rest at 0, shape (m, gains)."""
        ...

    def free(self, window: Window) -> FloatArray:
        """What a start moves the ball by that nothing drives, shape (m, 2)."""
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
    """B(q)/F(q) with F given by its poles exp(λ T), λ² + f₁ λ + f₀ = 0, shape of `poles` (2,): f₁ [1/s], f₀ [1/s²]."""

    poles: tuple[float, float]

    def denominator(self, step: float) -> FloatArray:
        """1, f and f of F(q) = 1 + f q⁻¹ + f q⁻² for readings `step` [s] apart."""
        first, zeroth = self.poles
        turn = zeroth - 0.25 * first**2
        beat = math.cos(step * math.sqrt(turn)) if turn >= 0.0 else math.cosh(step * math.sqrt(-turn))
        return np.array([1.0, -2.0 * math.exp(-0.5 * first * step) * beat, math.exp(-first * step)])

    def driven(self, window: Window) -> FloatArray:
        """α/F now and one and two steps later, and 1/F."""
        F = self.denominator(window.step)
        now = lfilter([1.0], F, window.angle)
        late = (np.concatenate((np.zeros(lag), now[:-lag])) for lag in (1, 2))
        return window.at_stamps([now, *late, lfilter([1.0], F, np.ones_like(now))])

    def free(self, window: Window) -> FloatArray:
        """What the two last outputs before the window leave."""
        pulses = np.eye(2, len(window.grid))
        return window.at_stamps(list(lfilter([1.0], self.denominator(window.step), pulses)))


@dataclass(frozen=True)
class Baseline:
    """A fitted law; `gains` of shape (gains,), as many as `law.driven` has."""

    law: Law
    gains: FloatArray

    def predict(self, window: Window) -> FloatArray:
        """Positions at all stamps of a window, shape (m,) [m]; the start follows from what is known, least squares."""
        run, free = self.law.driven(window) @ self.gains, self.law.free(window)
        known = window.known
        start = np.linalg.lstsq(free[known], (window.reading - run)[known], rcond=None)[0]
        return run + free @ start


def fit_double_integrator(windows: Sequence[Window]) -> Baseline:
    """k and k α₀ by least squares over free runs of the windows."""
    law = DoubleIntegrator()
    return Baseline(law, _gains(law, windows)[0])


def fit_output_error(windows: Sequence[Window]) -> Baseline:
    """B and F by least squares over free runs of the windows."""
    fastest = _FASTEST / max(window.step for window in windows)
    low, high = (_SLOWEST, -(_SLOWEST**2)), (fastest, fastest**2)

    def left(poles: FloatArray) -> FloatArray:
        return _gains(OutputError((float(poles[0]), float(poles[1]))), windows)[1]

    every = [least_squares(left, begin, bounds=(low, high), diff_step=[_DIFFERENCE] * 2) for begin in _BEGINS]
    found = min(every, key=lambda one: float(one.cost))
    law = OutputError((float(found.x[0]), float(found.x[1])))
    return Baseline(law, _gains(law, windows)[0])


def _gains(law: Law, windows: Sequence[Window]) -> tuple[FloatArray, FloatArray]:
    """Gains of least squares, every window with a start of its own; and what they leave, shape (readings,) [m]."""
    driven, reading = [], []
    for window in windows:
        use = np.isfinite(window.reading)
        columns = np.column_stack((law.driven(window), window.reading))[use]
        basis, _ = np.linalg.qr(law.free(window)[use])
        rest = columns - basis @ (basis.T @ columns)
        driven.append(rest[:, :-1])
        reading.append(rest[:, -1])
    A, y = np.concatenate(driven), np.concatenate(reading)
    gains = np.asarray(np.linalg.lstsq(A, y, rcond=None)[0], dtype=np.float64)
    return gains, y - A @ gains
