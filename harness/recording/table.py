"""Splits CSV text into cells with their row numbers, counted from 1 as in an editor, and converts them to numbers."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.recording.findings import place, rows_text

SEPARATORS = (";", "\t", ",")  # in this order: a comma may also be a decimal mark
MAX_COLUMNS = 1000  # of a logger's export; more are a table that is written along its rows
MAX_VALUE = 1e20  # above nanoseconds since 1970, below the 1e38 that loggers write for "no value"
MISSING = ("", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--")


@dataclass(frozen=True)
class Table:
    """Cells of a CSV file.

    Attributes:
        path: the file.
        header: column names, stripped of blanks.
        header_row: row number of the header.
        columns: cells of each column, each of length n.
        rows: row number of each cell, shape (n,).
    """

    path: Path
    header: tuple[str, ...]
    header_row: int
    columns: tuple[tuple[str, ...], ...]
    rows: NDArray[np.intp]


def read_table(path: Path, text: str) -> Table:
    """Splits CSV text into columns: comma, semicolon or tab; `#` starts a comment line; blank rows are skipped.

    Column names may also be given in the last comment before the numbers, as `numpy.savetxt` writes them.

    Raises:
        InputError: no header, no rows, or a row whose number of cells differs from the header's.
    """
    separator: str | None = None
    comments: list[tuple[int, str]] = []
    kept: list[tuple[int, str]] = []
    for row, line in enumerate(text.split("\n"), start=1):
        announced = re.fullmatch(r"sep=(.)\s*", line) if not kept else None
        if announced:  # written by spreadsheet programs
            separator = announced.group(1)
        elif line.lstrip().startswith("#"):
            if not kept:
                comments.append((row, line.lstrip("# \t")))
        elif line.strip():
            kept.append((row, line))
    if not kept:
        raise InputError(f"{path}: contains no data. Check that the recording was saved completely.")
    if separator is None:
        separator = next((mark for mark in SEPARATORS if mark in kept[0][1]), None)
    if separator is None:
        raise InputError(
            f"{place(path, kept[0][0])}: no separator in '{kept[0][1].strip()[:60]}'. "
            "Separate the columns by comma, semicolon or tab."
        )
    if kept[0][1].count(separator) >= MAX_COLUMNS:
        raise InputError(
            f"{place(path, kept[0][0])}: {kept[0][1].count(separator) + 1} columns; at most {MAX_COLUMNS} are read. "
            "Write one row per reading, with columns for time, beam angle and ball position."
        )
    cells = _split(path, kept, separator)
    rows = [row for row, _ in kept]
    if all(_is_number(cell) or cell.lower() in MISSING for cell in cells[0]):
        header_row, header = _commented_header(path, comments, separator, rows[0], cells[0])
    else:
        header_row, header = rows.pop(0), cells.pop(0)
    while header and not header[-1]:
        header.pop()
    return _table(path, header_row, header, rows, cells)


def _table(path: Path, header_row: int, header: list[str], rows: list[int], cells: list[list[str]]) -> Table:
    width = len(header)
    full_rows: list[int] = []
    full_cells: list[list[str]] = []
    for row, line in zip(rows, cells, strict=True):
        if not any(line):
            continue
        if len(line) < width:
            raise InputError(
                f"{place(path, row)}: {len(line)} cells, but the header in row {header_row} has {width}. "
                "Complete the row, or delete it if the recording was cut off there; a blank cell keeps its separator."
            )
        if any(line[width:]):
            raise InputError(
                f"{place(path, row)}: {len(line)} cells, but the header in row {header_row} has {width}. "
                "If commas are decimal marks here, separate the columns by semicolons."
            )
        full_rows.append(row)
        full_cells.append(line[:width])
    if not full_rows:
        raise InputError(f"{path}: contains column names but no rows. Check that the recording was saved completely.")
    return Table(path, tuple(header), header_row, tuple(zip(*full_cells, strict=True)), np.array(full_rows))


def _split(path: Path, lines: list[tuple[int, str]], separator: str) -> list[list[str]]:
    reader = csv.reader((line for _, line in lines), delimiter=separator, skipinitialspace=True)
    cells: list[list[str]] = []
    for line in reader:
        if reader.line_num != len(cells) + 1:
            row = lines[len(cells)][0]
            raise InputError(f"{place(path, row)}: a quotation mark is not closed. Close or remove it.")
        cells.append([cell.strip() for cell in line])
    return cells


def _commented_header(
    path: Path, comments: list[tuple[int, str]], separator: str, row: int, first: list[str]
) -> tuple[int, list[str]]:
    if comments:
        header_row, comment = comments[-1]
        header = [name.strip() for name in next(csv.reader([comment], delimiter=separator))]
        if len(header) == len(first) and not any(_is_number(name) for name in header):
            return header_row, header
    raise InputError(
        f"{place(path, row)}: numbers instead of column names. "
        "Add a first row with column names: time_s,beam_angle_rad,ball_position_m."
    )


def numbers_of(table: Table, *indices: int) -> list[FloatArray]:
    """The columns `indices` as numbers, each of shape (n,); blank cells, `NA` and the like become NaN.

    Commas are decimal marks if no number of these columns has a decimal point.

    Raises:
        InputError: a cell is not a number or beyond `MAX_VALUE`, or points and commas are mixed.
    """
    cells = {index: np.char.replace(np.array(table.columns[index]), "\u2212", "-") for index in indices}
    with_comma = {index: np.char.find(column, ",") >= 0 for index, column in cells.items()}
    if any(mask.any() for mask in with_comma.values()):
        for index, column in cells.items():
            points = (np.char.find(column, ".") >= 0) & np.array([_is_number(cell) for cell in column])
            if points.any():
                _refuse_mixed_marks(table, cells, with_comma, index, int(np.argmax(points)))
        cells = {index: np.char.replace(column, ",", ".") for index, column in cells.items()}
    return [_numbers(table, index, cells[index]) for index in indices]


def _numbers(table: Table, index: int, cells: NDArray[np.str_]) -> FloatArray:
    known = ~np.isin(np.char.lower(cells), MISSING)
    values = np.full(len(cells), np.nan)
    try:
        if (np.char.find(cells, "_") >= 0).any():  # Python's way to write 1000 as 1_000
            raise ValueError
        values[known] = cells[known].astype(np.float64)
    except ValueError:
        bad = [int(i) for i in np.flatnonzero(known) if not _is_number(cells[i])]
        _refuse_text(table, index, bad)
    excessive = np.flatnonzero(known & ~(np.abs(values) < MAX_VALUE))
    if len(excessive):
        where = place(table.path, table.rows[excessive[0]], table.header[index])
        raise InputError(
            f"{where}: '{table.columns[index][excessive[0]]}' is not a measured value. Leave the cell blank if unknown."
        )
    return values


def _refuse_text(table: Table, index: int, bad: list[int]) -> None:
    text = table.columns[index][bad[0]]
    row = int(table.rows[bad[0]])
    advice = "Correct the number, or leave the cell blank if it is unknown."
    if bad == [0] and not any(_is_number(column[0]) for column in table.columns):
        advice = "If this row holds units, move them into the column names (such as time_ms) and delete the row."
    others = f" (also {rows_text(table.rows[bad[1:]])})" if len(bad) > 1 else ""
    raise InputError(f"{place(table.path, row, table.header[index])}: '{text}' is not a number{others}. {advice}")


def _refuse_mixed_marks(
    table: Table, cells: dict[int, NDArray[np.str_]], commas: dict[int, NDArray[np.bool_]], index: int, at: int
) -> None:
    other = next(i for i, mask in commas.items() if mask.any())
    comma_at = int(np.argmax(commas[other]))
    raise InputError(
        f"{place(table.path, int(table.rows[comma_at]), table.header[other])}: '{cells[other][comma_at]}' has a comma, "
        f"but '{cells[index][at]}' in row {table.rows[at]} has a decimal point. Use one decimal mark and no "
        "thousands separators."
    )


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return "_" not in cell and cell.lower() not in MISSING
