"""Finds the numbers in a sheet of cells, whatever stands above them: a preamble, column names, a row of units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.errors import InputError
from harness.importing.cells import is_missing, is_number, numbers
from harness.importing.signals import Group, Signal, is_known, unique_names
from harness.importing.stamps import is_date, is_stamp, seconds
from harness.importing.words import ROLES, is_unit, read_name
from harness.recording.findings import place, rows_text

MOST_COLUMNS = 1000
FEWEST_ROWS = 3  # below each other, to be taken for data
MOST_COUNTED = 1000  # rows that are looked at to see whether a column counts them
# Words that stand in the first cell of a row of units, or of names, and are neither.
_LABELS = ("source", "sequence", "unit", "units", "einheit", "einheiten", "channel", "")

Rows = Sequence[tuple[int, list[str]]]
"""Row number and cells of each row; blank rows are left out."""


@dataclass(frozen=True)
class Sheet:
    """Cells divided into parts.

    Attributes:
        preamble: rows above the column names.
        names: of the columns, of their own.
        units: of the columns; empty where none is written in a row of its own.
        cells: of the data, row by row.
        rows: row numbers of the data, shape (n,).
        notes: what was left out.
    """

    preamble: tuple[list[str], ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    cells: tuple[list[str], ...]
    rows: NDArray[np.intp]
    notes: tuple[str, ...]


def is_data(cells: Sequence[str]) -> bool:
    """Whether a row looks like data: numbers or times of day, more of them than of words."""
    filled = [cell for cell in cells if not is_missing(cell)]
    values = [is_number(cell) or is_stamp(cell) or is_date(cell) for cell in filled]
    return bool(filled) and sum(values) * 2 > len(filled) and values[0]


def data_begins(rows: Rows) -> int | None:
    """Index of the first of at least three rows of data of the same width; `None` if there are none."""
    run = 0
    for index, (_, cells) in enumerate(rows):
        before = rows[index - 1][1]
        same = run and (len(cells) == len(before) or len(_trimmed(cells)) == len(_trimmed(before)))
        run = (run + 1 if same or not run else 1) if is_data(cells) else 0
        if run == FEWEST_ROWS:
            return index - FEWEST_ROWS + 1
    return None


def divide(path: Path, rows: Rows, *, aligned: bool = False) -> Sheet:
    """Divides rows into preamble, names, units and data.

    Args:
        aligned: whether a name stands above its column wherever it is, as in a spreadsheet; in text, cells are counted.

    Raises:
        InputError: there is no table of numbers, something else stands among them, or names are too few.
    """
    begin = data_begins(rows)
    if begin is None:
        raise InputError(
            f"{path}: no table of numbers in it (at least {FEWEST_ROWS} rows of at least one column below each other). "
            "Export the recording with one row per reading."
        )
    first = [cells for _, cells in rows[begin : begin + FEWEST_ROWS]]
    width = max(len(_trimmed(cells)) for cells in first)
    most = max(len(cells) for cells in first)
    head = begin
    names: list[str] = []
    units: list[str] = []
    # Names and units may stand in either order.
    while head > 0 and begin - head < 2 and not (names and units):
        cells = _trimmed(rows[head - 1][1])
        if not 0 < len(cells) <= max(width + 1, most) or (len(cells) < width and len(cells) < 2) or is_data(cells):
            break
        missing = 0 if aligned else width - len(rows[head - 1][1])
        if missing > (1 if _counts(rows[begin:]) else 0) and not _says_something(cells):
            break
        if not units and _is_units(cells):
            units = cells
        elif not names:
            names = cells
        else:
            break
        head -= 1
    above = list(rows[:head])
    if not names and (titled := _names_above(above, width)) is not None:
        names = above.pop(titled)[1]
    width = max(width, min(len(names), most))
    if width > MOST_COLUMNS:
        raise InputError(f"{place(path, rows[begin][0])}: {width} columns; at most {MOST_COLUMNS} are read.")
    body, notes = _body(path, rows[begin:], width)
    if not aligned:
        names, units, said = _with_first(path, rows[head:begin], names, units, body)
        notes = (*notes, *said)
    if not names and above and (more := _names_too_many(above[-1][1], width)):
        notes = (*notes, f"row {above[-1][0]} has {more} names for {width} columns, which are called by their numbers")
    like_data = [row for row, cells in above if is_data(cells) and len(_trimmed(cells)) > 1]
    if like_data:
        notes = (*notes, f"{rows_text(like_data)} above the table left out, though it looks like data")
    filled = (*names, *[""] * width)[:width]
    return Sheet(
        tuple(cells for _, cells in above),
        tuple(unique_names(filled)),
        tuple(unit.strip("()[] ") for unit in (*units, *[""] * width)[:width]),
        tuple(cells for _, cells in body),
        np.array([row for row, _ in body]),
        notes,
    )


def _names_above(above: Rows, width: int) -> int | None:
    """Index of a row of names that remarks part from the data: the last as wide as these, if only narrower follow."""
    for index in range(len(above) - 1, -1, -1):
        cells = above[index][1]
        if len(cells) >= width:
            named = 1 < width == len(cells) and not any(is_missing(cell) or is_number(cell) for cell in cells)
            return index if named else None
    return None


def _names_too_many(cells: Sequence[str], width: int) -> int:
    """How many names stand in a row that has more of them than there are columns; 0 if it is no such row."""
    named = _trimmed(cells)
    says = len(named) > width and not any(is_missing(cell) or is_number(cell) for cell in named)
    return len(named) if says and any(read_name(cell).kind for cell in named) else 0


def group_of_sheet(path: Path, sheet: Sheet, name: str = "") -> tuple[Group, tuple[str, ...]]:
    """The columns of numbers, and notes on those of words."""
    _refuse_mixed_marks(path, sheet)
    signals: list[Signal] = []
    words: dict[str, tuple[str, ...]] = {}
    blank: list[str] = []
    for column, (title, unit) in enumerate(zip(sheet.names, sheet.units, strict=True)):
        cells = [row[column] for row in sheet.cells]
        if all(map(is_missing, cells)):
            if not re.fullmatch(r"column \d+", title):
                blank.append(title)
            if read_name(title).kind in (*ROLES, "shaft"):  # else another column would be taken for it
                signals.append(Signal(title, np.full(len(cells), np.nan), unit, "the file" if unit else ""))
            continue
        values = numbers(cells)
        if values is not None:
            signals.append(Signal(title, values, unit, "the file" if unit else ""))
            continue
        times = seconds(cells)
        if times is not None:
            signals.append(Signal(title, times, "s", "dates or times of day"))
            continue
        wrong = [
            (row, cell)
            for row, cell in zip(sheet.rows, cells, strict=True)
            if not (is_number(cell) or is_missing(cell))
        ]
        if len(wrong) * 4 <= len(cells):  # a column of numbers with an accident in it
            row, cell = wrong[0]
            raise InputError(
                f"{place(path, int(row), title)}: '{cell[:40]}' is not a number. Correct it, or leave the cell blank "
                "if it is unknown."
            )
        words[title] = tuple(cells)
    notes = tuple(
        f"{what}: {', '.join(names)}"
        for what, names in (("columns of words left out", words), ("columns without a value", blank))
        if names
    )
    if not any(is_known(one) for one in signals):
        raise InputError(f"{path}: none of its columns holds numbers. Export the recording as numbers.")
    return Group(name, tuple(signals), sheet.rows, words=words), notes


def _refuse_mixed_marks(path: Path, sheet: Sheet) -> None:
    """Refuse a comma and a point as decimal marks in one table: one of them may part thousands."""
    first: dict[str, tuple[int, int, str]] = {}
    for row, cells in zip(sheet.rows, sheet.cells, strict=True):
        for column, cell in enumerate(cells):
            mark = "," if "," in cell else "." if "." in cell else ""
            if mark and mark not in first and is_number(cell):
                first[mark] = int(row), column, cell
        if len(first) == 2:
            row, column, cell = first[","]
            other, _, point = first["."]
            raise InputError(
                f"{place(path, row, sheet.names[column])}: '{cell}' has a comma, but '{point}' in row {other} has a "
                "point. Use one decimal mark and no thousands separators."
            )


def _body(path: Path, rows: Rows, width: int) -> tuple[list[tuple[int, list[str]]], tuple[str, ...]]:
    body: list[tuple[int, list[str]]] = []
    last = next(index for index in range(len(rows) - 1, -1, -1) if is_data(rows[index][1]))
    for index, (row, cells) in enumerate(rows):
        trimmed = _trimmed(cells)
        if index > last:
            return body, (f"rows {row} to {rows[-1][0]} below the numbers left out",)
        if len(trimmed) > width:
            raise InputError(
                f"{place(path, row)}: {len(trimmed)} cells where the rows above have {width}. Save each table in a "
                "file of its own."
            )
        if len(cells) < width and index == len(rows) - 1:
            return body, (f"row {row} is incomplete and was left out",)
        if not any(is_number(cell) or is_stamp(cell) or is_missing(cell) for cell in trimmed):
            raise InputError(
                f"{place(path, row)}: '{' '.join(trimmed)[:60]}' stands among the numbers. Delete this row, or save "
                "each table in a file of its own."
            )
        body.append((row, [*cells, *[""] * (width - len(cells))][:width]))
    return body, ()


def _with_first(
    path: Path, head: Rows, names: list[str], units: list[str], body: Rows
) -> tuple[list[str], list[str], tuple[str, ...]]:
    """Names and units for all columns, where R writes none above the numbers of its rows; and a note of that.

    Raises:
        InputError: names are fewer than columns otherwise, so that nobody knows which belongs to which.
    """
    width = max(len(_trimmed(cells)) for _, cells in body[:FEWEST_ROWS])
    titles = names or units
    written = next((each for each in head if _trimmed(each[1]) == titles), None)
    if written is None or len(written[1]) >= width:
        return names, units, ()
    row, cells = written
    kind = "names" if names else "units"
    if width - len(cells) > 1 or not _counts(body):
        remedy = "Write one above each column"
        if width % len(cells) == 0:
            remedy += "; if commas are decimal marks in it, too, separate the columns by semicolons"
        raise InputError(
            f"{place(path, body[0][0])}: {width} cells, but the header in row {row} has {len(cells)} {kind}. {remedy}."
        )
    note = f"the header has {len(cells)} {kind} for {width} columns; the first, which counts the rows, was given none"
    shifted = [["", *each] if 0 < len(each) < width else each for each in (names, units)]
    return shifted[0], shifted[1], (note,)


def _counts(body: Rows) -> bool:
    """Whether the first cells count the rows from one."""
    return all(cells[0] == str(number) for number, (_, cells) in enumerate(body[:MOST_COUNTED], start=1))


def _says_something(cells: Sequence[str]) -> bool:
    """Whether a row with fewer cells than the data has names or units; else it is of the preamble."""
    if any(is_number(cell) or is_stamp(cell) or is_date(cell) for cell in cells):
        return False
    return _is_units(cells) or any(read_name(cell).kind in (*ROLES, "shaft") for cell in cells)


def _is_units(cells: Sequence[str]) -> bool:
    """Whether a row holds units: every cell is one, but for a label in the first."""
    stripped = [cell.strip("()[] ") for cell in cells]
    rest = stripped[1:] if stripped and stripped[0].casefold() in _LABELS else stripped
    filled = [cell for cell in rest if cell]
    # Single letters are names as often as units: `t, x` is no row of units, and neither is `s, m` but for its company.
    return bool(filled) and all(map(is_unit, filled)) and [one.casefold() for one in filled] != ["s"]


def _trimmed(cells: Sequence[str]) -> list[str]:
    made = list(cells)
    while made and not made[-1].strip():
        made.pop()
    return made
