"""What lies between the ball and the position as it is recorded: scale, curve, lag, delay."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from analytic.compiled import fixed, njit
from analytic.motion import FloatArray


@dataclass(frozen=True, kw_only=True)
class Channel:
    """The position's way into the record: a first-order lag, then a factor and a curve, then a delay.

    A negative delay cannot hold back the position: it holds back the angle beside it.

    Attributes:
        gain: recorded position per position [1].
        time_constant: τ of the lag, τ ẏ = s − y [s].
        delay: the position at t is recorded at t + delay [s].
        square, cube: gain (y + square y² + cube y³) is recorded of a position y [1/m, 1/m²].

    Raises:
        ValueError: a value is out of its range.
    """

    gain: float = 1.0
    time_constant: float = 0.0
    delay: float = 0.0
    square: float = 0.0
    cube: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.gain < math.inf:
            raise ValueError(f"gain is {self.gain}; it must be positive")
        if not 0.0 <= self.time_constant < math.inf:
            raise ValueError(f"time_constant is {self.time_constant}; it must be finite and not negative")
        for name, value in (("square", self.square), ("cube", self.cube)):
            if not math.isfinite(value):
                raise ValueError(f"{name} is {value}; it must be finite")
        if not math.isfinite(self.delay):
            raise ValueError(f"delay is {self.delay}; it must be finite")

    def lag(self, position: FloatArray, seen: FloatArray, dt: float) -> None:
        """Let the lagged position follow: exact for a position that is linear between the instants.

        Args:
            position: s, shape (n,) [m].
            seen: y, shape (n,); the first is given, the others are filled [m].
            dt: distance of the instants [s].
        """
        _lag(fixed(position), seen, dt, self.time_constant)

    def delivered(self, seen: FloatArray, dt: float, at: FloatArray) -> FloatArray:
        """What the channel delivers.

        Args:
            seen: y at the instants 0, dt, 2 dt …, shape (n,); before them the ball lay where it starts [m].
            dt: distance of the instants [s].
            at: times, shape (k,), none beyond the last instant [s].

        Returns:
            shape (k,) [m].
        """
        places = np.maximum(at - max(self.delay, 0.0), 0.0) / dt
        before = np.minimum((places + 1e-9).astype(np.int64), seen.size - 1)  # an instant met to rounding is met
        part = np.maximum(places - before, 0.0) * (places - before > 1e-8)
        after = np.minimum(before + 1, seen.size - 1)
        held = seen[before] + part * (seen[after] - seen[before])
        return self.gain * held * (1.0 + held * (self.square + held * self.cube))

    def beside(self, angle: FloatArray, dt: float, at: FloatArray) -> FloatArray:
        """The angle that is recorded beside the position: late by −delay where that is positive.

        Args:
            angle: at the instants 0, dt, 2 dt …, shape (n,) [rad].
            dt: distance of the instants [s].
            at: times, shape (k,) [s].

        Returns:
            shape (k,) [rad].
        """
        return Channel(delay=max(-self.delay, 0.0)).delivered(angle, dt, at)

    def read(self, position: FloatArray, dt: float, at: FloatArray) -> FloatArray:
        """What is delivered of a whole run's position, shape (n,) [m], at the times `at`, shape (k,) [s]."""
        seen = position.copy()
        self.lag(position, seen, dt)
        return self.delivered(seen, dt, at)


@njit(cache=True)
def _lag(position: FloatArray, seen: FloatArray, dt: float, time_constant: float) -> None:
    if time_constant == 0.0:
        seen[1:] = position[1:]
        return
    rest = math.exp(-dt / time_constant)
    for i in range(1, position.size):
        trail = time_constant * (position[i] - position[i - 1]) / dt
        seen[i] = position[i] - trail + (seen[i - 1] - position[i - 1] + trail) * rest
