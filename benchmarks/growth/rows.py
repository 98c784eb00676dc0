"""Measured times on disk, one JSON object a line: a measurement that was stopped goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.growth.measure import Time


@dataclass(frozen=True)
class Row:
    """One measurement.

    Attributes:
        what: was measured: "recordings", "length", "diagnose" or "sysid".
        size: number of recordings, or length [s]; 0 where there is only one size.
        number: of the repetition.
        cpu, wall: times [s].
        source: digest of the sources that were measured.
    """

    what: str
    size: float
    number: int
    cpu: float
    wall: float
    source: str


class Rows:
    """Rows of one digest of the sources in a file, which need not exist."""

    def __init__(self, path: Path, source: str) -> None:
        """Read what is there."""
        self._path, self._source = path, source
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        self.all = [row for row in (Row(**json.loads(line)) for line in lines) if row.source == source]

    def measured(self, what: str, size: float, number: int, measure: Callable[[], Time]) -> Row:
        """The row of this measurement, measured now if it is not there."""
        for row in self.all:
            if (row.what, row.size, row.number) == (what, size, number):
                return row
        taken = measure()
        row = Row(what, size, number, taken.cpu, taken.wall, self._source)
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(row)) + "\n")
        self.all.append(row)
        return row
