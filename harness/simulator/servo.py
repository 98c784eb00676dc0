"""The servo that turns the beam: second order, with limited rate and acceleration."""

from __future__ import annotations

from typing import NamedTuple

from analytic.compiled import njit
from analytic.motion import FloatArray


class Servo(NamedTuple):
    """A position servo, α̈ = ω₀² (α_c − α) − 2 ζ ω₀ α̇ as long as no limit acts.

    Attributes:
        natural_frequency: ω₀ [rad/s].
        damping: ζ [1].
        rate_limit: largest rate asked for [rad/s].
        acceleration_limit: largest |α̈| [rad/s²].
    """

    natural_frequency: float = 15.0
    damping: float = 0.9
    rate_limit: float = 0.5
    acceleration_limit: float = 6.0

    def follow(self, command: float, dt: float, angle: FloatArray, rate: FloatArray, acceleration: FloatArray) -> None:
        """Move from the first instant on towards a constant command.

        α̈ is constant within a step, so α and α̇ at the instants are exact for the motion they describe, and α̇ has
        no jumps.

        Args:
            command: α_c [rad].
            dt: distance of the instants [s].
            angle: α, shape (n + 1,); the first is given, the others are filled [rad].
            rate: α̇, likewise [rad/s].
            acceleration: α̈ from each instant on, shape (n + 1,); all are filled [rad/s²].
        """
        _follow(self, command, dt, angle, rate, acceleration)


@njit(cache=True)
def _follow(
    servo: Servo, command: float, dt: float, angle: FloatArray, rate: FloatArray, acceleration: FloatArray
) -> None:
    position_gain = servo.natural_frequency / (2.0 * servo.damping)
    rate_gain = 2.0 * servo.damping * servo.natural_frequency
    rate_limit, acceleration_limit = servo.rate_limit, servo.acceleration_limit
    for i in range(angle.size):
        wanted = min(max(position_gain * (command - angle[i]), -rate_limit), rate_limit)
        acceleration[i] = min(max(rate_gain * (wanted - rate[i]), -acceleration_limit), acceleration_limit)
        if i + 1 < angle.size:
            angle[i + 1] = angle[i] + dt * (rate[i] + 0.5 * dt * acceleration[i])
            rate[i + 1] = rate[i] + dt * acceleration[i]
