"""LabVIEW measurement files (.lvm): header blocks that end with `***End_of_Header***`, then X and Y columns.

The layout is in National Instruments' "Specification for the LabVIEW Measurement File (.lvm)".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from harness.errors import InputError
from harness.importing.cells import is_number, numbers
from harness.importing.signals import Group, Signal, SourceFile, unique_names
from harness.recording.findings import place

END = "***end_of_header***"
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


def is_labview(lines: Sequence[str]) -> bool:
    """Whether these are the lines of such a file."""
    return any(line.strip().casefold().startswith(END) for line in lines[:200])


def read(path: Path, sha256: str, lines: Sequence[str]) -> SourceFile:
    """Reads all segments; segments with the same channels follow each other in one group.

    Raises:
        InputError: the file has no data, or a cell that is not a number.
    """
    header = _entries(lines[: _ends(lines)[0]], "\t")
    separator = _SEPARATORS.get((header.get("separator") or ["tab"])[0].casefold(), "\t")
    header = _entries(lines[: _ends(lines)[0]], separator)
    layout = (header.get("x_columns") or ["One"])[0].casefold()
    segments = [one for one in _segments(path, lines, separator, layout) if one is not None]
    if not segments:
        raise InputError(f"{path}: a LabVIEW file without data below its header. Check that it was saved completely.")
    notes: tuple[str, ...] = ()
    first = segments[0]
    same = [one for one in segments if [s.name for s in one.signals] == [s.name for s in first.signals]]
    if len(segments) > 1:
        notes = (f"{len(segments)} segments, of which {len(same)} with the same channels were joined",)
    return SourceFile(path, sha256, f"LabVIEW measurement file ({layout} X column)", (_joined(same),), notes)


def _ends(lines: Sequence[str]) -> list[int]:
    return [number for number, line in enumerate(lines) if line.strip().casefold().startswith(END)]


def _entries(lines: Sequence[str], separator: str) -> Mapping[str, list[str]]:
    made: dict[str, list[str]] = {}
    for line in lines:
        key, *values = line.split(separator)
        if key.strip():
            made[key.strip().casefold()] = [value.strip() for value in values]
    return made


def _segments(path: Path, lines: Sequence[str], separator: str, layout: str) -> list[Group | None]:
    ends = _ends(lines)
    made: list[Group | None] = []
    begin = 0
    for number, end in enumerate(ends):
        header = _entries(lines[begin:end], separator)
        last = ends[number + 1] if number + 1 < len(ends) else len(lines)
        body = [(row, line) for row, line in enumerate(lines[end + 1 : last], start=end + 2) if line.strip()]
        # What follows the numbers is the header of the next segment.
        count = next((at for at, (_, line) in enumerate(body[1:]) if not _starts_with_number(line, separator)), None)
        stop = len(body) if count is None else count + 1
        if len(body) > 1 and stop > 1 and not _starts_with_number(body[0][1], separator):
            made.append(_group(path, header, body[0][1], body[1:stop], separator, layout))
            begin = body[stop - 1][0]
        else:
            begin = end + 1
    return made


def _starts_with_number(line: str, separator: str) -> bool:
    cells = [cell.strip() for cell in line.split(separator)]
    return any(map(is_number, cells)) and (not cells[0] or is_number(cells[0]))


def _group(
    path: Path, header: Mapping[str, list[str]], title: str, body: list[tuple[int, str]], separator: str, layout: str
) -> Group:
    names = [name.strip() for name in title.split(separator)]
    if names and names[-1].casefold() == "comment":
        names.pop()
    units = header.get("y_unit_label", [])
    dimension = (header.get("x_dimension") or ["Time"])[0]
    rows = np.array([row for row, _ in body])
    cells = [[cell.strip() for cell in line.split(separator)] for _, line in body]
    signals: list[Signal] = []
    times: list[Signal] = []
    channel = 0
    for column, name in enumerate(names):
        values = numbers([row[column] if column < len(row) else "" for row in cells])
        if values is None:
            row, text = next(
                (number, line[column])
                for number, line in zip(rows, cells, strict=True)
                if column < len(line) and numbers([line[column]]) is None
            )
            raise InputError(f"{place(path, int(row), name)}: '{text[:40]}' is not a number. Correct it, or blank it.")
        if name.casefold() == "x_value":
            times.append(Signal(name, values, "s" if dimension.casefold() == "time" else dimension, "X_Dimension"))
            continue
        unit = units[channel] if channel < len(units) else ""
        signals.append(Signal(name, values, unit, "Y_Unit_Label" if unit else ""))
        channel += 1
    step = _first_number(header.get("delta_x"))
    if layout == "no" or not times or not np.isfinite(times[0].values).any():
        start = _first_number(header.get("x0")) or 0.0
        unique = unique_names([one.name for one in signals])
        named = tuple(
            Signal(name, one.values, one.unit, one.unit_from) for name, one in zip(unique, signals, strict=True)
        )
        return Group("", named, rows, step=step, start=start, step_from="Delta_X")
    every = [times[0], *signals]
    unique = unique_names([one.name for one in every])
    named = tuple(Signal(name, one.values, one.unit, one.unit_from) for name, one in zip(unique, every, strict=True))
    return Group("", named, rows, time=named[0].name)


def _first_number(texts: Sequence[str] | None) -> float | None:
    return float(texts[0].replace(",", ".")) if texts and is_number(texts[0]) else None


def _joined(groups: Sequence[Group]) -> Group:
    if len(groups) == 1:
        return groups[0]
    signals = tuple(
        Signal(one.name, np.concatenate([group.signals[at].values for group in groups]), one.unit, one.unit_from)
        for at, one in enumerate(groups[0].signals)
    )
    first = groups[0]
    rows = np.concatenate([group.rows for group in groups])
    return Group(
        first.name, signals, rows, time=first.time, step=first.step, start=first.start, step_from=first.step_from
    )
