"""Preambles of oscilloscopes: `Record Length`, `Sample Interval`, `Start`, `Increment`, in rows or beside the data."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from harness.importing.cells import is_number
from harness.importing.grid import Rows

# What instruments call the sampling interval; the value is in seconds, whatever the samples' unit.
_INTERVALS = (
    "sample interval", "sampling interval", "sample period", "sampling period", "increment", "xincrement",
    "x increment", "hresolution", "horizontal interval", "delta t", "dt", "tdelta", "tinc",
)  # fmt: skip
_RATES = ("sample rate", "sampling rate", "sampling frequency", "samplerate", "abtastrate", "fs")
_STARTS = ("start", "xorigin", "x origin", "first point", "trigger offset", "t0")
_MAKERS = {
    "rigol": "Rigol", "tektronix": "Tektronix", "keysight": "Keysight", "agilent": "Agilent", "siglent": "Siglent",
    "lecroy": "LeCroy", "rohde": "Rohde & Schwarz", "yokogawa": "Yokogawa", "hantek": "Hantek",
}  # fmt: skip
_SIDE = 3  # columns that Tektronix puts before time and voltage, for the preamble
_UNIT = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "hz": 1.0, "khz": 1e3, "mhz": 1e6, "sa/s": 1.0, "ksa/s": 1e3}


@dataclass(frozen=True)
class Preamble:
    """What the preamble says.

    Attributes:
        entries: text by key in lower case.
        cells: all cells behind the key, likewise, such as those of several channels.
        increment: sampling interval [s]; `None` if it says none.
        increment_from: the key that says it.
        start: time of the first sample [s]; `None` if it says none.
        words: all of it in one text.
    """

    entries: Mapping[str, str]
    cells: Mapping[str, Sequence[str]]
    increment: float | None
    increment_from: str
    start: float | None
    words: str

    def text(self, key: str) -> str:
        """The text of an entry, empty if there is none."""
        return self.entries.get(key, "")


def without_side_preamble(rows: Rows) -> tuple[Rows, tuple[list[str], ...]]:
    """Separates a preamble that stands beside the data: on the left (Tektronix), or right of the names (Rigol)."""
    if not rows or len(rows) < 3:
        return rows, ()
    first = rows[0][1]
    keys = {cell.casefold(): at for at, cell in enumerate(first)}
    if {"start", "increment"} <= set(keys):  # Rigol writes them behind the names, with their values below
        width = keys["start"]
        return [(row, cells[:width]) for row, cells in rows], (first[width:], rows[1][1][width:])
    behind = next((at for at, cell in enumerate(first) if re.match(r"t0\s*=", cell, re.IGNORECASE)), None)
    if behind:  # Rigol's DHO series writes `t0 = …` and `tInc = …` behind the names
        side = tuple([cell] for cell in first[behind:] if cell)
        return [(rows[0][0], first[:behind]), *rows[1:]], side
    beside = len(first) > _SIDE + 1 and first[0].casefold().startswith("record length")
    if not beside or not all(map(is_number, first[_SIDE : _SIDE + 2])):
        return rows, ()
    side = tuple([cell for cell in cells[:_SIDE] if cell] for _, cells in rows if any(cells[:_SIDE]))
    return [(row, cells[_SIDE : _SIDE + 2]) for row, cells in rows if len(cells) > _SIDE + 1], side


def preamble_of(rows: Sequence[Sequence[str]]) -> Preamble:
    """What rows above or beside the data say, as keys with values or as a row of keys above a row of values."""
    entries: dict[str, str] = {}
    behind: dict[str, Sequence[str]] = {}
    for cells in rows:
        filled = [cell.strip() for cell in cells if cell.strip()]
        if len(filled) == 1 and re.search(r"[:=]", filled[0]):
            filled = [one.strip() for one in re.split(r"[:=]", filled[0], maxsplit=1)]
        if len(filled) >= 2:
            key = filled[0].casefold().strip(' :"=')
            entries.setdefault(key, filled[1])
            behind.setdefault(key, filled[1:])
    for cell in (cell for cells in rows for cell in cells):  # within a row: `… 16:05:25, Sampling Period : 50 ms`
        said = re.fullmatch(r"\s*(.+?)\s*[:=]\s*(.+?)\s*", cell)
        if said and said[1].casefold() in {*_INTERVALS, *_RATES}:
            entries.setdefault(said[1].casefold(), said[2])
    for above, below in itertools.pairwise(rows):  # Rigol: X,CH1,Start,Increment
        for name, value in zip(above, below, strict=False):
            if name.strip().casefold() in {*_STARTS, *_INTERVALS} and is_number(value.strip()):
                entries[name.strip().casefold()] = value.strip()
    increment, key = _first(entries, _INTERVALS)
    if increment is None:
        rate, key = _first(entries, _RATES)
        increment = 1.0 / rate if rate else None
    start, _ = _first(entries, _STARTS)
    words = " ".join(cell for cells in rows for cell in cells)
    return Preamble(entries, behind, increment if increment and increment > 0.0 else None, key, start, words)


def instrument(preamble: Preamble, names: Sequence[str]) -> str:
    """What wrote the file, in words."""
    for word, maker in _MAKERS.items():
        if word in preamble.words.casefold():
            return f"text of an oscilloscope ({maker})"
    scope = {"record length", "vertical scale", "vertical units", "probe attenuation"} & set(preamble.entries)
    if scope or any(re.fullmatch(r"(CH|C|Channel )\s?[1-8A-D](\b.*)?", name, re.IGNORECASE) for name in names):
        return "text of an oscilloscope"
    return "text"


def _first(entries: Mapping[str, str], keys: Sequence[str]) -> tuple[float | None, str]:
    for key, text in entries.items():
        bare = re.sub(r"\s*[\[(].*?[\])]", "", key).strip()
        if bare not in keys and key not in keys:
            continue
        found = re.fullmatch(r"([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*([A-Za-zµ/]*)", text.strip())
        unit = re.search(r"[\[(](.*?)[\])]", key)
        written = (found[2] if found and found[2] else unit[1] if unit else "").replace("µ", "u").casefold()
        if found and re.fullmatch(r"[-+]?[1-9]\d{0,2}(,\d{3})+", found[1]):
            continue  # `1,000 Hz` is 1 Hz or 1000 Hz
        if found and is_number(found[1]) and (not written or written in _UNIT):
            return float(found[1].replace(",", ".")) * _UNIT.get(written, 1.0), key
    return None, ""
