"""A case that shows itself: its recordings, what is known of the rig, findings."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np

from harness.formatting import number
from harness.recording import Case as CheckedCase
from harness.recording import case as cases
from harness.recording.known_rig import UNITS
from harness.report.tables import Column, Row, Summarised, Summary, Table


class Case(Summarised, CheckedCase):
    """A rig's recordings and what is known of it; attributes as of `harness.recording.Case`."""

    def summary(self) -> Summary:
        """Recordings, what is known, findings."""
        lines = [f"origin: {self.origin}"] if self.origin else []
        if self.declared:
            lines.append(f"declared effects: {', '.join(one.name for one in self.declared)}")
        tables = [self._recordings(), self._known()]
        if self.findings:
            columns = [Column(head, text=True) for head in ("severity", "where", "finding")]
            rows = [Row((one.severity, one.where, one.text)) for one in self.findings]
            tables.append(Table("Findings", columns, rows))
        return Summary(f"Case {self.path}", lines, tables)

    def _recordings(self) -> Table:
        columns = [
            Column("recording", text=True),
            Column("length", "s"),
            Column("samples"),
            Column("rate", "Hz"),
            Column("positions"),
            Column("used to", text=True),
        ]
        rows = []
        for name, one in self.recordings.items():
            use = " and ".join(use for use in ("identify", "predict") if name in getattr(self, use))
            length, rate = one.time[-1] - one.time[0], 1.0 / float(np.median(np.diff(one.time)))
            cells = (number(float(length)), str(len(one.time)), number(rate), str(int(one.known.sum())), use)
            rows.append(Row((name, *cells)))
        return Table("Recordings", columns, rows)

    def _known(self) -> Table:
        columns = [Column("quantity", text=True), Column("value"), Column("unit", text=True)]
        rows = []
        for part in (self.rig, self.sensors):
            for field in fields(part):
                value = getattr(part, field.name)
                said = "not known" if value is None else number(value, 4)
                rows.append(Row((field.name.replace("_", " "), said, UNITS[field.name])))
        return Table("What is known", columns, rows)


def load_case(path: str | Path = cases.BUNDLED) -> Case:
    """Read a case: a folder, its `rig.toml`, or a single CSV recording of the paper's rig.

    Args:
        path: of the case; without one, the bundled recordings, which are simulated.

    Raises:
        InputError: anything in it cannot be used; nothing is returned in part.
    """
    return case_of(cases.load_case(path))


def case_of(given: CheckedCase | str | Path) -> Case:
    """A case that shows itself, of one that was read already or of a path."""
    if isinstance(given, Case):
        return given
    if isinstance(given, CheckedCase):
        return Case(**{field.name: getattr(given, field.name) for field in fields(given)})
    return load_case(given)
