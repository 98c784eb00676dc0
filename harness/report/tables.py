"""Tables as data, rendered by one template macro."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup


@dataclass(frozen=True)
class Column:
    """A table column.

    Attributes:
        head: heading.
        unit: printed below it; empty if there is none.
        text: whether its cells are text, aligned left.
        apart: whether a line separates it from the columns before.
        hint: tooltip of the heading.
    """

    head: str | Markup
    unit: str = ""
    text: bool = False
    apart: bool = False
    hint: str = ""

    @property
    def classes(self) -> str:
        """CSS classes of its cells."""
        return " ".join(name for name in ("text", "apart") if getattr(self, name))


@dataclass(frozen=True)
class Row:
    """Formatted cells, and the CSS class of the row: `best`, `failed`, `apart` …"""

    cells: tuple[str | Markup, ...]
    kind: str = ""


@dataclass(frozen=True)
class Table:
    """A table, printed by the macro `table`.

    Raises:
        ValueError: a row has a different number of cells than columns.
    """

    caption: str | Markup
    columns: Sequence[Column]
    rows: Sequence[Row]

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row.cells) != len(self.columns):
                raise ValueError(f"{self.caption}: {len(row.cells)} cells in a table of {len(self.columns)} columns")
