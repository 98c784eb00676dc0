"""Spline terms: unknown laws as cubic splines of position, velocity, angle, rolled angle or time.

A force per mass f(·) [m/s²] enters as m s̈ (1 + J/(m r²)) = … + m f(·), a friction coefficient is added to that of dry
friction. An error of the position sensor [m] is added to what it records of a ball at a position. The nodes are
equidistant over the range of the recordings. The rolled angle counts from a mark on the ball, so its phase φ₀ at the
start of each recording is a parameter. A force of position may repeat itself along the beam, with a period that is a
parameter too: few harmonics then tell what else takes dozens of nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np

from analytic.law import (
    DRY_OF_POSITION,
    DRY_OF_ROLL,
    DRY_OF_TIME,
    OF_ANGLE,
    OF_POSITION,
    OF_ROLL,
    OF_SENSOR,
    OF_VELOCITY,
    PERIODIC,
    spline_slope_at,
    spline_term,
    spline_term_at,
)
from analytic.motion import FloatArray
from analytic.slots import MOST_NODES, PHASE, SHAPE, SHAPE_COUNT, SHAPE_LOW, SHAPE_NODES, SHAPE_STEP, SLOTS
from harness.identify.problem.settings import DEFAULT
from harness.identify.record import SplineTermRecord


class Regressor(StrEnum):
    """The argument of a spline term; names as in diagnosis.json."""

    POSITION = "position"
    VELOCITY = "velocity"
    ANGLE = "angle"
    ROLL_ANGLE = "roll_angle"
    TIME = "time"


class Kind(NamedTuple):
    """What a spline term depends on, whether it is a friction coefficient, whether it repeats itself along the beam,
    and whether it is an error of the position sensor."""

    depends: Regressor
    friction: bool = False
    periodic: bool = False
    sensor: bool = False


_PER_WAVE = 3  # nodes that the shortest wave of a periodic one needs
_KERNEL = {
    Kind(Regressor.POSITION): OF_POSITION,
    Kind(Regressor.VELOCITY): OF_VELOCITY,
    Kind(Regressor.ANGLE): OF_ANGLE,
    Kind(Regressor.ROLL_ANGLE): OF_ROLL,
    Kind(Regressor.POSITION, periodic=True): PERIODIC,
    Kind(Regressor.POSITION, friction=True): DRY_OF_POSITION,
    Kind(Regressor.ROLL_ANGLE, friction=True): DRY_OF_ROLL,
    Kind(Regressor.TIME, friction=True): DRY_OF_TIME,
    Kind(Regressor.POSITION, sensor=True): OF_SENSOR,
}
KINDS = (Kind(Regressor.TIME), *_KERNEL)
"""Kinds of spline terms that are tried."""


@dataclass(frozen=True, eq=False)
class SplineTerm:
    """A spline term.

    Attributes:
        depends: its regressor.
        friction, sensor: whether it is a coefficient of dry friction [1], or an error of the position sensor [m];
            else it is a force per mass [m/s²].
        low, step: first node and distance of nodes, in the unit of the regressor.
        nodes: values, shape (n,), n at most MOST_NODES; those of a closed one are of one turn or period.
        harmonics: of which the nodes of a periodic force of position are sums; 0 for any other.
    """

    depends: Regressor
    friction: bool
    low: float
    step: float
    nodes: FloatArray
    harmonics: int = 0
    sensor: bool = False

    def __eq__(self, other: object) -> bool:
        """Whether kind, places and values are the same."""
        if not isinstance(other, SplineTerm):
            return NotImplemented
        return self._but_nodes == other._but_nodes and np.array_equal(self.nodes, other.nodes)

    def __hash__(self) -> int:
        """Of all but the values."""
        return hash(self._but_nodes)

    @property
    def _but_nodes(self) -> tuple[Any, ...]:
        return self.depends, self.friction, self.low, self.step, self.harmonics, self.sensor

    @property
    def periodic(self) -> bool:
        """Whether a force of position repeats itself along the beam, after n steps."""
        return self.harmonics > 0

    @property
    def kind(self) -> Kind:
        """What it depends on and how."""
        return Kind(self.depends, self.friction, self.periodic, self.sensor)

    @property
    def closed(self) -> bool:
        """Whether the last node is followed by the first: over the rolled angle, or periodic."""
        return self.turning or self.periodic

    @property
    def period(self) -> float:
        """Length after which a closed one repeats itself, in the unit of the regressor."""
        return self.step * len(self.nodes)

    @cached_property
    def basis(self) -> FloatArray:
        """Nodes by what is fitted of them, shape (n, c): themselves, or mean, cosines and sines of each harmonic."""
        count = len(self.nodes)
        if not self.periodic:
            return np.eye(count)
        turns = np.outer(np.arange(count), np.arange(1, self.harmonics + 1)) * (2.0 * np.pi / count)
        return np.hstack((np.ones((count, 1)), np.cos(turns), np.sin(turns)))

    @property
    def numbers(self) -> FloatArray:
        """What is fitted, shape (c,): the nodes; of a periodic one period [m], mean, cosines, sines, shape (c + 1,)."""
        if not self.periodic:
            return self.nodes
        return np.concatenate(([self.period], np.linalg.lstsq(self.basis, self.nodes, rcond=None)[0]))

    def with_numbers(self, numbers: FloatArray) -> Self:
        """The same kind of spline with these `numbers`."""
        if not self.periodic:
            return replace(self, nodes=numbers)
        return replace(self, step=float(numbers[0]) / len(self.nodes), nodes=self.basis @ numbers[1:])

    def deviations(self, covariance: FloatArray) -> FloatArray:
        """Standard errors of the nodes, shape (n,), from the covariance of a fit's parameters, its own last, (k, k)."""
        own = covariance[-self.basis.shape[1] :, -self.basis.shape[1] :]
        return np.sqrt(np.einsum("ij,jk,ik->i", self.basis, own, self.basis).clip(min=0.0))

    @property
    def places(self) -> FloatArray:
        """Abscissae of the nodes, shape (n,), in the unit of the regressor."""
        return self.low + self.step * np.arange(len(self.nodes), dtype=np.float64)

    @property
    def turning(self) -> bool:
        """Whether it depends on the rolled angle, and so on φ₀."""
        return self.depends is Regressor.ROLL_ANGLE

    @property
    def name(self) -> str:
        """Name in the ledger."""
        where = " in friction" * self.friction + " in the position sensor" * self.sensor
        return f"{'periodic ' * self.periodic}spline of {self.depends}{where}"

    @property
    def unit(self) -> str:
        """Unit of the node values."""
        return "1" if self.friction else "m" if self.sensor else "m/s²"

    def at(self, where: FloatArray) -> FloatArray:
        """Values of the spline at `where`, shape (n,); the same shape."""
        return np.asarray(spline_term_at(where, self._alone))

    def slope_at(self, where: FloatArray) -> FloatArray:
        """Derivative of the spline at `where`, shape (n,), its unit per unit of the regressor; the same shape."""
        return np.asarray(spline_slope_at(where, self._alone))

    def at_one(self, where: float) -> float:
        """Its value at one place: quick enough for every step of an engine."""
        return float(spline_term(where, self._alone))

    @cached_property
    def _alone(self) -> FloatArray:
        """A kernel's vector with nothing but the spline, shape (SLOTS,)."""
        p = np.zeros(SLOTS)
        self._write(p, _KERNEL.get(self.kind, DRY_OF_TIME))
        return p

    def write(self, p: FloatArray, phase: float = 0.0) -> None:
        """Write the term into the kernel's vector, shape (SLOTS,) or longer, in place; `load` writes a force of time.

        Args:
            phase: φ₀ [rad].
        """
        kind = _KERNEL.get(self.kind)
        if kind is not None:
            self._write(p, kind)
        if self.turning:
            p[PHASE] = phase

    def _write(self, p: FloatArray, kind: float) -> None:
        p[SHAPE], p[SHAPE_LOW], p[SHAPE_STEP], p[SHAPE_COUNT] = kind, self.low, self.step, len(self.nodes)
        p[SHAPE_NODES : SHAPE_NODES + len(self.nodes)] = self.nodes

    def load(self, table: FloatArray, times: FloatArray, gravity: float) -> FloatArray:
        """The beam's table with a term of time in it: a force as equivalent tilt, a friction as a further column.

        Args:
            table: of m steps, shape (2 m + 1, 3) [rad, s].
            times: of its rows, shape (2 m + 1,) [s].
            gravity: g [m/s²].
        """
        if self.depends is not Regressor.TIME:
            return table
        if self.friction:
            return np.column_stack((table, self.at(times)))
        table = table.copy()
        table[:, 0] += self.at(times) / gravity
        return table

    @property
    def _finer_count(self) -> int:
        return 2 * len(self.nodes) - (0 if self.closed else 1)

    @property
    def refinable(self) -> bool:
        """Whether the kernel's vector has room for the nodes of `finer`, or those of a period for its harmonics."""
        if self.periodic:
            return 2 * self.harmonics <= len(self.nodes) // _PER_WAVE
        return self._finer_count <= MOST_NODES

    def finer(self) -> Self:
        """The same spline with nodes at half the distance: 2 n − 1 of them, 2 n if it is closed; a periodic one with
        twice the harmonics."""
        if self.periodic:
            return replace(self, harmonics=2 * self.harmonics)
        count = self._finer_count
        twice = self.low + 0.5 * self.step * np.arange(count, dtype=np.float64)
        return replace(self, step=0.5 * self.step, nodes=self.at(twice))

    def record(self) -> SplineTermRecord:
        """As JSON, without the values of the nodes."""
        return SplineTermRecord(
            depends=self.depends.value,
            friction=self.friction,
            low=self.low,
            step=self.step,
            nodes=len(self.nodes),
            harmonics=self.harmonics,
            sensor=self.sensor,
        )

    @classmethod
    def of(cls, record: SplineTermRecord) -> Self:
        """The zero spline term that a `record` describes.

        Raises:
            ValueError: its number of nodes is not between 2 and MOST_NODES.
        """
        if not 2 <= record.nodes <= MOST_NODES:
            raise ValueError(f"a spline term of {record.nodes} nodes")
        nodes = np.zeros(record.nodes)
        kind = Regressor(record.depends), record.friction
        return cls(*kind, record.low, record.step, nodes, record.harmonics, record.sensor)


def blank(kind: Kind, low: float, high: float, count: int = DEFAULT.spline_nodes) -> SplineTerm:
    """The zero spline term with `count` nodes over the range from `low` to `high`; a periodic one with one harmonic, of
    which that is the period, and twice the nodes, through which it then is a sine but for 3 parts in 10 000."""
    count = 2 * count if kind.periodic else count
    closed = kind.periodic or kind.depends is Regressor.ROLL_ANGLE
    step = max(high - low, 1e-9) / (count if closed else count - 1)
    return SplineTerm(kind.depends, kind.friction, low, step, np.zeros(count), int(kind.periodic), kind.sensor)
