"""What the beam does behind its linkage: it follows with a lag, on a support that tilts."""

from __future__ import annotations

import math
from dataclasses import dataclass

from analytic.compiled import njit
from analytic.motion import FloatArray


@dataclass(frozen=True, kw_only=True)
class Follower:
    """T β̇ + β = θ, θ what the linkage asks of the beam; before the run it turned at the rate of its first instant.

    The support, level at first, tilts with all that stands on it: the beam turns by `drift` besides.

    Attributes:
        lag: T [s].
        drift: of the support [rad/s].

    Raises:
        ValueError: a value is out of its range.
    """

    lag: float = 0.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.lag < math.inf:
            raise ValueError(f"lag is {self.lag}; it must be finite and not negative")
        if not math.isfinite(self.drift):
            raise ValueError(f"drift is {self.drift}; it must be finite")

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
        _follow(asked, beam, dt, self.lag, self.drift, first, last)


@njit(cache=True)
def _follow(asked: FloatArray, beam: FloatArray, dt: float, lag: float, drift: float, first: int, last: int) -> None:
    rest = math.exp(-dt / lag) if lag > 0.0 else 0.0
    for i in range(first, last + 1):
        angle, rate, acceleration = asked[0, i], asked[1, i], asked[2, i]
        if lag > 0.0:
            if i == 0:
                angle -= lag * rate
            else:  # exact for a θ that is linear within the step
                trail = lag * (angle - asked[0, i - 1]) / dt
                carried = beam[0, i - 1] - drift * (i - 1) * dt
                angle += (carried - asked[0, i - 1] + trail) * rest - trail
            acceleration = (rate - (asked[0, i] - angle) / lag) / lag
            rate = (asked[0, i] - angle) / lag
        beam[0, i], beam[1, i], beam[2, i] = angle + drift * i * dt, rate + drift, acceleration
