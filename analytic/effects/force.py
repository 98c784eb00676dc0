"""A force on the ball as a function of one quantity: any law in Python, sampled for the compiled kernel."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic import slots
from analytic.law import OF_ANGLE, OF_POSITION, OF_ROLL, OF_VELOCITY
from analytic.motion import FloatArray
from analytic.rig import Rig

Values = Mapping[str, float]

_TURN = 2.0 * math.pi
_PERIODIC = 1e-6  # of the largest force, by which a law of the rolled angle may differ after a turn
QUANTITIES = {
    "position": (OF_POSITION, (-1.0, 1.0)),
    "velocity": (OF_VELOCITY, (-2.0, 2.0)),
    "angle": (OF_ANGLE, (-1.0, 1.0)),
    "roll_angle": (OF_ROLL, (0.0, _TURN)),
}
"""What a force can depend on: the kernel's name of it, and over which values it is sampled [m, m/s, rad, rad]."""


class EffectError(ValueError):
    """An effect that does not exist or cannot be, or values that it cannot take; the text says what can be."""


@dataclass(frozen=True)
class Force:
    """A force along the beam on the ball's centre.

    The kernel runs cubically through 513 nodes, which leaves h⁴/384 of the law's fourth derivative between nodes that
    are h apart; beyond the first and the last the force is constant.

    Attributes:
        by: the quantity that it depends on: "position", s [m]; "velocity", ṡ [m/s]; "angle", of the beam, α [rad];
            "roll_angle", by which the ball has rolled since a recording's first position, 0 … 2π [rad].
        law: gives the force [N], positive towards +s, at an array of values of the quantity, same shape; the effect's
            parameters follow by name.
        over: first and last node, in the quantity's unit; as in `QUANTITIES` if it is not given.

    Raises:
        EffectError: there is no such quantity, or no such range.
    """

    by: str
    law: Callable[..., Any]
    over: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.by not in QUANTITIES:
            raise EffectError(f"a force cannot depend on {self.by!r}; it can on {', '.join(QUANTITIES)}")
        if self.over is None:
            return
        if self.by == "roll_angle":
            raise EffectError("a force by roll_angle is sampled over one turn; leave out `over`")
        if not (all(map(math.isfinite, self.over)) and self.over[0] < self.over[1]):
            raise EffectError(f"a force over {self.over}; give two finite numbers, the lower one first")

    def sampled(self, rig: Rig, values: Values) -> FloatArray:
        """The kernel's block of this force with these values of its parameters, shape (LAW_SLOTS,) [F/m in m/s²].

        Raises:
            EffectError: the law gives no finite force everywhere, or after a turn another one than before.
        """
        kind, usual = QUANTITIES[self.by]
        low, high = self.over or usual
        step = (high - low) / (slots.LAW_NODES - 1)
        at = low + step * np.arange(-slots.LAW_MARGIN, slots.LAW_NODES + slots.LAW_MARGIN)
        with np.errstate(all="ignore"):  # what is not finite is refused below
            force = np.asarray(self.law(at, **values))
        if force.dtype.kind not in "fiu":
            raise EffectError(f"the law gives values of the type {force.dtype}, not real numbers")
        if force.shape not in ((), at.shape):
            raise EffectError(f"the law gives {force.shape} forces for {at.shape} values of {self.by}")
        force = np.broadcast_to(force, at.shape)
        wrong = ~np.isfinite(force)
        if wrong.any():
            given = ", ".join(f"{name} = {value:g}" for name, value in values.items())
            raise EffectError(f"the law gives {force[wrong][0]} N at {self.by} {at[wrong][0]:.4g} with {given}")
        first, last = force[slots.LAW_MARGIN], force[-1 - slots.LAW_MARGIN]
        if self.by == "roll_angle" and abs(last - first) > _PERIODIC * np.abs(force).max():
            raise EffectError(
                f"the law gives {first:g} N at 0 and {last:g} N after a turn of the ball; make it periodic"
            )
        return np.concatenate(((kind, low, step), force / rig.mass))
