"""Beam motions whose angle, rate and acceleration are known in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.motion import FloatArray
from harness.virtual_rig import Run


@dataclass(frozen=True)
class Fixed:
    """A beam that stands still."""

    tilt: float = 0.0

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return np.full_like(time, self.tilt)

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s]."""
        return np.zeros_like(time)

    acceleration = rate


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


@dataclass(frozen=True)
class Parabola:
    """α = ½ a t²: the beam drops away with a constant α̈ = a [rad/s²] and stops dead at `stop` [s]."""

    steepness: float
    stop: float = np.inf

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return 0.5 * self.steepness * np.minimum(time, self.stop) ** 2

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s]."""
        return np.where(time < self.stop, self.steepness * time, 0.0)

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²]."""
        return np.where(time < self.stop, self.steepness, 0.0)


class Replay:
    """The beam motion of a run; the servo's α is piecewise quadratic, which a cubic reproduces exactly."""

    def __init__(self, run: Run) -> None:
        self.angle = CubicHermiteSpline(run.time, run.angle, run.rate)
        self.rate = self.angle.derivative(1)
        self.acceleration = self.angle.derivative(2)
