"""What an effect is: a law with named parameters that it writes into the kernel's parameter vector."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from analytic.motion import FloatArray
from analytic.rig import Rig

Write = Callable[[FloatArray, Rig, Mapping[str, float]], None]
"""Adds an effect to a kernel vector, shape (SLOTS,), in place; effects of one kind add up."""


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
    """One entry of the catalogue.

    Attributes:
        name: public, as in results.
        law: one line, symbols as in the paper.
        parameters: in the order of results.
        source: where the law comes from.
        write: puts it into the kernel's vector.
        dry: whether it is a set-valued friction, which needs the ball's stop within a step.
    """

    name: str
    law: str
    parameters: tuple[Parameter, ...]
    source: str
    write: Write
    dry: bool = False


@dataclass(frozen=True)
class Acting:
    """An effect that acts, with the values of its parameters (SI)."""

    effect: Effect
    values: Mapping[str, float]

    def text(self) -> str:
        """`rolling_resistance (coefficient = 0.002)`."""
        parts = (f"{p.name} = {self.values[p.name]:g} {p.unit}".removesuffix(" 1") for p in self.effect.parameters)
        return f"{self.effect.name} ({', '.join(parts)})"
