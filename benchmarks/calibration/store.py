"""Rows on disk, one JSON object a line: what is there is not computed again."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.calibration.rows import Row
from benchmarks.calibration.trials import Trial
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
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab+") as file:
            if file.tell():
                file.seek(-1, os.SEEK_END)
                if file.read() != b"\n":  # a run was stopped while it wrote
                    file.write(b"\n")
            file.write(json.dumps(row.as_dict()).encode() + b"\n")

    def rows(self) -> dict[str, Row]:
        """The rows that count, by what was tried; of two for one trial, the later."""
        rows = (Row.from_dict(one) for one in self._all() if one["source"] == self.source)
        return {row.trial.spec: row for row in rows}

    def sources(self) -> Counter[str]:
        """How many rows there are of each digest."""
        return Counter(one["source"] for one in self._all())

    def missing(self, trials: Iterable[Trial]) -> list[Trial]:
        """Trials without a row, or with one that failed."""
        rows = self.rows()
        return [one for one in trials if one.spec not in rows or rows[one.spec].error is not None]

    def _all(self) -> list[dict[str, Any]]:
        """As written: fields of a row may have been others when other sources made it."""
        if not self.path.exists():
            return []
        records = []
        for line in self.path.read_text(encoding="utf-8").splitlines():
            try:
                records.append(json.loads(line))
            except ValueError:  # cut short by the end of a run
                continue
        return records
