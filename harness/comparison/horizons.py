"""Horizons: the whole recording as one free run, or windows of a few seconds with a restart at each."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.metrics import horizon_name

Value = TypeVar("Value", bound=np.generic)


@dataclass(frozen=True)
class Horizon:
    """The runs of one horizon: where each begins and ends.

    What is known of all of them stands in one row, one run after the other (`stamps`). Windows meet at a stamp, which
    is the last of one and the first of the next.

    Attributes:
        seconds: window length, `None` for the whole recording [s].
        first, last: indices of the first and last stamp of each run, shape (runs,).
    """

    seconds: float | None
    first: NDArray[np.int64]
    last: NDArray[np.int64]

    @property
    def name(self) -> str:
        """As in metrics.csv."""
        return horizon_name(self.seconds)

    def slices(self) -> list[slice]:
        """Stamps of each run, as slices."""
        return [slice(int(f), int(e) + 1) for f, e in zip(self.first, self.last, strict=True)]

    @cached_property
    def stamps(self) -> NDArray[np.int64]:
        """Indices of the stamps of one run after the other, shape (k,)."""
        return np.concatenate([np.arange(where.start, where.stop) for where in self.slices()])

    def pieces(self, values: NDArray[Value]) -> list[NDArray[Value]]:
        """Each run's share of `values` at `stamps`, shape (..., k): views of shape (..., stamps of the run)."""
        return np.split(values, np.cumsum(self.last - self.first + 1)[:-1], axis=-1)


def horizons(time: FloatArray, known: NDArray[np.bool_], lengths: Sequence[float]) -> list[Horizon]:
    """The whole recording from its first known position, then adjoining windows of each length [s], shortest first.

    Windows that are cut short by the end, or with less than half of their positions known, are omitted, as are lengths
    without any window.

    Args:
        time: stamps, shape (n,) [s].
        known: whether the position is known, shape (n,).
    """
    begin = int(np.argmax(known))
    found = [Horizon(None, np.array([begin]), np.array([len(time) - 1]))]
    for length in sorted(set(lengths)):
        # Tolerance of half a step: a recording of 16 s has eight windows of 2 s although its last stamp is 15.99 s.
        slack = 0.5 * float(np.median(np.diff(time)))
        count = int((time[-1] - time[begin] + 2 * slack) / length + 1e-9)
        edges = time[begin] + length * np.arange(count + 1)
        marks = np.searchsorted(time, edges - slack).clip(max=len(time) - 1)
        pairs = [(f, e) for f, e in itertools.pairwise(marks) if _sufficient(known[f : e + 1])]
        if pairs:
            first, last = np.array(pairs).T
            found.append(Horizon(length, first, last))
    return found


def _sufficient(known: NDArray[np.bool_]) -> bool:
    return len(known) > 2 and float(np.mean(known)) >= 0.5
