"""LabVIEW measurement files (.lvm): header blocks that end with `***End_of_Header***`, then X and Y columns.

The layout is in National Instruments' "Specification for the LabVIEW Measurement File (.lvm)".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from analytic.motion import FloatArray
from harness.errors import InputError
from harness.importing.cells import is_number, numbers
from harness.importing.signals import Group, Signal, SourceFile, unique_names
from harness.importing.stamps import seconds
from harness.recording.findings import place

END = "***end_of_header***"
_SEPARATORS = {"tab": "\t", "comma": ",", "semicolon": ";"}


def is_labview(lines: Sequence[str]) -> bool:
    """Whether these are the lines of such a file."""
    return any(line.strip().casefold().startswith(END) for line in lines[:200])


def read(path: Path, sha256: str, lines: Sequence[str]) -> SourceFile:
    """Reads all segments; segments with the same channels follow each other in one group.

    Where each channel has an X column of its own (`X_Columns Multi`), each is a group of its own.

    Raises:
        InputError: the file has no data, a cell that is not a number, or segments whose times cannot be told.
    """
    header = _entries(lines[: _ends(lines)[0]], "\t")
    separator = _SEPARATORS.get((header.get("separator") or ["tab"])[0].casefold(), "\t")
    header = _entries(lines[: _ends(lines)[0]], separator)
    layout = (header.get("x_columns") or ["One"])[0].casefold()
    segments = _segments(path, lines, separator, layout)
    if not segments:
        raise InputError(f"{path}: a LabVIEW file without data below its header. Check that it was saved completely.")
    notes: tuple[str, ...] = ()
    names = [_names(one) for one in segments]
    same = [one for one, of_it in zip(segments, names, strict=True) if of_it == names[0]]
    if len(segments) > 1:
        notes = (f"{len(segments)} segments, of which {len(same)} with the same channels were joined",)
    starts = partial(_starts, path, same)
    groups = tuple(_joined(path, [one.groups[at] for one in same], starts) for at in range(len(same[0].groups)))
    return SourceFile(path, sha256, f"LabVIEW measurement file ({layout} X column)", groups, notes)


@dataclass(frozen=True, eq=False)
class _Segment:
    """What stands below one header.

    Attributes:
        row: of its header's end.
        groups: one, or one a channel.
        header: its entries, and those of the file where it has none.
    """

    row: int
    groups: tuple[Group, ...]
    header: Mapping[str, list[str]]


def _names(segment: _Segment) -> list[str]:
    return [signal.name for group in segment.groups for signal in group.signals]


def _ends(lines: Sequence[str]) -> list[int]:
    return [number for number, line in enumerate(lines) if line.strip().casefold().startswith(END)]


def _entries(lines: Sequence[str], separator: str) -> Mapping[str, list[str]]:
    made: dict[str, list[str]] = {}
    for line in lines:
        key, *values = line.split(separator)
        if key.strip():
            made[key.strip().casefold()] = [value.strip() for value in values]
    return made


def _segments(path: Path, lines: Sequence[str], separator: str, layout: str) -> list[_Segment]:
    ends = _ends(lines)
    made: list[_Segment] = []
    begin = 0
    for number, end in enumerate(ends):
        header = _entries(lines[begin:end], separator)
        last = ends[number + 1] if number + 1 < len(ends) else len(lines)
        body = [(row, line) for row, line in enumerate(lines[end + 1 : last], start=end + 2) if line.strip()]
        # What follows the numbers is the header of the next segment.
        count = next((at for at, (_, line) in enumerate(body[1:]) if not _starts_with_number(line, separator)), None)
        stop = len(body) if count is None else count + 1
        if len(body) > 1 and stop > 1 and not _starts_with_number(body[0][1], separator):
            groups = _groups(path, header, body[0][1], body[1:stop], separator, layout)
            made.append(_Segment(end + 1, groups, header))
            begin = body[stop - 1][0]
        else:
            begin = end + 1
    return made


def _starts_with_number(line: str, separator: str) -> bool:
    cells = [cell.strip() for cell in line.split(separator)]
    return any(map(is_number, cells)) and (not cells[0] or is_number(cells[0]))


def _groups(
    path: Path, header: Mapping[str, list[str]], title: str, body: list[tuple[int, str]], separator: str, layout: str
) -> tuple[Group, ...]:
    names = [name.strip() for name in title.split(separator)]
    if names and names[-1].casefold() == "comment":
        names.pop()
    units = header.get("y_unit_label", [])
    dimension = (header.get("x_dimension") or ["Time"])[0]
    rows = np.array([row for row, _ in body])
    cells = [[cell.strip() for cell in line.split(separator)] for _, line in body]
    signals: list[Signal] = []
    times: list[Signal] = []
    pairs: list[Group] = []
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
        if layout == "multi" and times:  # its own X column stands before it; the shorter ones end in blanks
            here = np.isfinite(times[-1].values)
            pair = [replace(one, values=one.values[here]) for one in (times[-1], signals[-1])]
            pairs.append(Group("", tuple(pair), rows[here], time=pair[0].name))
    if len(times) > 1:
        return tuple(pairs)
    step = _first_number(header.get("delta_x"))
    if layout == "no" or not times or not np.isfinite(times[0].values).any():
        start = _first_number(header.get("x0")) or 0.0
        unique = unique_names([one.name for one in signals])
        named = tuple(
            Signal(name, one.values, one.unit, one.unit_from) for name, one in zip(unique, signals, strict=True)
        )
        return (Group("", named, rows, step=step, start=start, step_from="Delta_X"),)
    every = [times[0], *signals]
    unique = unique_names([one.name for one in every])
    named = tuple(Signal(name, one.values, one.unit, one.unit_from) for name, one in zip(unique, every, strict=True))
    return (Group("", named, rows, time=named[0].name),)


def _first_number(texts: Sequence[str] | None) -> float | None:
    return float(texts[0].replace(",", ".")) if texts and is_number(texts[0]) else None


def _starts(path: Path, segments: Sequence[_Segment]) -> FloatArray:
    """When each segment begins, counted from the first [s], shape (n,): by `X0`, or by `Date` and `Time`.

    Raises:
        InputError: both differ from segment to segment and contradict each other.
    """
    by_x = np.array([_first_number(one.header.get("x0")) or 0.0 for one in segments])
    by_x -= by_x[0]
    stamps = [" ".join((one.header.get(key) or [""])[0] for key in ("date", "time")) for one in segments]
    by_clock = seconds([stamp.strip() for stamp in stamps])
    if by_clock is None or not np.isfinite(by_clock).all() or not by_clock.any():
        return by_x
    if not by_x.any():
        return by_clock
    at = int(np.argmax(np.abs(by_x - by_clock)))
    if abs(by_x[at] - by_clock[at]) > (segments[0].groups[0].step or 0.0):
        raise InputError(
            f"{place(path, segments[at].row)}: by X0 this segment begins {by_x[at]:g} s after the first, by Date and "
            f"Time {by_clock[at]:g} s. Save the file with one X column, or each segment in a file of its own."
        )
    return by_x


def _joined(path: Path, groups: Sequence[Group], starts: Callable[[], FloatArray]) -> Group:
    """The rows of all segments; where no column holds the time, it goes on from the start of each.

    Raises:
        InputError: a segment begins before the one above it ends.
    """
    first = groups[0]
    if len(groups) == 1:
        return first
    signals = tuple(
        Signal(one.name, np.concatenate([group.signals[at].values for group in groups]), one.unit, one.unit_from)
        for at, one in enumerate(first.signals)
    )
    rows = np.concatenate([group.rows for group in groups])
    steps = [group.step for group in groups if group.step is not None]
    if first.time is not None or len(steps) < len(groups):
        return replace(first, signals=signals, rows=rows)
    parts = [
        first.start + start + step * np.arange(len(group.rows))
        for start, step, group in zip(starts(), steps, groups, strict=True)
    ]
    gaps = np.array(
        [after[0] - before[-1] - step for before, after, step in zip(parts, parts[1:], steps, strict=False)]
    )
    if np.any(gaps < -0.5 * steps[0]):
        at = int(np.argmax(gaps < -0.5 * steps[0])) + 1
        raise InputError(
            f"{place(path, int(groups[at].rows[0]))}: by X0, Date and Time this segment begins {-gaps[at - 1]:g} s "
            "before the one above ends. Save the file with one X column, or each segment in a file of its own."
        )
    if np.all(np.abs(gaps) <= 0.5 * steps[0]) and len(set(steps)) == 1:
        return replace(first, signals=signals, rows=rows)
    name = unique_names([*(one.name for one in signals), "X_Value"])[-1]
    time = Signal(name, np.concatenate(parts), "s", "X0 and Delta_X of each segment")
    return Group(first.name, (time, *signals), rows, time=name)
