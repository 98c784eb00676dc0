"""Curves of unknown law: what remains, as a function of position, velocity, angle, rolled angle or time.

A force curve is an acceleration of the ball, m s̈ (1 + J/(m r²)) = … + m f(·); a friction curve a coefficient that adds
to the dry friction's. Both are cubic splines through twelve nodes, or twice as many, spread over what the recordings
visit. Those of the rolled angle count from a mark on the ball: how it lay at the start of each recording is a number φ₀
of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Self

import numpy as np

from analytic.law import (
    DRY_OF_POSITION,
    DRY_OF_ROLL,
    DRY_OF_TIME,
    OF_ANGLE,
    OF_POSITION,
    OF_ROLL,
    OF_VELOCITY,
    curve_at,
)
from analytic.motion import FloatArray
from analytic.slots import MOST_NODES, PHASE, SHAPE, SHAPE_COUNT, SHAPE_LOW, SHAPE_NODES, SHAPE_STEP, SLOTS
from harness.identify.problem.settings import DEFAULT
from harness.identify.record import SplineTermRecord

if TYPE_CHECKING:
    pass


class Regressor(StrEnum):
    """What a curve depends on; names as in diagnosis.json."""

    POSITION = "position"
    VELOCITY = "velocity"
    ANGLE = "angle"
    ROLL_ANGLE = "roll_angle"
    TIME = "time"


_KERNEL = {
    (Regressor.POSITION, False): OF_POSITION,
    (Regressor.VELOCITY, False): OF_VELOCITY,
    (Regressor.ANGLE, False): OF_ANGLE,
    (Regressor.ROLL_ANGLE, False): OF_ROLL,
    (Regressor.POSITION, True): DRY_OF_POSITION,
    (Regressor.ROLL_ANGLE, True): DRY_OF_ROLL,
    (Regressor.TIME, True): DRY_OF_TIME,
}
KINDS = ((Regressor.TIME, False), *_KERNEL)
"""What is tried: (dependence, whether it is a dry friction)."""


@dataclass(frozen=True)
class SplineTerm:
    """One curve.

    Attributes:
        depends: on what.
        friction: whether it is a coefficient of dry friction [1] rather than a force per mass [m/s²].
        low, step: first node and distance of nodes, in the unit of what it depends on.
        nodes: values, shape (n,), n at most MOST_NODES; of a curve of the rolled angle the first follows the last.
    """

    depends: Regressor
    friction: bool
    low: float
    step: float
    nodes: FloatArray

    @property
    def places(self) -> FloatArray:
        """Where the nodes lie, shape (n,)."""
        return self.low + self.step * np.arange(len(self.nodes), dtype=np.float64)

    @property
    def turning(self) -> bool:
        """Whether it matters how the ball lies at the start."""
        return self.depends is Regressor.ROLL_ANGLE

    @property
    def name(self) -> str:
        """As in the ledger."""
        return f"spline of {self.depends}{' in friction' if self.friction else ''}"

    @property
    def unit(self) -> str:
        """Of the nodes."""
        return "1" if self.friction else "m/s²"

    def at(self, where: FloatArray) -> FloatArray:
        """The curve at `where`, shape (n,); the same shape."""
        p = np.zeros(SLOTS)
        self._lay(p, _KERNEL.get((self.depends, self.friction), DRY_OF_TIME))
        return np.asarray(curve_at(where, p))

    def write(self, p: FloatArray, phase: float = 0.0) -> None:
        """Into the kernel's vector, in place, unless it is a force of time (then `load`).

        Args:
            phase: φ₀, how the ball lies at the start [rad].
        """
        kind = _KERNEL.get((self.depends, self.friction))
        if kind is not None:
            self._lay(p, kind)
        if self.turning:
            p[PHASE] = phase

    def _lay(self, p: FloatArray, kind: float) -> None:
        p[SHAPE], p[SHAPE_LOW], p[SHAPE_STEP], p[SHAPE_COUNT] = kind, self.low, self.step, len(self.nodes)
        p[SHAPE_NODES : SHAPE_NODES + len(self.nodes)] = self.nodes

    def load(self, table: FloatArray, times: FloatArray, gravity: float) -> FloatArray:
        """The beam's table with a curve of time in it: a force as the tilt that gives it, a friction as a column."""
        if self.depends is not Regressor.TIME:
            return table
        if self.friction:
            return np.column_stack((table, self.at(times)))
        table = table.copy()
        table[:, 0] += self.at(times) / gravity
        return table

    def finer(self) -> Self:
        """The same curve through nodes half as far apart."""
        count = 2 * len(self.nodes) - (0 if self.turning else 1)
        twice = self.low + 0.5 * self.step * np.arange(count, dtype=np.float64)
        return replace(self, step=0.5 * self.step, nodes=self.at(twice))

    def record(self) -> SplineTermRecord:
        """What it is but for the values of its nodes."""
        return SplineTermRecord(
            depends=self.depends.value, friction=self.friction, low=self.low, step=self.step, nodes=len(self.nodes)
        )

    @classmethod
    def of(cls, record: SplineTermRecord) -> Self:
        """The curve of a `record`, nothing yet.

        Raises:
            ValueError: it has more nodes than a curve can have, or fewer.
        """
        if not 2 <= record.nodes <= MOST_NODES:
            raise ValueError(f"a curve of {record.nodes} nodes")
        return cls(Regressor(record.depends), record.friction, record.low, record.step, np.zeros(record.nodes))


def blank(depends: Regressor, friction: bool, low: float, high: float, count: int = DEFAULT.spline_nodes) -> SplineTerm:
    """A curve that is nothing yet, over what is visited from `low` to `high`."""
    steps = count if depends is Regressor.ROLL_ANGLE else count - 1
    return SplineTerm(depends, friction, low, max(high - low, 1e-9) / steps, np.zeros(count))
