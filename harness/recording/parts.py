"""The parts of a recording between places across which no model can be run, each used as a recording of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording.sampling import too_short

SHIFTED = 0.25  # weight of readings behind an offset that stays, where the position has another origin
# Of a part that is used beside the main one: length [s] and usable positions; half of the main one's if that is less.
LEAST, FEWEST, SHARE = 2.0, 40, 0.5


@dataclass(frozen=True)
class Break:
    """Readings `first` to `last` − 1, across which no model can be run; none where rows are lost.

    Attributes:
        shifts: whether the position has another origin behind them.
    """

    first: int
    last: int
    shifts: bool = False


def parts_between(breaks: Sequence[Break], time: FloatArray, usable: NDArray[np.bool_]) -> tuple[slice, ...]:
    """The part that says most, then all others that say something, in order; all in one if every part is too short.

    Positions of one origin belong together: behind an offset that stays, or before it, no other part is used.

    Args:
        breaks: in any order; they may overlap.
        time: strictly increasing, shape (n,) [s].
        usable: positions that are known, no spikes and not set aside, shape (n,).
    """
    edges = [0, *(edge for span in _merged(breaks) for edge in span), len(time)]
    parts = [slice(first, last) for first, last in list(pairwise(edges))[::2]]
    shifts = [one.first for one in breaks if one.shifts]
    shifted = min(shifts, default=len(time))
    main = max(parts, key=lambda part: usable[part].sum() * (1.0 if part.stop <= shifted else SHIFTED))
    if too_short(time[main]):
        return (slice(0, len(time)),)

    def origin(part: slice) -> int:
        return sum(shift <= part.start for shift in shifts)

    others = [part for part in parts if part is not main and origin(part) == origin(main)]
    least = min(LEAST, SHARE * _length(time[main]))
    fewest = min(FEWEST, SHARE * int(usable[main].sum()))
    long = [one for one in others if not too_short(time[one]) and _length(time[one]) >= least]
    return (main, *(part for part in long if usable[part].sum() >= fewest))


def suffixes(parts: Sequence[slice]) -> list[tuple[slice, str]]:
    """The parts in order, each with what is added to the recording's name; nothing to that of the first one given."""
    ordered = sorted(parts, key=lambda part: part.start)
    return [(part, "" if part == parts[0] else f" (part {number})") for number, part in enumerate(ordered, start=1)]


def _length(time: FloatArray) -> float:
    return float(time[-1] - time[0])


def _merged(breaks: Sequence[Break]) -> list[tuple[int, int]]:
    merged: list[tuple[int, int]] = []
    for one in sorted(breaks, key=lambda one: (one.first, one.last)):
        if merged and one.first <= merged[-1][1]:
            merged[-1] = merged[-1][0], max(merged[-1][1], one.last)
        else:
            merged.append((one.first, one.last))
    return merged
