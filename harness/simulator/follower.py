"""What the beam does behind its linkage: along a curve, in steps, with lags, on a support that tilts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import expm

from analytic.compiled import njit
from analytic.motion import FloatArray


@dataclass(frozen=True, kw_only=True)
class Follower:
    """T β̇ + β = mean of θ + a θ² + b θ³ over the last hold, θ what the linkage asks of the beam; a servo follows β.

    Before the run the beam turned at the rate of its first instant. The jumps of a beam that is held in steps would
    throw the ball off its edges; a real beam, which does not jump, takes the mean of them.
    The support, level at first, tilts with all that stands on it: the beam turns by `drift` besides.

    Attributes:
        square, cube: a, b [1/rad, 1/rad²].
        hold: length of the steps [s].
        lag: T [s].
        servo_lag, servo_damping: L [s], ζ [1] of a servo behind that, (L/2ζ)² γ̈ + L γ̇ + γ = β.
        drift: of the support [rad/s].

    Raises:
        ValueError: a value is out of its range.
    """

    square: float = 0.0
    cube: float = 0.0
    hold: float = 0.0
    lag: float = 0.0
    servo_lag: float = 0.0
    servo_damping: float = 1.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        for name in ("hold", "lag", "servo_lag"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be finite and not negative")
        if not 0.0 < self.servo_damping < math.inf:
            raise ValueError(f"servo_damping is {self.servo_damping}; it must be finite and positive")
        for name in ("square", "cube", "drift"):
            if not math.isfinite(getattr(self, name)):
                raise ValueError(f"{name} is {getattr(self, name)}; it must be finite")

    @property
    def rigid(self) -> bool:
        """Whether the beam does what it is asked."""
        return self == Follower()

    def follow(self, asked: FloatArray, beam: FloatArray, dt: float, first: int, last: int) -> None:
        """Move the beam over the instants `first` to `last`, those before already done.

        Args:
            asked: θ, θ̇, θ̈ at all instants, known up to `last`, shape (3, n) [rad, rad/s, rad/s²].
            beam: β, β̇, β̈, filled, shape (3, n).
            dt: distance of the instants [s].
        """
        reach = asked[:, : last + 1]
        if self.square != 0.0 or self.cube != 0.0:
            reach = _bent(reach, self.square, self.cube)
        if self.hold > 0.0:
            reach = _mean(reach, dt, self.hold, max(first - 1, 0))
        square = (0.5 * self.servo_lag / self.servo_damping) ** 2
        moved = _served(self.servo_lag, square, dt) if square > 0.0 else np.zeros((2, 4))
        _follow(reach, beam, dt, self.lag, self.servo_lag, square, moved, self.drift, first, last)


@lru_cache
def _served(lag: float, square: float, dt: float) -> FloatArray:
    """What γ and γ̇ are after a step, of γ, γ̇ and β, β̇ at its start, for a β that is linear within, shape (2, 4)."""
    rates = np.zeros((4, 4))
    rates[0, 1] = rates[2, 3] = 1.0
    rates[1, :3] = np.array([-1.0, -lag, 1.0]) / square
    return np.ascontiguousarray(expm(dt * rates)[:2])


def _bent(asked: FloatArray, square: float, cube: float) -> FloatArray:
    """θ + a θ² + b θ³ with its rates, shape (3, n), of θ with its rates."""
    angle, rate, acceleration = asked
    slope, bend = 1.0 + 2.0 * square * angle + 3.0 * cube * angle**2, 2.0 * square + 6.0 * cube * angle
    bent = angle + square * angle**2 + cube * angle**3
    return np.stack((bent, slope * rate, slope * acceleration + bend * rate**2))


@njit(cache=True)
def _mean(asked: FloatArray, dt: float, hold: float, first: int) -> FloatArray:
    """Mean of θ over the last `hold` [s] with its rates from `first` on, shape (3, n), of θ with its rates."""
    mean = asked.copy()
    whole = int(hold / dt)
    part = hold / dt - whole
    for i in range(first, asked.shape[1]):
        total = 0.0
        for j in range(i - whole, i):  # trapezoids, over whole steps and what is left of one before them
            total += 0.5 * (_then(asked, 0, j, dt) + _then(asked, 0, j + 1, dt))
        late = [0.0, 0.0]
        for row in range(2):
            here, before = _then(asked, row, i - whole, dt), _then(asked, row, i - whole - 1, dt)
            late[row] = here + part * (before - here)
        total += part * 0.5 * (_then(asked, 0, i - whole, dt) + late[0])
        mean[0, i] = total * dt / hold
        mean[1, i] = (asked[0, i] - late[0]) / hold
        mean[2, i] = (asked[1, i] - late[1]) / hold
    return mean


@njit(cache=True, inline="always")
def _then(asked: FloatArray, row: int, i: int, dt: float) -> float:
    """θ or θ̇ at instant i, which may lie before the run."""
    if i >= 0:
        return asked[row, i]
    return asked[0, 0] + i * dt * asked[1, 0] if row == 0 else asked[1, 0]


@njit(cache=True)
def _follow(
    asked: FloatArray,
    beam: FloatArray,
    dt: float,
    lag: float,
    servo_lag: float,
    square: float,
    moved: FloatArray,
    drift: float,
    first: int,
    last: int,
) -> None:
    rest = math.exp(-dt / lag) if lag > 0.0 else 0.0
    for i in range(first, last + 1):
        angle, rate, acceleration = asked[0, i], asked[1, i], asked[2, i]
        carried, carried_rate, before = 0.0, 0.0, 0.0  # of the beam, and what it follows
        if i > 0:
            carried, carried_rate = beam[0, i - 1] - drift * (i - 1) * dt, beam[1, i - 1] - drift
            before = square * beam[2, i - 1] + servo_lag * carried_rate + carried
        if lag > 0.0:
            if i == 0:
                angle -= lag * rate
            else:  # exact for a θ that is linear within the step
                trail = lag * (angle - asked[0, i - 1]) / dt
                angle += (before - asked[0, i - 1] + trail) * rest - trail
            acceleration = (rate - (asked[0, i] - angle) / lag) / lag
            rate = (asked[0, i] - angle) / lag
        if square > 0.0:
            asks = angle
            if i == 0:
                angle -= servo_lag * rate
            else:
                slope = (asks - before) / dt
                angle = moved[0, 0] * carried + moved[0, 1] * carried_rate + moved[0, 2] * before + moved[0, 3] * slope
                rate = moved[1, 0] * carried + moved[1, 1] * carried_rate + moved[1, 2] * before + moved[1, 3] * slope
            acceleration = (asks - angle - servo_lag * rate) / square
        beam[0, i], beam[1, i], beam[2, i] = angle + drift * i * dt, rate + drift, acceleration
