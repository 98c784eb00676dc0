"""Progress of long work: a text, and the share of the work that is done."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import count
from typing import Protocol


class Progress(Protocol):
    """Receiver of progress texts, one short line each, possibly from several threads."""

    def __call__(self, text: str, *, share: float | None = None) -> None:
        """Receive a text and the share of the work that is done, 0 to 1, or `None` if it is unknown."""
        ...


def silent(text: str, *, share: float | None = None) -> None:
    """A `Progress` that discards every text."""


@dataclass(frozen=True)
class Stage:
    """A `Progress` for one stage of the work, from share `begin` to share `end` of the whole.

    The n-th text without a share is placed at 1 − exp(−n/steps) of the stage, so that any number of texts stays in it.
    """

    progress: Progress
    begin: float
    end: float
    steps: float
    _texts: count[int] = field(default_factory=lambda: count(0))

    def __call__(self, text: str, *, share: float | None = None) -> None:
        """Pass the text on with the share of the whole."""
        if share is None:
            share = -math.expm1(-next(self._texts) / self.steps)
        self.progress(text, share=self.begin + (self.end - self.begin) * share)
