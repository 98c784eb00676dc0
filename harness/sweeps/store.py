"""Rows on disk while a sweep runs: each is kept as soon as its batch ends, and survives that the sweep is killed.

Parquet cannot be read before its footer is written. Rows therefore go into a journal, one line of JSON each, which is
flushed with every batch; a journal that is full becomes a Parquet file that is moved into place in one step, and is
then deleted. A journal beside the Parquet file of its number is one that a kill kept from being deleted, and is
ignored; a last line that a kill has cut is, too.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.dataset as ds
import pyarrow.parquet as pq
from numpy.typing import NDArray

from harness.errors import InputError
from harness.provenance import canonical, seal_of

FULL = 1024  # rows of a journal, hence of a part
_GROUP = 16_384  # rows of a row group of the result
_ABOUT = "sweep.json"

RESULTS: Mapping[str, pa.DataType] = {
    "error_cam_max_m": pa.float64(),
    "error_cam_rms_m": pa.float64(),
    "error_measured_max_m": pa.float64(),
    "error_measured_rms_m": pa.float64(),
    "cpu_s": pa.float64(),
    "steps": pa.int64(),
    "slip_max_m_s": pa.float64(),
    "failure": pa.string(),
    "message": pa.string(),
}
"""Columns of what came of a run."""


class Store:
    """Rows of a sweep that is not finished, in a folder of their own; used by one process at a time."""

    def __init__(self, folder: Path, schema: pa.Schema, runs: int) -> None:
        """Open the folder, or make it.

        Args:
            folder: of the rows.
            schema: of a row; the first column is `run`.
            runs: number of all runs.
        """
        self.folder, self.schema = folder, schema
        folder.mkdir(parents=True, exist_ok=True)
        for left in folder.glob("*.unfinished"):
            left.unlink()
        self._done = np.zeros(runs, dtype=np.bool_)
        self._number = 1 + max((int(one.stem) for one in folder.glob("*.parquet")), default=-1)
        for part in self._parts():
            self._done[pq.read_table(part, columns=["run"])["run"].to_numpy()] = True
        for journal in sorted(folder.glob("*.jsonl")):
            if int(journal.stem) < self._number:
                journal.unlink()
        self._rows = _read(self._journal) if self._journal.exists() else []
        self._rewrite()
        self._done[[row["run"] for row in self._rows]] = True
        self._lines = self._journal.open("a", encoding="utf-8")

    @property
    def missing(self) -> NDArray[np.int64]:
        """Numbers of the runs without a row, ascending."""
        return np.flatnonzero(~self._done)

    def append(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Keep the rows of a batch."""
        new = [dict(row) for row in rows if not self._done[row["run"]]]
        self._lines.write("".join(json.dumps(row) + "\n" for row in new))
        self._lines.flush()  # to the system: it outlives this process
        self._done[[row["run"] for row in new]] = True
        self._rows += new
        if len(self._rows) >= FULL:
            self._seal()

    def write(self, file: Path) -> None:
        """Write all rows, by number of their run, into one Parquet file; a row group at a time in memory."""
        if self._rows:
            self._seal()
        parts = ds.dataset([str(one) for one in self._parts()], schema=self.schema, format="parquet")
        with pq.ParquetWriter(file, self.schema, compression="zstd") as writer:
            for begin in range(0, len(self._done), _GROUP):
                inside = (pc.field("run") >= begin) & (pc.field("run") < begin + _GROUP)
                writer.write_table(parts.to_table(filter=inside, use_threads=False).sort_by("run"))

    def close(self) -> None:
        """Close the journal; nothing is lost without."""
        self._lines.close()

    def _parts(self) -> list[Path]:
        return sorted(self.folder.glob("*.parquet"))

    @property
    def _journal(self) -> Path:
        return self.folder / f"{self._number:08d}.jsonl"

    def _rewrite(self) -> None:
        """The journal without a line that a kill has cut."""
        new = self._journal.with_suffix(".unfinished")
        new.write_text("".join(json.dumps(row) + "\n" for row in self._rows), encoding="utf-8")
        new.replace(self._journal)

    def _seal(self) -> None:
        """Make the journal a part, and begin another."""
        part = self._journal.with_suffix(".parquet")
        new = self._journal.with_suffix(".unfinished")
        with new.open("wb") as stream:
            pq.write_table(pa.Table.from_pylist(self._rows, schema=self.schema), stream, compression="zstd")
            stream.flush()
            os.fsync(stream.fileno())
        new.replace(part)
        self._lines.close()
        self._journal.unlink()
        self._number += 1
        self._rows = []
        self._lines = self._journal.open("a", encoding="utf-8")


def _read(journal: Path) -> list[dict[str, Any]]:
    """Rows of a journal up to its first line that is cut."""
    rows = []
    for line in journal.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True):
        try:
            row = json.loads(line)
        except ValueError:
            break
        if not line.endswith("\n"):
            break
        rows.append(row)
    return rows


def differences(ours: Mapping[str, Any], theirs: Mapping[str, Any], place: str = "") -> Iterator[str]:
    """What differs between two descriptions of sweeps, in words."""
    for key in dict.fromkeys((*theirs, *ours)):
        name = f"{place}.{key}" if place else str(key)
        mine, other = ours.get(key), theirs.get(key)
        if isinstance(mine, Mapping) and isinstance(other, Mapping):
            yield from differences(mine, other, name)
        elif canonical(mine) != canonical(other):
            yield f"{name} was {canonical(other) if key in theirs else 'not there'} and is " + (
                canonical(mine) if key in ours else "not there"
            )


def begun(folder: Path, about: Mapping[str, Any], *, anew: bool) -> None:
    """Say in the folder of the rows what they are of; refuse rows of another sweep.

    Args:
        folder: of the rows.
        about: what decides their numbers: spec, inputs, versions.
        anew: discard rows of another sweep.

    Raises:
        InputError: there are rows of another sweep.
    """
    file = folder / _ABOUT
    if file.exists():
        theirs = json.loads(file.read_text(encoding="utf-8"))
        changed = list(differences(about, theirs))
        if changed and not anew:
            raise InputError(refusal(folder, changed))
        if not changed:
            return
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    new = file.with_suffix(".unfinished")
    new.write_text(canonical(about), encoding="utf-8")
    new.replace(file)


def refusal(folder: Path, changed: Sequence[str]) -> str:
    """Why the rows of a folder cannot be gone on with."""
    more = f" (and {len(changed) - 1} more)" if len(changed) > 1 else ""
    return (
        f"{folder}: holds runs of another sweep: {changed[0]}{more}; go on with what it was, choose another --out, or "
        "discard those runs with --force"
    )


def schema_of(columns: Mapping[str, Iterable[Any]]) -> pa.Schema:
    """Schema of a row.

    Args:
        columns: the factors, each with its values: what decides the type.
    """
    fields = [pa.field("run", pa.int64(), nullable=False)]
    fields += [pa.field(name, pa.string()) for name in ("case", "recording", "source")]
    fields += [pa.field("point", pa.int64()), pa.field("motion_s", pa.float64())]
    fields += [pa.field(name, _type(list(values))) for name, values in columns.items()]
    fields += [pa.field(name, kind) for name, kind in RESULTS.items()]
    return pa.schema(fields)


def _type(values: Sequence[Any]) -> pa.DataType:
    if any(isinstance(one, str) for one in values):
        return pa.string()
    if all(isinstance(one, bool) for one in values):
        return pa.bool_()
    if all(isinstance(one, int) and not isinstance(one, bool) for one in values):
        return pa.int64()
    return pa.float64()


def digest(about: Mapping[str, Any]) -> str:
    """SHA-256 of the description of a sweep."""
    return seal_of(about)
