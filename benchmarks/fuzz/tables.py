"""Recordings: a good one with its header, cells, rows and columns changed, written in one of many dialects."""

from __future__ import annotations

import codecs

from hypothesis import strategies as st

from benchmarks.fuzz import strange
from benchmarks.fuzz.doors import CSV, seed

Cells = list[list[str]]
"""Header and rows."""
_ENCODINGS = ("utf-8", "utf-8-sig", "cp1252", "latin-1", "utf-16", "utf-16-le", "utf-32", "utf-7", "cp037")
_SEPARATORS = (",", ";", "\t", " ", "|", ", ", ",,")
_LINE_ENDS = ("\n", "\r\n", "\r", "\n\n", "\x0b", "\u2028")
_FACTORS = (0.0, -1.0, 1e-320, 1e-9, 1e-3, 1.2, 57.3, 1e3, 1e9, 1e19, 1e300)


def good() -> Cells:
    """The seed."""
    return [line.split(",") for line in seed(CSV).decode().splitlines()]


@st.composite
def csv_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed recording."""
    cells = good()
    cells = cells[: 1 + draw(st.sampled_from((len(cells), len(cells), 60, 3, 2, 1, 0)))]
    for _ in range(draw(st.integers(0, 4))):
        cells = draw(_changed(cells))
    return draw(strange.edited(draw(_written(cells)), most=2))


@st.composite
def _changed(draw: st.DrawFn, cells: Cells) -> Cells:
    """One change."""
    cells = [list(row) for row in cells]
    width = max(map(len, cells), default=0)
    row, column = draw(st.integers(0, max(len(cells) - 1, 0))), draw(st.integers(0, max(width - 1, 0)))
    other = draw(st.integers(0, max(len(cells) - 1, 0)))
    first, last = sorted((row, other))
    kind = draw(st.sampled_from(_CHANGES))
    if not cells or column >= len(cells[row]):
        return cells
    if kind == "header" and cells[0]:
        cells[0][min(column, len(cells[0]) - 1)] = draw(strange.headers)
    elif kind == "number":
        cells[row][column] = draw(strange.numbers)
    elif kind == "text":
        cells[row][column] = draw(strange.texts)
    elif kind == "stretch":
        value = draw(strange.numbers)
        for one in cells[max(first, 1) : last + 1]:
            one[column : column + 1] = [value]
    elif kind == "factor":
        factor, shift = draw(st.sampled_from(_FACTORS)), draw(st.sampled_from((0.0, 0.0, 1e3, 1e10, 1.7e18)))
        for one in cells[1:]:
            one[column : column + 1] = [_times(cell, factor, shift) for cell in one[column : column + 1]]
    elif kind == "duplicate":
        cells[first:first] = cells[first : first + draw(st.integers(1, 5))]
    elif kind == "delete":
        del cells[first:last]
    elif kind == "reverse":
        cells[first:last] = cells[first:last][::-1]
    elif kind == "swap":
        cells[row], cells[other] = cells[other], cells[row]
    elif kind == "shorten":
        cells[row] = cells[row][:column]
    elif kind == "lengthen":
        cells[row] += [draw(strange.numbers)] * draw(st.integers(1, 3))
    elif kind == "drop column":
        cells = [one[:column] + one[column + 1 :] for one in cells]
    elif kind == "add column":
        head, value = draw(strange.headers), draw(strange.numbers)
        cells = [[*one, value if at else head] for at, one in enumerate(cells)]
    elif kind == "repeat column":
        cells = [[*one, *one[column : column + 1]] for one in cells]
    elif kind == "same stamps":
        cells = [
            [*cells[min(first, len(cells) - 1)][:1], *one[1:]] if first < at <= last else one
            for at, one in enumerate(cells)
        ]
    elif kind == "comment":
        cells.insert(row, ["# " + draw(strange.texts)])
    return cells


_CHANGES = (
    *("header", "number", "text", "stretch", "factor", "duplicate", "delete", "reverse", "swap", "shorten"),
    *("lengthen", "drop column", "add column", "repeat column", "same stamps", "comment"),
)


def _times(cell: str, factor: float, shift: float) -> str:
    try:
        return repr(factor * float(cell) + shift)
    except (ValueError, OverflowError):
        return cell


@st.composite
def _written(draw: st.DrawFn, cells: Cells) -> bytes:
    """The cells as text, in a dialect; mostly a usual one, so that what is behind the reader is met too."""
    usual = draw(st.booleans())
    separator = "," if usual else draw(st.sampled_from(_SEPARATORS))
    end = "\n" if usual else draw(st.sampled_from(_LINE_ENDS))
    rows = cells
    if not usual and draw(st.booleans()):
        rows = [[cell.replace(".", ",") for cell in row] for row in rows]
    if not usual and draw(st.booleans()):
        rows = [[f'"{cell}"' for cell in row] for row in rows]
    text = end.join(separator.join(row) for row in rows) + draw(st.sampled_from(("", end)))
    if not usual and draw(st.booleans()):
        text = f"sep={separator}{end}{text}"
    encoding = "utf-8" if usual else draw(st.sampled_from(_ENCODINGS))
    return codecs.encode(text, encoding, errors="replace" if encoding != "utf-7" else "ignore")
