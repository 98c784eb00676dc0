"""Beam motions whose angle, rate and acceleration are known in closed form."""

from __future__ import annotations

import numpy as np

from tests.motions import ClosedForm, Fixed, Sines

__all__ = ["Fixed", "Sines", "parabola"]


def parabola(steepness: float, stop: float = np.inf) -> ClosedForm:
    """α = ½ a t²: the beam drops away with a constant α̈ = a [rad/s²] and stops dead at `stop` [s]."""
    return ClosedForm(
        lambda time: 0.5 * steepness * np.minimum(time, stop) ** 2,
        lambda time: np.where(time < stop, steepness * time, 0.0),
        lambda time: np.where(time < stop, steepness, 0.0),
    )
