"""Progress: one line that renews itself on a terminal and is gone in the end, a line a step elsewhere."""

from __future__ import annotations

import io

import click
import pytest
from click.testing import CliRunner
from rich.console import Console

import harness.cli.progress
from harness.cli.progress import told_on_stderr
from harness.errors import InputError

WIDTH = 60


def screen(text: str) -> list[str]:
    """What stands on a terminal after `text`, line by line: a carriage return goes back to the line's begin."""
    lines = []
    for written in text.split("\n"):
        line = ""
        for part in written.split("\r"):
            line = part + line[len(part) :]
        lines.append(line.rstrip())
    return lines


def watched(monkeypatch: pytest.MonkeyPatch, *, terminal: bool) -> io.StringIO:
    """Where progress goes instead of stderr."""
    out = io.StringIO()
    console = Console(file=out, force_terminal=terminal, width=WIDTH)
    monkeypatch.setattr(harness.cli.progress, "Console", lambda stderr: console)
    return out


def test_a_log_gets_a_whole_line_a_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write plain lines, however long, and nothing for the end."""
    out = watched(monkeypatch, terminal=False)
    tell = told_on_stderr()
    for text in ("drives", "x" * 2 * WIDTH, ""):
        tell(text)
    assert [line.partition("] ")[2] for line in out.getvalue().splitlines()] == ["drives", "x" * 2 * WIDTH]
    assert "\r" not in out.getvalue()


def test_a_terminal_shows_the_step_that_is_being_done(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace each step by the next, and leave an empty line in the end."""
    out = watched(monkeypatch, terminal=True)
    tell = told_on_stderr()
    tell("a long step, of which nothing may remain")
    tell("short")
    assert [line.partition("] ")[2] for line in screen(out.getvalue())] == ["short"]
    tell("")
    assert screen(out.getvalue()) == [""]


def test_an_error_leaves_no_step_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Clear the line where a command ends by an error, before anything is said of it."""
    out = watched(monkeypatch, terminal=True)

    @click.command()
    def work() -> None:
        told_on_stderr()("half done")
        raise InputError("bad")

    assert isinstance(CliRunner().invoke(work).exception, InputError)
    assert screen(out.getvalue()) == [""]
