"""Baselines, which a diagnosis has to beat, fitted to the same windows and compared on the same held-out blocks.

*At rest*, the ball stays where it was last; at *constant velocity*, it goes on as it went. They know nothing of the
beam; over how many of the last known seconds their start is taken is fitted. The *double integrator* is
s̈ = k (α + α₀). The *output-error models* of order two and three are black boxes
(`harness.identify.validation.output_error`). In closed loop they may read the controller backwards: where the angle is
a function of the position, a model of that function's inverse predicts the position from the angle and describes no
beam.

Gains and initial states follow by linear least squares. All are fitted to free runs over windows as long as the
predicted ones, which gives lower errors than whole recordings (docs/diagnosis_experiments.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.integrate import cumulative_simpson

from analytic.motion import FloatArray
from harness.identify.problem.windows import KNOWN, Window
from harness.identify.validation.output_error import OutputError, fit_poles

_MEMORIES = (0.1, 0.2, 0.4, 0.7, 1.0, KNOWN)  # spans that the start of a baseline may be taken over [s]


class BaselineLaw(Protocol):
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
class Baseline:
    """A fitted law with its gains, shape (gains,), and the last known seconds that its start is taken over."""

    law: BaselineLaw
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
    return Baseline(law, _gains(law, windows))


def fit_output_error(windows: Sequence[Window], order: int = 2, near: Baseline | None = None) -> Baseline:
    """B and F of order two or three by least squares over free runs of the windows.

    Args:
        near: a fit to most of these windows, from whose poles the search starts.
    """
    known = None if near is None else near.law
    assert known is None or isinstance(known, OutputError)
    return Baseline(*fit_poles(windows, order, known))


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


def _with_memory(law: BaselineLaw, windows: Sequence[Window]) -> Baseline:
    """A law without gains, with the memory of least squares over the predicted parts."""
    choices = [Baseline(law, np.empty(0), memory) for memory in _MEMORIES]
    return min(choices, key=lambda one: sum(window.rms_error(one.predict(window)) ** 2 for window in windows))


def _gains(law: BaselineLaw, windows: Sequence[Window]) -> FloatArray:
    """Gains by least squares, with an initial state per window."""
    projected = []
    for window in windows:
        use = np.isfinite(window.reading)
        Q = np.linalg.qr(law.free(window)[use])[0]
        columns = np.column_stack((law.driven(window), window.reading))[use]
        projected.append(columns - Q @ (Q.T @ columns))  # eliminates the initial state
    readings = np.concatenate(projected)
    return np.asarray(np.linalg.lstsq(readings[:, :-1], readings[:, -1], rcond=None)[0], dtype=np.float64)
