"""One number of an effect: its unit, its bounds, and where a fit of it begins."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from analytic.effects.force import EffectError
from analytic.motion import FloatArray
from analytic.rig import Rig

Starts = Callable[[FloatArray, Rig], Sequence[float]]
"""Where fits begin, from the positions that the recordings visit, shape (n,) [m], and the rig."""
Bounds = Callable[[FloatArray, Rig], tuple[float, float]]
"""Bounds of a fit, from the same."""
Range = tuple[float, float]

_PLACE = 0.03  # how well a place along the beam can be guessed [m]
_FACTOR_OFF = 0.05  # how far a factor or a radius is typically off, relative to what it should be [1]


@dataclass(frozen=True)
class Limits:
    """Unit (SI, "1" for a number) of a value and its bounds, both included."""

    unit: str
    low: float
    high: float


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect.

    Attributes:
        name: public, as in results.
        unit: in SI, "1" for a number.
        low, high: bounds.
        typical: a size at which the effect matters; not 0.
        starts: where fits begin; where the effect does nothing if there are none and that is not 0, else at the typical
            size.
        neutral: where the effect does nothing, on any rig or as a function of it.
        strength: whether the effect vanishes as the parameter goes to 0.
        place: whether it is a place along the beam.
        fitted: bounds of a fit, where they depend on the recordings or the rig, or are closer than `low` and `high`.
        usual: range, the upper end excluded, or as a function of the rig, outside of which a finding is implausible:
            bounds are wider, so that a fit that wants to leave it shows that it does.
        by_recording: whether each recording has a value of its own, which then stands in the law in its place; the
            parameter itself is their standard deviation.
        shown: the unit in which people speak of it, and the factor from SI, where SI's own is not that.

    Raises:
        EffectError: bounds or sizes that cannot be.
    """

    name: str
    unit: str
    low: float
    high: float
    typical: float
    starts: tuple[float, ...] | Starts = ()
    neutral: float | Callable[[Rig], float] = 0.0
    strength: bool = False
    place: bool = False
    fitted: Bounds | None = None
    shown: tuple[str, float] | None = None
    by_recording: bool = False
    usual: Range | Callable[[Rig], Range] | None = None

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise EffectError(f"{self.name!r} is no name for a parameter; use letters, digits and _")
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise EffectError(
                f"{self.name}: bounds {self.low:g} and {self.high:g}; they must be finite, the lower one first"
            )
        for value in (self.typical, *self.fixed_starts):
            if not self.low <= value <= self.high:
                raise EffectError(f"{self.name}: {value:g} lies outside its bounds, {self.low:g} to {self.high:g}")
        if isinstance(self.usual, tuple) and not self.usual[0] <= self.typical < self.usual[1]:
            raise EffectError(f"{self.name}: typical is {self.typical:g}, outside the usual range")
        if self.typical == 0.0:
            raise EffectError(f"{self.name}: typical is 0; give a size at which the effect matters")

    @property
    def fixed_starts(self) -> tuple[float, ...]:
        """Where fits begin whatever the recordings and the rig."""
        return () if callable(self.starts) else self.starts

    def usual_on(self, rig: Rig) -> Range | None:
        """The range of plausible values on this rig, the upper end excluded; `None` if any is."""
        return self.usual(rig) if callable(self.usual) else self.usual

    def plausible(self, value: float, rig: Rig) -> bool:
        """Whether a value is in the usual range."""
        usual = self.usual_on(rig)
        return usual is None or usual[0] <= value < usual[1]

    def neutral_on(self, rig: Rig) -> float:
        """Where the effect does nothing on this rig, in the parameter's unit."""
        return self.neutral(rig) if callable(self.neutral) else self.neutral

    def size(self, rig: Rig) -> float:
        """How far the parameter typically is from doing nothing, in its unit."""
        if self.place:
            return _PLACE
        neutral = self.neutral_on(rig)
        return _FACTOR_OFF * neutral if neutral else abs(self.typical)

    def direction_on(self, visited: FloatArray, rig: Rig) -> float:
        """Towards which side of doing nothing, +1 or −1, it is typically off: towards the other where that is none.

        Args:
            visited: positions, shape (n,) [m].
        """
        neutral = self.neutral_on(rig)
        direction = math.copysign(1.0, self.typical - neutral)
        low, high = self.bounds_on(visited, rig)
        room = high - neutral if direction > 0.0 else neutral - low
        return direction if room >= self.size(rig) else -direction

    def typical_on(self, visited: FloatArray, rig: Rig) -> float:
        """A typical value on this rig, in its unit: as far from doing nothing as it typically is."""
        return self.neutral_on(rig) + self.direction_on(visited, rig) * self.size(rig)

    def starts_on(self, visited: FloatArray, rig: Rig) -> Sequence[float]:
        """Where fits begin, for recordings that visit these positions, shape (n,) [m]."""
        if callable(self.starts):
            return self.starts(visited, rig)
        return self.starts or (self.neutral_on(rig) or self.typical,)

    def bounds_on(self, visited: FloatArray, rig: Rig) -> tuple[float, float]:
        """Bounds of a fit to recordings that visit these positions, shape (n,) [m]."""
        return (self.low, self.high) if self.fitted is None else self.fitted(visited, rig)
