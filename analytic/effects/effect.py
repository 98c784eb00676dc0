"""What an effect is: a law with named parameters that it writes into the kernel's parameter vector."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from analytic.effects.force import EffectError, Force, Values
from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig

Write = Callable[[FloatArray, Rig, Values], None]
"""Adds an effect to a kernel vector, shape (SLOTS,), in place; effects of one kind add up."""
Alter = Callable[[Rig, Values], Rig]
"""The rig as it is instead of as it is declared."""
Turn = Callable[[BeamMotion, FloatArray, Values], BeamMotion]
"""The beam's motion behind the measured one, over a recording's stamps, shape (n,) [s]."""
Sense = Callable[[FloatArray, FloatArray, Values], FloatArray]
"""What is recorded of a position, both of shape (n,) [m], at stamps, shape (n,) [s]."""


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect.

    Attributes:
        name: public, as in results.
        unit: in SI, "1" for a number.
        low, high: bounds.
        typical: a size at which the effect matters; not 0.
        starts: where fits begin; at the typical size if there are none.

    Raises:
        EffectError: bounds or sizes that cannot be.
    """

    name: str
    unit: str
    low: float
    high: float
    typical: float
    starts: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise EffectError(f"{self.name!r} is no name for a parameter; use letters, digits and _")
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise EffectError(
                f"{self.name}: bounds {self.low:g} and {self.high:g}; they must be finite, the lower one first"
            )
        for value in (self.typical, *self.starts):
            if not self.low <= value <= self.high:
                raise EffectError(f"{self.name}: {value:g} lies outside its bounds, {self.low:g} to {self.high:g}")
        if self.typical == 0.0:
            raise EffectError(f"{self.name}: typical is 0; give a size at which the effect matters")


@dataclass(frozen=True)
class Effect:
    """One entry of the catalogue. It acts in one place: on the ball, on the rig's quantities, on the angle, or on the
    sensor.

    Attributes:
        name: public, as in results.
        law: one line, symbols as in the paper.
        parameters: in the order of results; the first one is its strength.
        source: where the law comes from.
        write: puts a force or tilt into the kernel's vector.
        alter: changes a quantity of the rig.
        turn: changes the beam's motion.
        sense: changes what is recorded of the position.
        dry: whether it is a set-valued friction, which needs the ball's stop within a step.
        force: a force on the ball that the kernel has no slot for.

    Raises:
        EffectError: a name that is none, no parameter or one twice, no law, or an effect that does nothing.
    """

    name: str
    law: str
    parameters: tuple[Parameter, ...]
    source: str
    write: Write | None = None
    alter: Alter | None = None
    turn: Turn | None = None
    sense: Sense | None = None
    dry: bool = False
    force: Force | None = None

    def __post_init__(self) -> None:
        if not self.name.isidentifier():
            raise EffectError(f"{self.name!r} is no name for an effect; use letters, digits and _")
        names = [parameter.name for parameter in self.parameters]
        if not names or len(set(names)) < len(names):
            raise EffectError(f"{self.name}: give it parameters, each name once")
        if not (self.law and self.source):
            raise EffectError(f"{self.name}: say its law in a line, and where that comes from")
        if not any((self.write, self.alter, self.turn, self.sense, self.force)):
            raise EffectError(f"{self.name}: does nothing; give it a force, or alter, turn, sense or write")


@dataclass(frozen=True)
class Acting:
    """An effect that acts, with the values of its parameters (SI)."""

    effect: Effect
    values: Values

    def text(self) -> str:
        """`rolling_resistance (coefficient = 0.002)`."""
        parts = (f"{p.name} = {self.values[p.name]:g} {p.unit}".removesuffix(" 1") for p in self.effect.parameters)
        return f"{self.effect.name} ({', '.join(parts)})"
