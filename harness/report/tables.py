"""Tables as data, and a result in short made of them: for a report, an interpreter and a notebook."""

import io
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from markupsafe import Markup

_WIDTH = 110  # of the text form


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


def texts(*heads: str) -> list[Column | str]:
    """Columns of text."""
    return [Column(head, text=True) for head in heads]


def _column(written: Column | str) -> Column:
    """A column of numbers written as `RMS error [mm]`."""
    if isinstance(written, Column):
        return written
    head, _, unit = written.partition(" [")
    return Column(head, unit.removesuffix("]"))


@dataclass(frozen=True)
class Row:
    """Formatted cells, and the CSS class of the row: `best`, `failed`, `apart` …"""

    cells: Sequence[str | Markup]
    kind: str = ""


class Table:
    """A table, printed by the macro `table`."""

    def __init__(
        self,
        caption: str | Markup,
        columns: Iterable[Column | str],
        rows: Iterable[Row | Sequence[str | Markup]],
    ) -> None:
        """Take columns, those of numbers also as `head [unit]`, and rows, those without a class also as their cells.

        Raises:
            ValueError: a row has a different number of cells than columns.
        """
        self.caption = caption
        self.columns = [_column(one) for one in columns]
        self.rows = [one if isinstance(one, Row) else Row(one) for one in rows]
        for row in self.rows:
            if len(row.cells) != len(self.columns):
                raise ValueError(f"{caption}: {len(row.cells)} cells in a table of {len(self.columns)} columns")


@dataclass(frozen=True)
class Summary:
    """A result in short: what it is of, sentences, tables."""

    title: str
    lines: Sequence[str]
    tables: Sequence[Table]

    def text(self) -> str:
        """For an interpreter."""
        from rich import box
        from rich.console import Console
        from rich.table import Table as Grid
        from rich.text import Text

        out = io.StringIO()
        console = Console(file=out, width=_WIDTH, force_jupyter=False, color_system=None)
        for line in (self.title, *self.lines):
            console.print(Text(line))
        for table in self.tables:
            console.print()
            grid = Grid(title=Text(str(table.caption)), title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
            for column in table.columns:
                head = f"{column.head} [{column.unit}]" if column.unit else str(column.head)
                grid.add_column(Text(head), justify="left" if column.text else "right")
            for row in table.rows:
                grid.add_row(*(Text(str(cell).replace("`", "")) for cell in row.cells))
            console.print(grid)
        return "\n".join(line.rstrip() for line in out.getvalue().rstrip().splitlines())


class Summarised(ABC):
    """Shows itself by its `summary` in an interpreter; in a notebook, also by the picture of its `plot`, if any."""

    @abstractmethod
    def summary(self) -> Summary:
        """The result in short."""

    def __repr__(self) -> str:
        return self.summary().text()

    def _repr_html_(self) -> str:
        from harness.report.notebook import notebook_html

        return notebook_html(self.summary(), getattr(self, "plot", None))
