"""What moves and how it moved: beam motions that can be asked at any time, ball states, trajectories."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

BallForce = Callable[[float, float, float, float], float]
"""Extra force on the ball along the beam, F(s [m], ṡ [m/s], α [rad], t [s]) -> [N], positive towards +s."""


class BeamMotion(Protocol):
    """A beam angle that is known at any time, with derivatives that belong to it."""

    def angle(self, time: FloatArray) -> FloatArray:
        """α [rad] at `time` [s], same shape."""
        ...

    def rate(self, time: FloatArray) -> FloatArray:
        """α̇ [rad/s] at `time` [s], same shape."""
        ...

    def acceleration(self, time: FloatArray) -> FloatArray:
        """α̈ [rad/s²] at `time` [s], same shape."""
        ...


@dataclass(frozen=True)
class State:
    """Ball on the beam: position s [m] and velocity ṡ [m/s]."""

    position: float
    velocity: float


@dataclass(frozen=True)
class Trajectory:
    """A ball's run along the beam.

    Attributes:
        source: who says so (`measured`, `cam`, `mujoco` …).
        time: shape (n,), strictly increasing [s].
        position: s, shape (n,) [m].
        velocity: ṡ, shape (n,) [m/s].
    """

    source: str
    time: FloatArray
    position: FloatArray
    velocity: FloatArray
