"""Beam motions whose angle, rate and acceleration are known in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from analytic.motion import FloatArray
from harness.virtual_rig import Run
from tests.motions import Fixed, Sines

__all__ = ["Fixed", "Parabola", "Replay", "Sines"]


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
