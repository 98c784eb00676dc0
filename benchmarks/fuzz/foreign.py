"""Recordings of other programs and instruments: good ones with bytes, cells or members of an archive changed."""

from __future__ import annotations

import io
import zipfile

from hypothesis import strategies as st

from benchmarks.fuzz import strange
from benchmarks.fuzz.doors import seed

TEXTS = ("scope.csv", "log.lvm", "free.txt", "monitor.txt", "records.jsonl", "lists.json")
BINARIES = ("vectors.mat", "hdf5.mat", "logsout.mat", "log.parquet")
BOOK = "book.xlsx"
_CELLS = (
    '<c r="XFD1048576"><v>1</v></c>',
    '<c r="B2" t="s"><v>99999</v></c>',
    '<c r="B2" t="d"><v>2024-02-30</v></c>',
    '<c r="B2" t="e"><v>#DIV/0!</v></c>',
    '<c r="B2"><f>1/0</f></c>',
    '<c r="B2" t="n"><v>1e999</v></c>',
    '<c r="??"><v>1</v></c>',
    '<c t="b"><v>7</v></c>',
    '<dimension ref="A1:XFD1048576"/>',
    "<!-- -->",
    "&laughs;",
)


def with_member(book: bytes, name: str, content: bytes) -> bytes:
    """The archive with another content of one of its members; stamps are fixed, so that it is the same every time."""
    made = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(book)) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for one in old.namelist():
            entry = zipfile.ZipInfo(one, (2024, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            new.writestr(entry, content if one == name else old.read(one))
    return made.getvalue()


@st.composite
def foreign_files(draw: st.DrawFn) -> bytes:
    """Bytes of a changed file; its format is told by its bytes."""
    name = draw(st.sampled_from((*TEXTS, *BINARIES, BOOK)))
    raw = seed(name)
    if name in TEXTS:
        return draw(strange.edited(draw(_with_cells(raw)), most=2))
    if name == BOOK and draw(st.integers(0, 4)):
        return draw(_with_cells_of_a_sheet(raw))
    return draw(strange.edited(raw, most=3))


@st.composite
def _with_cells(draw: st.DrawFn, raw: bytes) -> bytes:
    """Cells and lines of a text changed."""
    lines = raw.decode().splitlines()
    for _ in range(draw(st.integers(0, 4))):
        first = draw(st.integers(0, len(lines) - 1))
        # Half of the changes concern the head, which is short.
        at = first % 30 if draw(st.booleans()) else first
        separator = "\t" if "\t" in lines[at] else ","
        cells = lines[at].split(separator)
        cell = draw(st.integers(0, len(cells) - 1))
        kind = draw(st.sampled_from(("number", "text", "header", "delete", "repeat", "line", "drop")))
        if kind in ("number", "text", "header"):
            cells[cell] = draw({"number": strange.numbers, "text": strange.texts, "header": strange.headers}[kind])
        elif kind == "delete":
            del cells[cell]
        elif kind == "repeat":
            cells += [cells[cell]] * draw(st.integers(1, 3))
        lines[at] = separator.join(cells)
        if kind == "line":
            lines[at:at] = lines[at : at + draw(st.integers(1, 40))]
        elif kind == "drop":
            del lines[at + 1 : at + draw(st.integers(1, 40))]
    return "\n".join(lines).encode("utf-8", errors="replace")


@st.composite
def _with_cells_of_a_sheet(draw: st.DrawFn, raw: bytes) -> bytes:
    """A member of a workbook changed within its archive, whose checksums are right."""
    with zipfile.ZipFile(io.BytesIO(raw)) as book:
        names = [one for one in book.namelist() if one.endswith((".xml", ".rels"))]
        sheet = next(one for one in names if "worksheets/" in one)
        name = draw(st.sampled_from((*[sheet] * len(names), *names)))
        content = book.read(name)
    if draw(st.booleans()):
        at = content.find(b"<c ", int(draw(st.floats(0.0, 1.0)) * len(content)))
        at = max(at, content.find(b"<c "), 0)
        content = content[:at] + draw(st.sampled_from(_CELLS)).encode() + content[at:]
    return with_member(raw, name, draw(strange.edited(content, most=2)))
