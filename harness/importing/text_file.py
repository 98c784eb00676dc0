"""Text files: separator, preamble of an instrument, column names and units, numbers."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.errors import InputError
from harness.importing import labview
from harness.importing.grid import Rows, Sheet, data_begins, divide, group_of_sheet, is_data
from harness.importing.oscilloscope import Preamble, instrument, preamble_of, without_side_preamble
from harness.importing.serial_log import labelled_rows, with_received, without_clock
from harness.importing.signals import Group, SourceFile, counts_rows
from harness.importing.words import is_unit, read_name
from harness.recording.source import read_source

BLANKS = " "
SEPARATORS = (";", "\t", ",", BLANKS)  # in this order: a comma may also be a decimal mark
MOST_LINES_LOOKED_AT = 400  # to find the separator
_UNIT_OF = re.compile(r"(.*\S)\s*(?:[\[(]\s*(.+?)\s*[\])]|\sin\s+(\S+)|\s*[:=]\s*(\S+))")
MOST_LINES_OF_A_NAME = 6  # of a row of names with line breaks in them
_BETWEEN_BLANKS = re.compile(r'"[^"]+"(?=\s|$)|\S+')  # R writes names between quotation marks


def read_text(path: Path) -> SourceFile:
    """Reads a text file of any instrument.

    Raises:
        InputError: it cannot be read, is not text, or has no table of numbers.
    """
    source = read_source(path)
    lines = source.text.split("\n")
    if labview.is_labview(lines):
        return labview.read(path, source.sha256, lines)
    lines, clock = without_clock(lines)
    labelled = labelled_rows(lines)
    if labelled is not None:
        rows, told = labelled
        layout = "labels in every line"
    else:
        separator = _separator(path, lines)
        rows, told, layout = _rows(path, lines, separator), (), _WORDS[separator]
    rows, side = without_side_preamble(rows)
    sheet = divide(path, rows)
    preamble = preamble_of((*side, *sheet.preamble))
    written = sheet.names
    sheet = _named(sheet, preamble)
    group, notes = group_of_sheet(path, sheet)
    old = dict(zip(sheet.names, written, strict=True))
    group = replace(group, signals=tuple(replace(one, written=old[one.name]) for one in group.signals))
    return SourceFile(
        path,
        source.sha256,
        f"{instrument(preamble, sheet.names)}, {layout}",
        (with_received(_with_interval(group, preamble, sheet), clock),),
        (*told, *sheet.notes, *notes),
    )


_WORDS = {";": "columns by semicolons", "\t": "columns by tabs", ",": "columns by commas", BLANKS: "columns by blanks"}


def _separator(path: Path, lines: Sequence[str]) -> str:
    """The separator by which most of the first rows become data of at least two columns; else of one."""
    announced = re.fullmatch(r"sep=(.)\s*", lines[0]) if lines else None
    if announced and announced[1] in SEPARATORS:
        return announced[1]
    best, most = "", 0
    for separator in SEPARATORS:
        rows = _rows(path, lines[:MOST_LINES_LOOKED_AT], separator, strict=False)
        begin = data_begins(rows)
        if begin is None:
            continue
        data = [cells for _, cells in rows[begin:] if is_data(cells)]
        count = sum(len(cells) > 1 for cells in data) * 2 + 1
        if count > most:
            best, most = separator, count
    if not best:
        raise InputError(
            f"{path}: no table of numbers in the first {MOST_LINES_LOOKED_AT} lines, with columns separated by comma, "
            "semicolon, tab or blanks. Export the recording as text with one row per reading."
        )
    return best


def _rows(path: Path, lines: Sequence[str], separator: str, *, strict: bool = True) -> Rows:
    """Row numbers and cells of all lines that are not blank."""
    made: list[tuple[int, list[str]]] = []
    consumed = 0
    for number, line in enumerate(lines, start=1):
        if number <= consumed:
            continue
        text = line.strip("\ufeff \r") if separator != "\t" else line.strip("\ufeff\r")
        if not text.strip() or re.fullmatch(r"sep=.", text):
            continue
        text = re.sub(r"^\s*[#%]+\s*", "", text)  # comments hold preambles and column names
        if separator == BLANKS:
            cells = [one.strip('"') if one.endswith('"') else one for one in _BETWEEN_BLANKS.findall(text)]
        elif '"' in text:
            within = bool(made) and is_data(made[-1][1])
            after = [] if within or not strict else lines[number : number + MOST_LINES_OF_A_NAME]
            cells, more = _quoted(path, number, text, after, separator, strict=strict)
            consumed = number + more
        else:
            cells = text.split(separator)
        if any(cells):
            made.append((number, [cell.strip().strip("\x00") for cell in cells]))
    return made


def _quoted(
    path: Path, number: int, text: str, after: Sequence[str], separator: str, *, strict: bool
) -> tuple[list[str], int]:
    """Cells of a row with quotation marks, and how many of the lines after it belong to them, as a name may be broken.

    Raises:
        InputError: a mark stays open.
    """
    for lines in ([text], [f"{one}\n" for one in (text, *after)]):
        reader = csv.reader(lines, delimiter=separator, skipinitialspace=True, strict=strict)
        try:
            cells = next(reader)
        except csv.Error:
            continue
        return [" ".join(cell.split("\n")) for cell in cells], reader.line_num - 1
    raise InputError(f"{path}, row {number}: a quotation mark is not closed. Close or remove it.")


def _said_of_units(sheet: Sheet) -> list[str]:
    """Units of the columns, with those that a preamble writes behind their names: `t in ms`, `x: cm`, `x [inch]`."""
    units = list(sheet.units)
    for cell in (cell for cells in sheet.preamble for cell in cells):
        found = _UNIT_OF.fullmatch(re.sub(r"^\s*(units?|columns?)\s*[:=]\s*", "", cell, flags=re.IGNORECASE))
        unit = next(filter(None, found.groups()[1:]), "") if found else ""
        if found and is_unit(unit):
            for at, name in enumerate(sheet.names):
                if name.casefold() == found[1].casefold() and not units[at] and not read_name(name).unit:
                    units[at] = unit
    return units


def _named(sheet: Sheet, preamble: Preamble) -> Sheet:
    """The sheet with names and units that stand in the preamble of the instrument only."""
    names, units = list(sheet.names), _said_of_units(sheet)
    if names[0].casefold() in ("column 1", "x-axis", "source") and units[0].casefold() in ("second", "s", "sec"):
        names[0] = "time"
    if len(names) == 2 and names[1].startswith("column") and preamble.text("source"):
        # One channel a file, whose columns have no names.
        names[1], units[1] = preamble.text("source"), units[1] or preamble.text("vertical units")
        names[0] = "time"
    if read_name(names[0]).kind == "time" and preamble.text("horizontal units").casefold() in ("s", "second"):
        units[0] = units[0] or "s"
    vertical = preamble.cells.get("vertical units", ())
    if read_name(names[0]).kind == "time" and len(vertical) == len(names) - 1 and all(map(is_unit, vertical)):
        units[1:] = [unit or written for unit, written in zip(units[1:], vertical, strict=True)]
    # Keysight numbers its channels: `x-axis,1,2`.
    if names[0] == "time":
        names = [f"CH{name}" if re.fullmatch(r"[1-8]", name) else name for name in names]
    return replace(sheet, names=tuple(names), units=tuple(units))


def _with_interval(group: Group, preamble: Preamble, sheet: Sheet) -> Group:
    """The group with the sampling interval of the preamble, where its first column only counts the samples."""
    if preamble.increment is None:
        return group
    first = group.signals[0]
    counts = first.name.casefold() in ("x", "sequence", "index", "sample", "point") and counts_rows(first.values)
    signals = group.signals[1:] if counts and len(group.signals) > 1 else group.signals
    start = 0.0 if preamble.start is None else preamble.start
    if counts:
        start += float(first.values[0]) * preamble.increment
    return replace(group, signals=signals, step=preamble.increment, start=start, step_from=preamble.increment_from)
