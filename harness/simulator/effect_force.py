"""The force of an effect on the plant's ball: its law compiled as it stands, not sampled, in no equation of motion."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable

from numba.core.errors import NumbaError

from analytic.compiled import njit
from analytic.effects import Acting, Force
from analytic.effects.force import QUANTITIES
from harness.errors import InputError
from harness.simulator.contact import AppliedForce

_TURN = 2.0 * math.pi


def force_with(force: AppliedForce | None, effects: Iterable[Acting], turned_before: float) -> AppliedForce | None:
    """`force` and those of `effects` together, as a function that numba can compile.

    Args:
        turned_before: how the ball lies at the start, for the effects to which that matters [rad].

    Raises:
        InputError: a law that numba cannot compile.
    """
    for one in effects:
        if one.effect.force is not None:
            turned = turned_before if one.effect.turning else 0.0
            try:
                own = _applied(one.effect.force, tuple(one.values.items()), turned)
            except (NumbaError, TypeError) as error:
                raise InputError(
                    f"{one.effect.name}: the virtual rig cannot compile its law ({str(error).splitlines()[0]}); "
                    "write it so that it works for one number too, with NumPy's functions or math's."
                ) from error
            force = own if force is None else _sum(force, own)
    return force


@functools.cache
def _applied(force: Force, values: tuple[tuple[str, float], ...], turned: float) -> AppliedForce:
    """The law with these values as a force on the plant's ball; beyond its range it keeps its last value."""
    plain = inspect.unwrap(force.law)
    names = list(inspect.signature(plain).parameters)[1:]
    given = tuple(dict(values)[name] for name in names)
    compiled: Callable[..., float] = njit(cache=False)(plain)
    low, high = force.over or QUANTITIES[force.by][1]
    float(compiled(low, *given))  # says what is wrong with it here

    def by_position(s: float, v: float, angle: float, rolled: float, time: float) -> float:
        return float(compiled(min(max(s, low), high), *given))

    def by_velocity(s: float, v: float, angle: float, rolled: float, time: float) -> float:
        return float(compiled(min(max(v, low), high), *given))

    def by_angle(s: float, v: float, angle: float, rolled: float, time: float) -> float:
        return float(compiled(min(max(angle, low), high), *given))

    def by_roll_angle(s: float, v: float, angle: float, rolled: float, time: float) -> float:
        return float(compiled((rolled + turned) % _TURN, *given))

    return {"position": by_position, "velocity": by_velocity, "angle": by_angle, "roll_angle": by_roll_angle}[force.by]


@functools.cache
def _sum(first: AppliedForce, second: AppliedForce) -> AppliedForce:
    one, other = (njit(cache=False)(force) for force in (first, second))

    def both(s: float, v: float, angle: float, rolled: float, time: float) -> float:
        return one(s, v, angle, rolled, time) + other(s, v, angle, rolled, time)

    return both
