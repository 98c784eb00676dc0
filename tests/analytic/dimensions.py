"""A small algebra of physical dimensions: exponents of kilogram, metre and second."""

from __future__ import annotations

from typing import NamedTuple


class Dimension(NamedTuple):
    """kg^mass · m^length · s^time; angles are numbers."""

    mass: int = 0
    length: int = 0
    time: int = 0

    def __mul__(self, other: Dimension) -> Dimension:  # type: ignore[override]
        return Dimension(*(a + b for a, b in zip(self, other, strict=True)))

    def __truediv__(self, other: Dimension) -> Dimension:
        return Dimension(*(a - b for a, b in zip(self, other, strict=True)))

    def scale(self, kilogram: float, metre: float, second: float) -> float:
        """Factor by which a quantity's number grows when these are the sizes of the old units in new ones."""
        return kilogram**self.mass * metre**self.length * second**self.time


NUMBER, MASS, LENGTH, TIME = Dimension(), Dimension(mass=1), Dimension(length=1), Dimension(time=1)
VELOCITY = LENGTH / TIME
ACCELERATION = VELOCITY / TIME
FORCE = MASS * ACCELERATION

_UNITS = {"1": NUMBER, "kg": MASS, "m": LENGTH, "s": TIME, "N": FORCE}


def dimension_of(unit: str) -> Dimension:
    """The dimension of a unit written like `N s/m`."""
    above, _, below = unit.partition("/")
    result = NUMBER
    for name in above.split():
        result = result * _UNITS[name]
    for name in below.split():
        result = result / _UNITS[name]
    return result
