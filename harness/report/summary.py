"""A result in short, for an interpreter and for a notebook: a title, a few lines, tables."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from harness.report.tables import Table

_WIDTH = 110  # of the text form


@dataclass(frozen=True)
class Summary:
    """What is shown.

    Attributes:
        title: what it is of.
        lines: sentences below it.
        tables: in their order.
    """

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

    def html(self) -> str:
        """For a notebook; nothing has to be loaded."""
        from harness.report.page import environment

        return environment().get_template("summary.html").render(title=self.title, lines=self.lines, tables=self.tables)


class Summarised(ABC):
    """Shows itself by its `summary` in an interpreter and in a notebook."""

    @abstractmethod
    def summary(self) -> Summary:
        """The result in short."""

    def __repr__(self) -> str:
        return self.summary().text()

    def _repr_html_(self) -> str:
        return self.summary().html()
