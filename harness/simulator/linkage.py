"""The linkage between the shaft whose angle is measured and the beam: a ratio, and play."""

from __future__ import annotations

import math
from dataclasses import dataclass

from analytic.compiled import njit
from analytic.motion import FloatArray


@dataclass(frozen=True, kw_only=True)
class Linkage:
    """β = gain · play(θ), θ the measured angle and β the beam's.

    Within the play the beam stands still. A flank is met softly over a part of the width: dβ/dθ rises from 0 to 1 in
    proportion to how far the flank gives, which is 1 − exp(−(way into it)/δ). Nothing lags and nothing springs back, so
    that the total width stays b; only the corner is round, as an oiled or slightly elastic joint has it.

    Attributes:
        gain: beam angle per angle of the shaft [1].
        width: b, total width of the play [rad].
        corner: δ/b [1]; 0.5 at most.
        play_start: where the shaft begins within its play, −1 (lower flank) … 1 (upper flank) [1].

    Raises:
        ValueError: a value is out of its range.
    """

    gain: float = 1.0
    width: float = 0.0
    corner: float = 0.05
    play_start: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 < self.gain < math.inf:
            raise ValueError(f"gain is {self.gain}; it must be positive")
        if not 0.0 <= self.width < math.inf:
            raise ValueError(f"width is {self.width}; it must be finite and not negative")
        if not 1e-3 <= self.corner <= 0.5:
            raise ValueError(f"corner is {self.corner}; it must lie between 0.001 and 0.5")
        if not abs(self.play_start) <= 1.0:
            raise ValueError(f"play_start is {self.play_start}; it must lie between -1 and 1")

    @property
    def rigid(self) -> bool:
        """Whether the beam is the shaft."""
        return self.gain == 1.0 and self.width == 0.0

    def begin(self, shaft: float) -> float:
        """Where a rigid shaft would stand for the beam's angle at the start, shaft at θ = `shaft` [rad]."""
        return shaft - 0.5 * self.width * self.play_start

    def transmit(self, carried: float, shaft: FloatArray, beam: FloatArray) -> float:
        """Move the beam as the shaft moves.

        Args:
            carried: β/gain at the first instant, from `begin` or the last call [rad].
            shaft: θ, θ̇, θ̈, shape (3, n) [rad, rad/s, rad/s²].
            beam: β, β̇, β̈, filled, shape (3, n); its first instant as well.

        Returns:
            β/gain at the last instant [rad].
        """
        return float(_transmit(carried, self.gain, self.width, self.corner * self.width, shaft, beam))


@njit(cache=True)
def _transmit(carried: float, gain: float, width: float, soft: float, shaft: FloatArray, beam: FloatArray) -> float:
    hard = 0.5 * width - soft  # |play| at which a flank is met
    for i in range(shaft.shape[1]):
        angle, rate, acceleration = shaft[0, i], shaft[1, i], shaft[2, i]
        if width == 0.0:
            carried = angle
        elif i > 0:
            before = shaft[0, i - 1]
            sign = 1.0 if angle > before else -1.0
            into = sign * (before - carried) - hard
            way = abs(angle - before) + min(into, 0.0)  # what is left of it after the free play
            if way > 0.0:
                into = soft - (soft - max(into, 0.0)) * math.exp(-way / soft)
                carried = angle - sign * (hard + into)
        share, turning = 1.0, 0.0
        if width > 0.0:
            sign = 1.0 if rate > 0.0 else -1.0
            share = min(max((sign * (angle - carried) - hard) / soft, 0.0), 1.0)
            if share > 0.0:
                turning = sign * rate * rate * (1.0 - share) / soft
        beam[0, i] = gain * carried
        beam[1, i] = gain * rate * share
        beam[2, i] = gain * (acceleration * share + turning)
    return carried
