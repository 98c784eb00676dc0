"""Curves of unknown law: what remains, as a function of position, velocity, angle, rolled angle or time.

A force curve is an acceleration of the ball, m s̈ (1 + J/(m r²)) = … + m f(·); a friction curve a coefficient that adds
to the dry friction's. Both run linearly between twelve nodes spread over what the recordings visit.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from analytic.law import DRY_OF_POSITION, DRY_OF_TIME, OF_ANGLE, OF_POSITION, OF_ROLL, OF_VELOCITY
from analytic.models import NODES, SHAPE, SHAPE_LOW, SHAPE_NODES, SHAPE_STEP
from analytic.motion import FloatArray

if TYPE_CHECKING:
    from harness.identify.problem import Problem

_OPEN = 1e-3  # process noise with which a filter follows the readings whatever the model lacks [m²/s³]


class Depends(StrEnum):
    """What a curve depends on; names as in diagnosis.json."""

    POSITION = "position"
    VELOCITY = "velocity"
    ANGLE = "angle"
    ROLL_ANGLE = "roll_angle"
    TIME = "time"


_KERNEL = {
    (Depends.POSITION, False): OF_POSITION,
    (Depends.VELOCITY, False): OF_VELOCITY,
    (Depends.ANGLE, False): OF_ANGLE,
    (Depends.ROLL_ANGLE, False): OF_ROLL,
    (Depends.POSITION, True): DRY_OF_POSITION,
    (Depends.TIME, True): DRY_OF_TIME,
}
KINDS = ((Depends.TIME, False), *_KERNEL)
"""What is tried: (dependence, whether it is a dry friction)."""


@dataclass(frozen=True)
class Shape:
    """One curve.

    Attributes:
        depends: on what.
        friction: whether it is a coefficient of dry friction [1] rather than a force per mass [m/s²].
        low, step: first node and distance of nodes, in the unit of what it depends on.
        nodes: values, shape (NODES,).
    """

    depends: Depends
    friction: bool
    low: float
    step: float
    nodes: FloatArray

    @property
    def places(self) -> FloatArray:
        """Where the nodes lie, shape (NODES,)."""
        return self.low + self.step * np.arange(NODES, dtype=np.float64)

    @property
    def name(self) -> str:
        """As in the ledger."""
        return f"curve of {self.depends}{' in friction' if self.friction else ''}"

    @property
    def unit(self) -> str:
        """Of the nodes."""
        return "1" if self.friction else "m/s²"

    def at(self, where: FloatArray) -> FloatArray:
        """The curve, linear between nodes, constant beyond them; same shape."""
        return np.interp(where, self.places, self.nodes)

    def write(self, p: FloatArray) -> None:
        """Into the kernel's vector, in place, unless it depends on time alone (then `load`)."""
        kind = _KERNEL.get((self.depends, self.friction))
        if kind is not None:
            p[SHAPE], p[SHAPE_LOW], p[SHAPE_STEP] = kind, self.low, self.step
            p[SHAPE_NODES : SHAPE_NODES + NODES] = self.nodes

    def load(self, table: FloatArray, times: FloatArray, gravity: float) -> FloatArray:
        """The beam's table with a curve of time in it: a force as the tilt that gives it, a friction as a column."""
        if self.depends is not Depends.TIME:
            return table
        if self.friction:
            return np.column_stack((table, self.at(times)))
        table = table.copy()
        table[:, 0] += self.at(times) / gravity
        return table


def blank(depends: Depends, friction: bool, low: float, high: float) -> Shape:
    """A curve that is nothing yet, over what is visited from `low` to `high`."""
    return Shape(depends, friction, low, max(high - low, 1e-9) / (NODES - 1), np.zeros(NODES))


def visited(problem: Problem, depends: Depends) -> tuple[float, float]:
    """Between what the recordings keep what a curve depends on; the outermost half percents are left out."""
    match depends:
        case Depends.TIME:
            return min(r.time[0] for r in problem.records), max(r.time[-1] for r in problem.records)
        case Depends.ROLL_ANGLE:
            return 0.0, 2.0 * np.pi
        case Depends.ANGLE:
            values = [record.table[:, 0] for record in problem.records]
        case Depends.POSITION:
            values = [record.reading[np.isfinite(record.reading)] for record in problem.records]
        case Depends.VELOCITY:
            filtered = [problem.filtered(record, (), 0.0, _OPEN) for record in problem.records]
            values = [
                one.state[np.isfinite(record.reading), 1] for one, record in zip(filtered, problem.records, strict=True)
            ]
    low, high = np.percentile(np.concatenate(values), [0.5, 99.5])
    return float(low), float(high)
