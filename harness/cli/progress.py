"""Progress on stderr: a line that renews itself for a person, a line a step for a log."""

from __future__ import annotations

import time
from collections.abc import Callable

import click
from rich.console import Console


def told_on_stderr() -> Callable[[str], None]:
    """A function to be told what is being done; an empty text ends the line, and so does the end of the command."""
    console = Console(stderr=True)
    begin = time.monotonic()

    def tell(text: str) -> None:
        line = f"[{time.monotonic() - begin:5.1f} s] {text}" if text else ""
        if console.is_terminal:
            console.print(line.ljust(console.width - 1), end="\r", markup=False, highlight=False, overflow="crop")
        elif text:
            console.print(line, markup=False, highlight=False, soft_wrap=True)

    context = click.get_current_context(silent=True)
    if context is not None:  # an error's message must not stand on what is left of the line
        context.call_on_close(lambda: tell(""))
    return tell
