"""Beam motions whose angle, rate and acceleration are known in closed form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray


@dataclass(frozen=True)
class Fixed:
    """A beam that stands still at α = `tilt` [rad]."""

    tilt: float = 0.0

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return np.full_like(time, self.tilt)

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        return np.zeros_like(time)


@dataclass(frozen=True)
class Ramp:
    """A beam that turns at a constant α̇ = `speed` [rad/s] and passes α = `tilt` [rad] at t = 0."""

    speed: float
    tilt: float = 0.0

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return self.tilt + self.speed * time

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        return np.full_like(time, self.speed if order == 1 else 0.0)


@dataclass(frozen=True)
class Sines:
    """Σ a sin(ω t + p) over (a [rad], ω [rad/s], p [rad]); the default moves by about 3°."""

    terms: tuple[tuple[float, float, float], ...] = ((0.04, 1.7, 0.0), (0.02, 3.1, 0.4))

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return sum((a * np.sin(w * time + p) for a, w, p in self.terms), np.zeros_like(time))

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        if order == 2:
            return sum((-a * w * w * np.sin(w * time + p) for a, w, p in self.terms), np.zeros_like(time))
        return sum((a * w * np.cos(w * time + p) for a, w, p in self.terms), np.zeros_like(time))


@dataclass(frozen=True)
class ClosedForm:
    """A beam motion given by three functions of time: α [rad], α̇ [rad/s], α̈ [rad/s²]."""

    evaluate: Callable[[FloatArray], FloatArray]
    rate: Callable[[FloatArray], FloatArray]
    acceleration: Callable[[FloatArray], FloatArray]

    def derivative(self, time: FloatArray, order: int = 1) -> FloatArray:
        """α̇ [rad/s] or α̈ [rad/s²]."""
        return (self.rate, self.acceleration)[order - 1](time)
