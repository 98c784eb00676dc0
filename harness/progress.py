"""How long work tells what it is doing, and how much of it is done."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import count
from typing import Protocol


class Progress(Protocol):
    """Told what is being done, one short line at a time, perhaps from several threads."""

    def __call__(self, text: str, *, share: float | None = None) -> None:
        """Take a text, and the share of the work that is done, 0 to 1; `None` where it is not known."""
        ...


def silent(text: str, *, share: float | None = None) -> None:
    """Tell nobody."""


@dataclass(frozen=True)
class Stage:
    """One stage of the work, from share `begin` to share `end` of the whole, as a `Progress` of its own.

    A text that comes without a share moves on by one of about `steps`: the n-th one stands at 1 − exp(−n/steps) of the
    stage, which grows to the end of it however many there are.
    """

    progress: Progress
    begin: float
    end: float
    steps: float
    _told: count[int] = field(default_factory=lambda: count(0))

    def __call__(self, text: str, *, share: float | None = None) -> None:
        """Tell the share of the whole."""
        if share is None:
            share = -math.expm1(-next(self._told) / self.steps)
        self.progress(text, share=self.begin + (self.end - self.begin) * share)
