"""Baselines, which a diagnosis has to beat, fitted to the same windows and compared on the same held-out blocks.

*At rest*, the ball stays where it was last; at *constant velocity*, it goes on as it went. They know nothing of the
beam; over how many of the last known seconds their start is taken is fitted. The *double integrator* is
s̈ = k (α + α₀). The *output-error models* of order two and three, s(t) = B(q)/F(q) α(t) with one coefficient more in B
than in F, are black boxes (Ljung, System Identification, 2nd ed., section 4.2); their constant input represents an
angle offset. In closed loop they may read the controller backwards: where the angle is a function of the position, a
model of that function's inverse predicts the position from the angle and describes no beam.

All are linear but for F: gains and initial states follow by linear least squares, and only the parameters of F are
searched for (variable projection, Golub and Pereyra, SIAM J. Numer. Anal. 10, 1973). They are fitted to free runs over
windows as long as the predicted ones, which gives lower errors than whole recordings (docs/diagnosis_experiments.md).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.optimize import least_squares
from scipy.signal import lfilter

from analytic.motion import FloatArray
from harness.identify.problem.windows import KNOWN, Window

# Bounds of F, as λ² + f₁ λ + f₀ = 0 with λ = ln(z)/T: growth by at most e in a second, three times that of a ball on
# the softest beam measured, since a fit that grows by more predicts kilometres; decay within one or two readings;
# oscillation below half the sampling rate.
_SLOWEST, _FASTEST = -1.0, 4.0  # [1/s], [1 per step]
_STARTS = ((0.0, 0.0), (1.0, 1.0))  # f₁ [1/s] and f₀ [1/s²]: the double integrator, and a damped oscillator
_FURTHER_STARTS = (0.5, 10.0)  # decay of a third pole [1/s]: slower than the beam's motion, and faster
_DIFFERENCE = 1e-4  # relative step of finite differences in F
_CONVERGED = 1e-6  # relative decrease of the sum of squares: half as much of the RMS error
_MEMORIES = (0.1, 0.2, 0.4, 0.7, 1.0, KNOWN)  # spans that the start of a baseline may be taken over [s]


class Law(Protocol):
    """A model that is linear in its gains and in the initial state of a window."""

    def driven(self, window: Window) -> FloatArray:
        """Response to each input from rest at 0, for a gain of 1, shape (m, gains)."""
        ...

    def free(self, window: Window) -> FloatArray:
        """Free response to each initial state, shape (m, states)."""
        ...


@dataclass(frozen=True)
class AtRest:
    """s is constant."""

    def driven(self, window: Window) -> FloatArray:
        """Nothing drives it."""
        return np.empty((len(window.time), 0))

    def free(self, window: Window) -> FloatArray:
        """1."""
        return np.ones((len(window.time), 1))


@dataclass(frozen=True)
class ConstantVelocity:
    """s̈ = 0."""

    def driven(self, window: Window) -> FloatArray:
        """Nothing drives it."""
        return np.empty((len(window.time), 0))

    def free(self, window: Window) -> FloatArray:
        """1 and t."""
        return np.column_stack((np.ones_like(window.time), window.time))


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
    """B(q)/F(q) with poles exp(λ T).

    Of λ² + f₁ λ + f₀ = 0 and, for order three, λ = −f: `poles` are f₁ [1/s], f₀ [1/s²] and f [1/s].
    """

    poles: tuple[float, ...]

    @property
    def order(self) -> int:
        """Of F."""
        return len(self.poles)

    def denominator(self, step: float) -> FloatArray:
        """Coefficients of F(q) in q⁰, q⁻¹, …, shape (order + 1,), for a sampling interval `step` [s]."""
        first, zeroth, *further = self.poles
        square = zeroth - 0.25 * first**2  # of the angular frequency
        cosine = math.cos(step * math.sqrt(square)) if square >= 0.0 else math.cosh(step * math.sqrt(-square))
        F = np.array([1.0, -2.0 * math.exp(-0.5 * first * step) * cosine, math.exp(-first * step)])
        for rate in further:
            F = np.convolve(F, [1.0, -math.exp(-rate * step)])
        return F

    def driven(self, window: Window) -> FloatArray:
        """α/F with delays of 0 to `order` steps, and 1/F."""
        direct = lfilter([1.0], self.denominator(window.step), window.angle)
        pulse = _pulse(self, window.step, len(window.grid))
        return window.at_stamps([*_shifted(direct, self.order + 1), np.cumsum(pulse)])

    def free(self, window: Window) -> FloatArray:
        """1/F of an impulse at each of the first stamps."""
        return window.at_stamps(_shifted(_pulse(self, window.step, len(window.grid)), self.order))


@lru_cache(maxsize=4)  # windows of a recording differ in nothing of it
def _pulse(law: OutputError, step: float, count: int) -> FloatArray:
    """1/F of an impulse at the first of `count` samples, shape (count,)."""
    pulse: FloatArray = lfilter([1.0], law.denominator(step), np.eye(1, count)[0])
    return pulse


def _shifted(signal: FloatArray, count: int) -> list[FloatArray]:
    """A signal later by 0, 1, … samples, shape (n,) each."""
    return [np.concatenate((np.zeros(lag), signal[: len(signal) - lag])) for lag in range(count)]


@dataclass(frozen=True)
class Baseline:
    """A fitted law with its gains, shape (gains,), and the last known seconds that its start is taken over."""

    law: Law
    gains: FloatArray
    memory: float = KNOWN

    def predict(self, window: Window) -> FloatArray:
        """Positions at all stamps of a window, shape (m,) [m].

        The initial state follows by least squares on the end of the known part; from the last readings at least.
        """
        driven, free = self.law.driven(window) @ self.gains, self.law.free(window)
        known = np.flatnonzero(window.known)
        recent = known[window.time[known] >= KNOWN - self.memory]
        use = recent if len(recent) > free.shape[1] else known[-free.shape[1] - 1 :]
        initial = np.linalg.lstsq(free[use], (window.reading - driven)[use], rcond=None)[0]
        return driven + free @ initial


def fit_at_rest(windows: Sequence[Window]) -> Baseline:
    """A ball that stays at its last known place."""
    return _with_memory(AtRest(), windows)


def fit_constant_velocity(windows: Sequence[Window]) -> Baseline:
    """A ball that keeps its last known velocity."""
    return _with_memory(ConstantVelocity(), windows)


def fit_double_integrator(windows: Sequence[Window]) -> Baseline:
    """k and k α₀ by least squares over free runs of the windows."""
    law = DoubleIntegrator()
    return Baseline(law, _gains(law, windows)[0])


def fit_output_error(windows: Sequence[Window], order: int = 2, near: Baseline | None = None) -> Baseline:
    """B and F of order two or three by least squares over free runs of the windows.

    Args:
        near: a fit to most of these windows, from whose poles the search starts.
    """
    fastest = _FASTEST / max(window.step for window in windows)
    low, high = (_SLOWEST, -(_SLOWEST**2), _SLOWEST), (fastest, fastest**2, fastest)
    if near is not None:
        assert isinstance(near.law, OutputError)
        law = _best_poles(windows, [near.law.poles], low[:order], high[:order])
        return Baseline(law, _gains(law, windows)[0])
    law = _best_poles(windows, _STARTS, low[:2], high[:2])
    if order == 3:
        law = _best_poles(windows, [(*law.poles, further) for further in _FURTHER_STARTS], low, high)
    return Baseline(law, _gains(law, windows)[0])


class Fitted(Protocol):
    """Fits a baseline to windows, those that have poles from a fit to most of them if one is given."""

    def __call__(self, windows: Sequence[Window], *, near: Baseline | None = None) -> Baseline:
        """The baseline of least squares over these windows."""
        ...


FITS: Mapping[str, Fitted] = {
    "at_rest": lambda windows, *, near=None: fit_at_rest(windows),
    "constant_velocity": lambda windows, *, near=None: fit_constant_velocity(windows),
    "double_integrator": lambda windows, *, near=None: fit_double_integrator(windows),
    "output_error_2": lambda windows, *, near=None: fit_output_error(windows, 2, near),
    "output_error_3": lambda windows, *, near=None: fit_output_error(windows, 3, near),
}
"""What fits each baseline, by the names of diagnosis.json."""
BLACK_BOXES = ("output_error_2", "output_error_3")
"""Of these, those that are fitted to the forecast and know no physics of a ball."""


def _best_poles(
    windows: Sequence[Window], starts: Sequence[tuple[float, ...]], low: Sequence[float], high: Sequence[float]
) -> OutputError:
    """The output-error model with the poles of least squares, searched for from each of `starts`."""

    def residuals(poles: FloatArray) -> FloatArray:
        return _gains(OutputError(tuple(map(float, poles))), windows)[1]

    fits = [
        least_squares(
            residuals,
            np.clip(start, low, high),
            bounds=(low, high),
            diff_step=[_DIFFERENCE] * len(start),
            ftol=_CONVERGED,
        )
        for start in starts
    ]
    best = min(fits, key=lambda fit: float(fit.cost))
    return OutputError(tuple(map(float, best.x)))


def _with_memory(law: Law, windows: Sequence[Window]) -> Baseline:
    """A law without gains, with the memory of least squares over the predicted parts."""
    choices = [Baseline(law, np.empty(0), memory) for memory in _MEMORIES]
    return min(choices, key=lambda one: sum(window.rms_error(one.predict(window)) ** 2 for window in windows))


def _gains(law: Law, windows: Sequence[Window]) -> tuple[FloatArray, FloatArray]:
    """Gains by least squares, with an initial state per window, and the residuals, shape (readings,) [m]."""
    projected = []
    bases: dict[tuple[float, bytes, bytes], FloatArray] = {}  # windows with the same stamps have the same free response
    for window in windows:
        use = np.isfinite(window.reading)
        stamps = window.step, window.stamps.tobytes(), use.tobytes()
        if stamps not in bases:
            bases[stamps] = np.linalg.qr(law.free(window)[use])[0]
        columns = np.column_stack((law.driven(window), window.reading))[use]
        projected.append(columns - bases[stamps] @ (bases[stamps].T @ columns))  # eliminates the initial state
    readings = np.concatenate(projected)
    A, y = readings[:, :-1], readings[:, -1]
    gains = np.asarray(np.linalg.lstsq(A, y, rcond=None)[0], dtype=np.float64)
    return gains, y - A @ gains
