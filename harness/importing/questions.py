"""What cannot be told is asked together, so that whoever is not at a terminal answers in one go."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

from harness.importing.choices import Ambiguity

T = TypeVar("T")


class Questions:
    """Collects ambiguities that do not depend on each other.

    Attributes:
        path: of the file that they are about.
        notes: what was left out when it was read, which may be what is missed.
    """

    def __init__(self, path: Path, notes: Sequence[str] = ()) -> None:
        self.path = path
        self.notes = tuple(notes)
        self._open: list[Ambiguity] = []

    def answer(self, find: Callable[[], T]) -> T | None:
        """What the function returns; `None` if it raises an `Ambiguity`, which is kept."""
        try:
            return find()
        except Ambiguity as ambiguity:
            self._open.append(ambiguity)
            return None

    def settle(self) -> None:
        """Ask what is open.

        Raises:
            Ambiguity: the first one, whose message goes on with the others.
        """
        if not self._open:
            return
        first, *others = self._open
        besides = [f"Besides, {str(one).removeprefix(f'{self.path}: ')}" for one in others]
        also = " ".join((*besides, *(f"Note: {note}." for note in self.notes)))
        raise Ambiguity(first.question, first.choices, first.advice, first.role, also)
