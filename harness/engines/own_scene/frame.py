"""The frame in which a rig is described, found in a scene that was built in another one.

World frame of the harness (`analytic.geometry`): origin on the pivot axis, y along the axis about which a positive α
turns, z up, x along the level beam towards +s. In a user's scene the axis is that of the beam's joint, up is against
gravity, and x follows from both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.errors import InputError

MOST_LEAN = 1e-3  # of the axis against the horizontal [rad]: changes g sin α by 5e-7


@dataclass(frozen=True, eq=False)
class Frame:
    """The harness's frame in a scene's world.

    Attributes:
        origin: on the axis of the beam's joint, in the scene's world, shape (3,) [m].
        axes: unit vectors x, y, z of the frame in the scene's world, one a row, shape (3, 3).
    """

    origin: FloatArray
    axes: FloatArray

    def inside(self, points: FloatArray) -> FloatArray:
        """Points of the scene's world, shape (…, 3) [m], in this frame; the same shape."""
        return np.asarray((points - self.origin) @ self.axes.T, dtype=np.float64)

    def outside(self, points: FloatArray) -> FloatArray:
        """Points of this frame, shape (…, 3) [m], in the scene's world; the same shape."""
        return np.asarray(self.origin + points @ self.axes, dtype=np.float64)

    def direction_inside(self, vectors: FloatArray) -> FloatArray:
        """Vectors of the scene's world, shape (…, 3), in this frame; the same shape."""
        return np.asarray(vectors @ self.axes.T, dtype=np.float64)

    def direction_outside(self, vectors: FloatArray) -> FloatArray:
        """Vectors of this frame, shape (…, 3), in the scene's world; the same shape."""
        return np.asarray(vectors @ self.axes, dtype=np.float64)

    def shifted(self, across: float) -> Frame:
        """The same with its origin at y = `across` [m], in the middle of a track that lies there."""
        return Frame(self.origin + across * self.axes[1], self.axes)


def frame_of(place: str, anchor: FloatArray, axis: FloatArray, up: FloatArray, direction: int) -> Frame:
    """The frame of a hinge.

    Args:
        place: file and joint, for a message.
        anchor, axis: of the hinge in the scene's world, shape (3,) [m], [1].
        up: against gravity, shape (3,), of any length.
        direction: +1 if α grows with the joint's angle, −1 if it falls.

    Raises:
        InputError: the axis is not horizontal.
    """
    y = direction * np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    vertical = np.asarray(up, dtype=float) / np.linalg.norm(up)
    lean = math.asin(min(1.0, abs(float(y @ vertical))))
    if lean > MOST_LEAN:
        raise InputError(
            f"{place}: the joint's axis leans by {math.degrees(lean):.2f}° against the horizontal. Make it horizontal, "
            "across the beam, or correct the direction of gravity."
        )
    x = np.cross(y, vertical)
    x /= np.linalg.norm(x)
    return Frame(np.asarray(anchor, dtype=float), np.array([x, y, np.cross(x, y)]))


def tilted(gravity: FloatArray, level_angle: float) -> FloatArray:
    """Gravity of a frame, shape (3,) [m/s²], turned as if a level beam stood at `level_angle` [rad]."""
    cos, sin = math.cos(level_angle), math.sin(level_angle)
    x, y, z = gravity
    return np.array([x * cos - z * sin, y, z * cos + x * sin])
