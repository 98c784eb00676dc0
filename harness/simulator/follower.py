"""What the beam does behind its linkage: it follows with a lag."""

from __future__ import annotations

import math
from dataclasses import dataclass

from analytic.compiled import njit
from analytic.motion import FloatArray


@dataclass(frozen=True, kw_only=True)
class Follower:
    """T β̇ + β = θ, θ what the linkage asks of the beam; before the run it turned at the rate of its first instant.

    Attributes:
        lag: T [s].

    Raises:
        ValueError: a value is out of its range.
    """

    lag: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.lag < math.inf:
            raise ValueError(f"lag is {self.lag}; it must be finite and not negative")

    @property
    def rigid(self) -> bool:
        """Whether the beam does what it is asked."""
        return self.lag == 0.0

    def follow(self, asked: FloatArray, beam: FloatArray, dt: float, first: int, last: int) -> None:
        """Move the beam over the instants `first` to `last`, those before already done.

        Args:
            asked: θ, θ̇, θ̈ at all instants, known up to `last`, shape (3, n) [rad, rad/s, rad/s²].
            beam: β, β̇, β̈, filled, shape (3, n).
            dt: distance of the instants [s].
        """
        _lag(asked, beam, dt, self.lag, first, last)


@njit(cache=True)
def _lag(asked: FloatArray, beam: FloatArray, dt: float, lag: float, first: int, last: int) -> None:
    rest = math.exp(-dt / lag)
    for i in range(first, last + 1):
        if i == 0:
            beam[0, 0] = asked[0, 0] - lag * asked[1, 0]
        elif i > first:  # exact for a θ that is linear within the step
            trail = lag * (asked[0, i] - asked[0, i - 1]) / dt
            beam[0, i] = asked[0, i] - trail + (beam[0, i - 1] - asked[0, i - 1] + trail) * rest
        beam[1, i] = (asked[0, i] - beam[0, i]) / lag
        beam[2, i] = (asked[1, i] - beam[1, i]) / lag
