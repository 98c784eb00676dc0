"""What the tables have to show for a diagnosis to be trusted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import pandas as pd

from benchmarks.calibration.tables import ALL


@dataclass(frozen=True)
class Target:
    """A rate that has to lie in a range, measured often enough to mean something.

    Attributes:
        what: in words.
        allowed: lowest and highest rate [1].
        least: how often it has to be measured.
        cases: how often it was.
        measured: rate, and its 95 % interval [1].
    """

    what: str
    allowed: tuple[float, float]
    least: int
    cases: int
    measured: tuple[float, float, float]

    @property
    def met(self) -> bool:
        """Whether rate and number are as they have to be."""
        low, high = self.allowed
        return self.cases >= self.least and low <= self.measured[0] <= high


def targets(tables: Mapping[str, pd.DataFrame]) -> tuple[Target, ...]:
    """All targets; one whose table is not there has been measured in no case."""
    recovery = tables.get("recovery", pd.DataFrame())
    middle = recovery[recovery["size"] == "middle"] if len(recovery) else recovery
    return (
        Target("false positives where nothing is hidden", (0.0, 0.05), 200, *_total(tables.get("null"), "cases")),
        Target("middle effects named, or declared a partner", (0.9, 1.0), 75, *_total(middle, "cases")),
        Target("95 % intervals that hold the truth", (0.9, 0.98), 200, *_total(tables.get("coverage"), "intervals")),
    )


def _total(table: pd.DataFrame | None, count: str) -> tuple[int, tuple[float, float, float]]:
    """Number and rate of the line over all."""
    for line in _lines(table):
        if line[next(iter(line))] == ALL:
            rate, low, high = (float(line[key]) for key in ("rate", "low", "high"))
            return int(line[count]), (rate, low, high)
    return 0, (math.nan, math.nan, math.nan)


def _lines(table: pd.DataFrame | None) -> Iterator[dict[str, float | str]]:
    if table is not None:
        yield from ({str(key): value for key, value in line.items()} for line in table.to_dict("records"))
