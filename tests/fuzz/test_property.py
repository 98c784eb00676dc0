"""The property notices what breaks it, and holds for what hypothesis makes of good inputs in a minute."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import Phase

from benchmarks.fuzz import doors
from benchmarks.fuzz.doors import Broken, Outcome, outcome
from benchmarks.fuzz.properties import property_of
from harness.errors import HarnessError, InputError

NUMBER = {"csv": 300, "rig": 400, "diagnosis": 150, "effects": 200, "options": 250}
NUMBER |= {"import": 150, "sweep": 150, "settings": 200, "mjcf": 60, "urdf": 60}
"""Of inputs: each takes some ten seconds."""


@pytest.mark.slow
@pytest.mark.parametrize("kind", NUMBER)
def test_whatever_comes_in_there_is_a_result_or_one_message(kind: str) -> None:
    """Try inputs that are the same in every run; `make fuzz` tries others."""
    seen: Counter[str] = Counter()
    phases = (Phase.generate, Phase.shrink)
    property_of(kind, seen, max_examples=NUMBER[kind], derandomize=True, phases=phases, database=None)()
    assert seen["result"]
    assert seen["refused"]


def raising(error: BaseException) -> Callable[[Path], Outcome]:
    """A door that raises."""

    def door(folder: Path) -> Outcome:
        raise error

    return door


def overwriting(folder: Path) -> Outcome:
    """A door that changes what it reads."""
    (folder / "a.csv").write_text("other", encoding="utf-8")
    return Outcome(0)


def forgetting(folder: Path) -> Outcome:
    """A door that leaves work behind."""
    (folder / ".unfinished-1").mkdir()
    return Outcome(0)


@pytest.mark.parametrize(
    ("door", "what"),
    [
        (raising(ValueError("x")), "ValueError: x"),
        (raising(SystemExit(0)), "SystemExit"),
        (raising(HarnessError("")), "no line or several"),
        (overwriting, "has been changed"),
        (forgetting, "leaves .unfinished-1 behind"),
    ],
)
def test_what_is_neither_result_nor_message_is_noticed(door: Callable[[Path], Outcome], what: str) -> None:
    """Raise `Broken` with what came out."""
    with pytest.raises(Broken, match=what):
        outcome(door, {"a.csv": b"1"})


def test_a_door_that_does_not_end_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Raise `Broken` where the time is over."""
    monkeypatch.setattr(doors, "LONGEST", 0.2)

    def endless(folder: Path) -> Outcome:
        while time.monotonic() > 0.0:
            pass
        return Outcome(0)

    with pytest.raises(Broken, match="takes more than"):
        outcome(endless, {})


def test_a_message_is_an_outcome() -> None:
    """Take a `HarnessError` with its exit code, and its message without the folder."""
    assert outcome(raising(InputError("a.csv: bad")), {}) == Outcome(2, "a.csv: bad")
