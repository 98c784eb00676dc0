"""Spreadsheets (.xlsx) and Parquet files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.errors import INTERRUPTS, InputError
from harness.importing.bytes import sha256_of
from harness.importing.cells import measured
from harness.importing.grid import data_begins, divide, group_of_sheet
from harness.importing.signals import Group, Signal, SourceFile, group_of, unique_names
from harness.importing.words import read_name


def read_workbook(path: Path) -> SourceFile:
    """Reads every sheet of a workbook that holds a table of numbers.

    Raises:
        InputError: openpyxl is missing, the file is damaged, or no sheet has a table of numbers.
    """
    try:
        from openpyxl import load_workbook
    except ImportError:
        raise InputError(
            f"{path}: spreadsheets need the package openpyxl. Install it: pip install 'ball-beam-harness[files]', or "
            "save the sheet as CSV."
        ) from None
    try:
        with path.open("rb") as stream:  # of a path openpyxl would look at the name, too
            book = load_workbook(stream, read_only=True, data_only=True)
            sheets = [(one.title, [list(row) for row in one.iter_rows(values_only=True)]) for one in book.worksheets]
            book.close()
    except INTERRUPTS:
        raise
    except Exception as error:  # openpyxl raises whatever a damaged file leads to
        raise InputError(
            f"{path}: cannot be read as a workbook ({type(error).__name__}: {error}). Save it again as .xlsx."
        ) from None
    groups: list[Group] = []
    notes: list[str] = []
    for title, content in sheets:
        rows = [(number, list(map(_cell, row))) for number, row in enumerate(content, start=1)]
        rows = [(number, cells) for number, cells in rows if any(cells)]
        if data_begins(rows) is None:
            notes.append(f"sheet '{title}' has no table of numbers")
            continue
        # Cells to the left of a table are as blank as those of a missing value.
        left = min(next(at for at, cell in enumerate(cells) if cell) for _, cells in rows)
        sheet = divide(path, [(number, cells[left:]) for number, cells in rows], aligned=True)
        group, left_out = group_of_sheet(path, sheet, title)
        groups.append(group)
        notes += [*sheet.notes, *left_out]
    if not groups:
        raise InputError(f"{path}: no sheet has a table of numbers. Write one row per reading.")
    if len(groups) == 1:
        groups = [replace(groups[0], name="")]
    return SourceFile(path, sha256_of(path), "spreadsheet", tuple(groups), tuple(notes))


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, int | float):
        return repr(value)
    return str(value.isoformat(" ")) if hasattr(value, "date") else str(value).strip()


def read_parquet(path: Path) -> SourceFile:
    """Reads the columns of numbers, dates and durations of a Parquet file; a column's `unit` in its metadata counts.

    Raises:
        InputError: the file is damaged, or has no columns of numbers.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(path)
    except INTERRUPTS:
        raise
    except Exception as error:
        raise InputError(f"{path}: cannot be read as Parquet ({type(error).__name__}: {error}).") from None
    signals: list[Signal] = []
    left_out: list[str] = []
    words: dict[str, tuple[str, ...]] = {}
    stamps: list[str] = []
    for name, field in zip(unique_names(table.schema.names), table.schema, strict=True):
        column = table.column(len(signals) + len(left_out))
        metadata = field.metadata or {}
        unit = next(
            (value.decode(errors="replace") for key, value in metadata.items() if key.lower() in (b"unit", b"units")),
            "",
        )
        kind = field.type
        if pa.types.is_timestamp(kind) or pa.types.is_duration(kind) or pa.types.is_time(kind):
            stamps.append(name)
            ticks = column.cast(pa.int32() if pa.types.is_time32(kind) else pa.int64()).to_numpy().astype(np.float64)
            factor = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit]
            first = ticks[np.isfinite(ticks)][:1]
            signals.append(Signal(name, (ticks - (first[0] if len(first) else 0.0)) * factor, "s", "its type"))
        elif pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_decimal(kind):
            values = column.cast(pa.float64()).to_numpy().astype(np.float64)
            signals.append(Signal(name, measured(values), unit, "its metadata" if unit else ""))
        else:
            left_out.append(name)
            if pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_dictionary(kind):
                words[name] = tuple("" if value is None else str(value) for value in column.to_pylist())
    if not signals or not len(signals[0].values):
        raise InputError(f"{path}: a Parquet file without columns of numbers.")
    notes = (f"columns of other types left out: {', '.join(left_out)}",) if left_out else ()
    named = [one.name for one in signals if read_name(one.name).kind == "time"]
    time = stamps[0] if len(stamps) == 1 and not named else None  # such as the index of a table in pandas
    return SourceFile(
        path, sha256_of(path), "Parquet", (replace(group_of("", signals, time=time), words=words),), notes
    )
