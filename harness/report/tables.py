"""Tables as data: the unit in the head, numbers to the right; one template macro prints them all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup


@dataclass(frozen=True)
class Column:
    """Head of a column.

    Attributes:
        head: as printed.
        unit: under it; empty for texts and numbers without one.
        text: whether its cells are texts, hence to the left.
        apart: whether a line sets it and what follows apart.
        hint: shown when the pointer rests on it.
    """

    head: str | Markup
    unit: str = ""
    text: bool = False
    apart: bool = False
    hint: str = ""

    @property
    def classes(self) -> str:
        """Of its cells, for style.css."""
        return " ".join(name for name in ("text", "apart") if getattr(self, name))


@dataclass(frozen=True)
class Row:
    """Cells, ready to print, and what sets the row apart: `best`, `failed`, `apart` … (classes of style.css)."""

    cells: tuple[str | Markup, ...]
    kind: str = ""


@dataclass(frozen=True)
class Table:
    """What the macro `table` prints.

    Raises:
        ValueError: a row has not as many cells as there are columns.
    """

    caption: str | Markup
    columns: Sequence[Column]
    rows: Sequence[Row]

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row.cells) != len(self.columns):
                raise ValueError(f"{self.caption}: {len(row.cells)} cells in a table of {len(self.columns)} columns")
