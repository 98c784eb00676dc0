"""Progress on stderr: a bar for a person, a line a step for a log."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from harness.progress import Progress, silent

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress as Bar


_LONGEST = 24 * 3600.0
"""Of what is done, from whose mean speed the time left is told [s]."""


@contextmanager
def shown(progress: bool | Progress) -> Iterator[Progress]:
    """A `Progress` that shows on stderr what is being done, for as long as the context lasts.

    On a terminal and in a notebook it is a bar, gone in the end; elsewhere a line a step. `False` shows nothing, and a
    `Progress` of one's own is passed on.
    """
    if not isinstance(progress, bool):
        yield progress
        return
    if not progress:
        yield silent
        return
    from rich.console import Console

    console = Console(stderr=True)
    if console.is_terminal or console.is_jupyter:
        with _bar(console) as bar:
            task = bar.add_task("", total=1.0)

            def renew(text: str, *, share: float | None = None) -> None:
                done = max(bar.tasks[task].completed, share or 0.0)  # nothing that is done becomes undone
                bar.update(task, description=text, completed=done, refresh=True)

            yield renew
    else:
        begin = time.monotonic()

        def write(text: str, *, share: float | None = None) -> None:
            line = f"[{time.monotonic() - begin:5.1f} s] {text}"
            console.print(line, markup=False, highlight=False, soft_wrap=True)

        yield write


def _bar(console: Console) -> Bar:
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar
    from rich.table import Column

    return Bar(
        TextColumn("{task.description}", markup=False, table_column=Column(ratio=1, no_wrap=True, overflow="ellipsis")),
        BarColumn(bar_width=24),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        speed_estimate_period=_LONGEST,  # else nothing is told of the time left in a step of more than half a minute
        auto_refresh=False,  # a thread that draws must not be forked (`harness.parallel`)
        transient=True,
        expand=True,
    )
