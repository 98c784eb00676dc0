"""Targets that the blind trials have to meet."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import pandas as pd

from benchmarks.calibration.statistics import ALL


@dataclass(frozen=True)
class Target:
    """A rate that has to be within a range, from a sufficient number of cases.

    Attributes:
        what: description.
        allowed: lowest and highest rate [1].
        least: required number of cases.
        cases: number of cases.
        measured: rate and its 95 % interval [1].
    """

    what: str
    allowed: tuple[float, float]
    least: int
    cases: int
    measured: tuple[float, float, float]

    @property
    def met(self) -> bool:
        """Whether rate and number of cases are as required."""
        low, high = self.allowed
        return self.cases >= self.least and low <= self.measured[0] <= high


def targets(tables: Mapping[str, pd.DataFrame]) -> tuple[Target, ...]:
    """All targets; one without its table has no cases."""
    recovery = tables.get("recovery", pd.DataFrame())
    middle = recovery[recovery["size"] == "middle"] if len(recovery) else recovery
    return (
        Target("false positives without a hidden effect", (0.0, 0.05), 200, *_total(tables.get("null"), "cases")),
        Target("middle effects found, or an indistinguishable partner", (0.9, 1.0), 75, *_total(middle, "cases")),
        Target(
            "95 % intervals that contain the true value", (0.9, 0.98), 200, *_total(tables.get("coverage"), "intervals")
        ),
    )


def _total(table: pd.DataFrame | None, count: str) -> tuple[int, tuple[float, float, float]]:
    """Number of cases and rate in the row of totals."""
    for row in _rows(table):
        if row[next(iter(row))] == ALL:
            rate, low, high = (float(row[key]) for key in ("rate", "low", "high"))
            return int(row[count]), (rate, low, high)
    return 0, (math.nan, math.nan, math.nan)


def _rows(table: pd.DataFrame | None) -> Iterator[dict[str, float | str]]:
    if table is not None:
        yield from ({str(key): value for key, value in line.items()} for line in table.to_dict("records"))
