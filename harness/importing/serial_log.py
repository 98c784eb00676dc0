"""Logs of a serial port: labels in every line, as `x:-0.034,theta:3.41`, and the clock that a monitor writes before it.

That is what the plotter of the Arduino IDE draws, and what its monitor saves: `16:05:25.123 -> x:-0.034,theta:3.41`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from harness.importing.grid import FEWEST_ROWS, Rows
from harness.importing.signals import Group, Signal
from harness.importing.stamps import is_stamp, seconds
from harness.importing.words import read_name

_CLOCK = re.compile(r"\s*(\S+)\s*->\s?(.*)")
_VALUE = r"[+\-−]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?|nan|[+-]?inf"
_PAIR = re.compile(rf"\s*([^\W\d][^:=]*?)\s*[:=]\s*({_VALUE})\s*([^\s\d:=]*)\s*", re.IGNORECASE)
_PAIR_AND_BLANK = re.compile(
    rf"\s*([^\W\d][^\s:=]*)\s*[:=]\s*({_VALUE})(?=\s|$)(?:[ \t]+((?!\S*[:=])[^\s\d]\S*)(?=\s|$))?", re.IGNORECASE
)
_LOOKED_AT = 400  # lines, to see what a file is
_FEWEST_LABELS = 2  # in a line: one alone is a preamble's entry as often
RECEIVED = "received"
"""Name of the times that a monitor writes."""

Clock = Mapping[int, str]
"""Clock time by line number."""


def without_clock(lines: Sequence[str]) -> tuple[list[str], Clock]:
    """The lines without a monitor's clock time before them, and these; none where most lines have none."""
    filled = [(number, line.rstrip("\r")) for number, line in enumerate(lines, start=1) if line.strip()]
    if not _mostly(filled, lambda line: _clocked(line) is not None):
        return list(lines), {}
    clocks = {number: one for number, line in filled if (one := _clocked(line))}
    bare = [clocks[number][2] if number in clocks else line for number, line in enumerate(lines, start=1)]
    return bare, {number: one[1] for number, one in clocks.items()}


def with_received(group: Group, clock: Clock) -> Group:
    """The group with the times at which its rows were received, where it tells no others."""
    if not clock or group.time is not None or group.step is not None:
        return group
    if any(read_name(one.name).kind == "time" for one in group.signals):
        return group
    times = seconds([clock.get(int(row), "") for row in group.rows])
    if times is None:
        return group
    received = Signal(RECEIVED, times, "s", "the serial monitor's clock")
    return replace(group, signals=(*group.signals, received), time=RECEIVED)


def labelled_rows(lines: Sequence[str]) -> tuple[Rows, tuple[str, ...]] | None:
    """Row numbers and cells of lines of labels and values, below a row of the labels, and notes; `None` if it is none.

    Labels that a line does not have are blank in it. Lines without labels, such as those with which a program begins,
    are left out.
    """
    filled = [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]
    if not _mostly(filled, lambda line: _pairs(line) is not None):
        return None
    told = [(number, one) for number, line in filled if (one := _pairs(line)) is not None]
    if len(told) < FEWEST_ROWS:
        return None
    units: dict[str, str] = {}
    for _, line_pairs in told:
        for label, (_, unit) in line_pairs.items():
            units[label] = units.get(label) or unit
    names = [f"{label} [{unit}]" if unit else label for label, unit in units.items()]
    rows = [(number, [one[label][0] if label in one else "" for label in units]) for number, one in told]
    others = len(filled) - len(told)
    notes = (f"{others} line{'s' if others > 1 else ''} without labels left out",) if others else ()
    return [(told[0][0], names), *rows], notes


def _mostly(filled: Sequence[tuple[int, str]], kind: Callable[[str], bool]) -> bool:
    """Whether most of the first lines are of a kind; a long table is not looked through for what it is not."""
    first = filled[:_LOOKED_AT]
    return 2 * sum(kind(line) for _, line in first) > len(first)


def _clocked(line: str) -> re.Match[str] | None:
    """Clock time and text of a line that a monitor saved."""
    found = _CLOCK.fullmatch(line)
    return found if found and is_stamp(found[1]) else None


def _pairs(line: str) -> dict[str, tuple[str, str]] | None:
    """Value and unit by label, `None` where a line holds anything else."""
    mark = next((one for one in (";", "\t", ",") if one in line), None)
    if mark is None:
        found = list(_PAIR_AND_BLANK.finditer(line))
        whole = "".join(one[0] for one in found).strip() == line.strip()
        matches = found if whole else []
    else:
        pieces = [_PAIR.fullmatch(piece) for piece in line.split(mark) if piece.strip()]
        matches = [one for one in pieces if one is not None]
        if len(matches) < len(pieces):
            return None
    made = {one[1]: (one[2], one[3] or "") for one in matches}
    return made if len(made) >= _FEWEST_LABELS else None
