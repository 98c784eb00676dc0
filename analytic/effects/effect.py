"""What an effect is: a law with named parameters that it writes into the kernel's parameter vector."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from analytic.motion import BeamMotion, FloatArray
from analytic.rig import Rig

Values = Mapping[str, float]
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
    """One parameter of an effect: its name, SI unit, bounds and a size that is typical where the effect matters."""

    name: str
    unit: str
    low: float
    high: float
    typical: float


@dataclass(frozen=True)
class Effect:
    """One entry of the catalogue. It acts in one place: on the ball, on the rig's quantities, on the angle, or on the
    sensor.

    Attributes:
        name: public, as in results.
        law: one line, symbols as in the paper.
        parameters: in the order of results.
        source: where the law comes from.
        write: puts a force or tilt into the kernel's vector.
        alter: changes a quantity of the rig.
        turn: changes the beam's motion.
        sense: changes what is recorded of the position.
        dry: whether it is a set-valued friction, which needs the ball's stop within a step.
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


@dataclass(frozen=True)
class Acting:
    """An effect that acts, with the values of its parameters (SI)."""

    effect: Effect
    values: Values

    def text(self) -> str:
        """`rolling_resistance (coefficient = 0.002)`."""
        parts = (f"{p.name} = {self.values[p.name]:g} {p.unit}".removesuffix(" 1") for p in self.effect.parameters)
        return f"{self.effect.name} ({', '.join(parts)})"
