"""Two ways to the same result, timed one after the other again and again: what a busy machine adds, it adds to both."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median

Clock = Callable[[], float]


@dataclass(frozen=True)
class Pair:
    """Time of ours and of theirs [s], taken one directly after the other."""

    ours: float
    theirs: float

    @property
    def ratio(self) -> float:
        """Time of ours over that of theirs [1]."""
        return self.ours / self.theirs


@dataclass(frozen=True)
class Spread:
    """Median, and the quartiles beside it."""

    median: float
    low: float
    high: float


def pairs_of(
    ours: Callable[[], object], theirs: Callable[[], object], count: int, clock: Clock = time.process_time
) -> list[Pair]:
    """Time both `count` times, in turn which of them comes first; once before that is not counted.

    Args:
        ours, theirs: do the work.
        count: of pairs.
        clock: processor time of this process, or time on the wall where several threads are to be used at once [s].
    """
    ours(), theirs()
    pairs = []
    for number in range(count):
        first, second = (ours, theirs) if number % 2 else (theirs, ours)
        times = [_timed(first, clock), _timed(second, clock)]
        pairs.append(Pair(*(times if number % 2 else times[::-1])))
    return pairs


def spread(values: Sequence[float]) -> Spread:
    """Median and quartiles (the medians of the lower and the upper half, the middle value in both)."""
    ordered = sorted(values)
    half = (len(ordered) + 1) // 2
    return Spread(median(ordered), median(ordered[:half]), median(ordered[-half:]))


def _timed(work: Callable[[], object], clock: Clock) -> float:
    gc.collect()  # what the other one left is not this one's
    begin = clock()
    work()
    return clock() - begin
