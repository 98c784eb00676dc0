"""Messages are one line of plain characters, whatever is quoted in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.errors import InputError
from harness.recording import load_recording
from tests.acceptance.conftest import Harness


def test_a_message_is_one_line() -> None:
    """Escape what ends a line or commands a terminal, and leave letters of all scripts."""
    assert str(InputError("α = 1\u00a0°, 日本")) == "α = 1\u00a0°, 日本"
    assert str(InputError("a\nb\x1b[31m\u2028\x85\u202e")) == r"a\nb\x1b[31m\u2028\x85\u202e"


def test_a_file_cannot_write_to_the_terminal(tmp_path: Path) -> None:
    """Quote a header's control characters escaped."""
    file = tmp_path / "rec.csv"
    file.write_text("time_s\x0b\x1b[2J\n1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"'time_s\\x0b\\x1b\[2J'"):
        load_recording(file)


@pytest.mark.parametrize("words", [("run", "a", "b\x85c"), ("run", "--engine", "b\x85c"), ("predict", "b\x85c", "d")])
def test_an_argument_cannot_write_to_the_terminal(harness: Harness, words: tuple[str, ...]) -> None:
    """Quote an argument's control characters escaped, and end with 2."""
    done = harness(*words)
    assert done.code == 2
    assert r"b\x85c" in done.err
