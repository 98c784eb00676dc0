"""Rows on disk, one JSON object a line: what is there is not computed again."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.calibration.trials import Trial


@dataclass(frozen=True)
class KeptRows:
    """A file of rows. Each has the digest of the sources that made it (`source`); those of one digest count.

    Attributes:
        path: of the file; it need not exist.
        source: digest of the sources whose rows count.
    """

    path: Path
    source: str

    def append(self, row: Mapping[str, Any]) -> None:
        """Write a row at the end."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab+") as file:
            if file.tell():
                file.seek(-1, os.SEEK_END)
                if file.read() != b"\n":  # a run was stopped while it wrote
                    file.write(b"\n")
            file.write(json.dumps(row).encode() + b"\n")

    def current(self) -> list[dict[str, Any]]:
        """The rows that count, as written."""
        return [row for row in self._all() if row["source"] == self.source]

    def sources(self) -> Counter[str]:
        """How many rows there are of each digest."""
        return Counter(row["source"] for row in self._all())

    def of_trials(
        self, trials: Iterable[Trial], result: Callable[[Trial], Any], told: Callable[[Trial, Any], None]
    ) -> list[Any]:
        """Results of these trials, in their order; those that are missing in the file are computed and added to it.

        Args:
            trials: told apart by `Trial.spec`.
            result: of a trial, anything that JSON can hold.
            told: called with each trial that was computed, and its result.
        """
        kept = {row["spec"]: row["result"] for row in self.current()}
        wanted = list(trials)
        for trial in wanted:
            if trial.spec not in kept:
                kept[trial.spec] = result(trial)
                self.append({"source": self.source, "spec": trial.spec, "result": kept[trial.spec]})
                told(trial, kept[trial.spec])
        return [kept[trial.spec] for trial in wanted]

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
