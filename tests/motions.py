"""Beam motions whose angle, rate and acceleration are known in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray


@dataclass(frozen=True)
class Fixed:
    """A beam that stands still at α = `tilt` [rad]."""

    tilt: float = 0.0

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return np.full_like(time, self.tilt)

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s]."""
        return np.zeros_like(time)

    acceleration = rate


@dataclass(frozen=True)
class Ramp:
    """A beam that turns at a constant α̇ = `speed` [rad/s] and passes α = `tilt` [rad] at t = 0."""

    speed: float
    tilt: float = 0.0

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return self.tilt + self.speed * time

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s]."""
        return np.full_like(time, self.speed)

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²]."""
        return np.zeros_like(time)


@dataclass(frozen=True)
class Sines:
    """Σ a sin(ω t + p) over (a [rad], ω [rad/s], p [rad]); the default moves by about 3°."""

    terms: tuple[tuple[float, float, float], ...] = ((0.04, 1.7, 0.0), (0.02, 3.1, 0.4))

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return sum((a * np.sin(w * time + p) for a, w, p in self.terms), np.zeros_like(time))

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s]."""
        return sum((a * w * np.cos(w * time + p) for a, w, p in self.terms), np.zeros_like(time))

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²]."""
        return sum((-a * w * w * np.sin(w * time + p) for a, w, p in self.terms), np.zeros_like(time))
