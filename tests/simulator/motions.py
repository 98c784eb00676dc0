"""Beam motions whose angle, rate and acceleration are known in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from tests.motions import Fixed, Sines

__all__ = ["Fixed", "Parabola", "Sines"]


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
