"""Horizons: the whole recording, and windows of a few seconds in each of which every source starts anew."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.metrics import horizon_name


@dataclass(frozen=True)
class Horizon:
    """Where runs begin and end.

    Attributes:
        seconds: length of the windows, `None` for the whole recording [s].
        first, last: stamps at which each run begins and ends, shape (runs,).
    """

    seconds: float | None
    first: NDArray[np.int64]
    last: NDArray[np.int64]

    @property
    def name(self) -> str:
        """As in metrics.csv."""
        return horizon_name(self.seconds)

    def slices(self) -> list[slice]:
        """The stamps of each run."""
        return [slice(int(f), int(e) + 1) for f, e in zip(self.first, self.last, strict=True)]


def horizons(time: FloatArray, known: NDArray[np.bool_], lengths: Sequence[float]) -> list[Horizon]:
    """The whole recording from its first known position, and adjoining windows of each length [s], shortest first.

    A window that is cut short by the end, or of which less than half of the positions are known, is left out; so is
    a length of which no window remains.

    Args:
        time: stamps, shape (n,) [s].
        known: where the position is known, shape (n,).
    """
    begin = int(np.argmax(known))
    found = [Horizon(None, np.array([begin]), np.array([len(time) - 1]))]
    for length in sorted(set(lengths)):
        # Half a stamp of slack: a recording of 16 s holds eight windows of 2 s although its last stamp is 15.99 s.
        slack = 0.5 * float(np.median(np.diff(time)))
        count = int((time[-1] - time[begin] + 2 * slack) / length + 1e-9)
        edges = time[begin] + length * np.arange(count + 1)
        marks = np.searchsorted(time, edges - slack).clip(max=len(time) - 1)
        pairs = [(f, e) for f, e in itertools.pairwise(marks) if _measured(known[f : e + 1])]
        if pairs:
            first, last = np.array(pairs).T
            found.append(Horizon(length, first, last))
    return found


def _measured(known: NDArray[np.bool_]) -> bool:
    return len(known) > 2 and float(np.mean(known)) >= 0.5
