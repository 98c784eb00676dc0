"""Rows of blind trials on disk."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from benchmarks.calibration.rows import Row
from benchmarks.calibration.trials import Trial
from benchmarks.kept_rows import KeptRows
from harness.provenance import PACKAGES, code_digest


def sources_digest() -> str:
    """Digest of the product and of what measures it: a row follows from both."""
    return code_digest(packages=(*PACKAGES, "benchmarks"))


@dataclass(frozen=True)
class Store:
    """Rows of any sources; those of one digest count.

    Attributes:
        path: of the file; it need not exist.
        source: digest of the sources whose rows count.
    """

    path: Path
    source: str

    def append(self, row: Row) -> None:
        """Write a row at the end."""
        self._kept.append(row.as_dict())

    def rows(self) -> dict[str, Row]:
        """The rows that count, by what was tried; of two for one trial, the later."""
        return {row.trial.spec: row for row in map(Row.from_dict, self._kept.current())}

    def sources(self) -> Counter[str]:
        """How many rows there are of each digest."""
        return self._kept.sources()

    def missing(self, trials: Iterable[Trial]) -> list[Trial]:
        """Trials without a row, or with one that failed."""
        rows = self.rows()
        return [one for one in trials if one.spec not in rows or rows[one.spec].error is not None]

    @property
    def _kept(self) -> KeptRows:
        return KeptRows(self.path, self.source)
