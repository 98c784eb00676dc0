"""When a ball would lift off the beam: where the normal force that eq. 14 asks for is a pull.

A model of a rolling ball holds it on the beam whatever the beam does. Its normal force says how far that is true.
"""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from analytic.rig import Rig


def normal_acceleration(position: FloatArray, velocity: FloatArray, beam: FloatArray, rig: Rig) -> FloatArray:
    """N/m = g cos(α + α₀) − 2 ṡ α̇ − s α̈ − (h + r) α̇², negative where the beam would have to pull [m/s²].

    Args:
        position, velocity: of the ball, s [m] and ṡ [m/s], shape (n,).
        beam: α [rad], α̇ [rad/s], α̈ [rad/s²], shape (n, 3).
        rig: the rig.

    Returns:
        Shape (n,).
    """
    angle, rate, angular = beam.T
    weight = rig.gravity * np.cos(angle + rig.level_angle)
    height = rig.eccentricity + rig.rolling_radius
    return np.asarray(weight - 2.0 * velocity * rate - position * angular - height * rate**2, dtype=np.float64)


def first_lift_off(position: FloatArray, velocity: FloatArray, beam: FloatArray, rig: Rig) -> int | None:
    """Index of the first row at which the normal force is negative, if any; arguments as of `normal_acceleration`."""
    pulled = normal_acceleration(position, velocity, beam, rig) < 0.0
    return int(np.argmax(pulled)) if pulled.any() else None
