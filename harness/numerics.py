"""Small numerical helpers that several packages share."""

from collections.abc import Sequence
from typing import TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike

from analytic.motion import FloatArray

T = TypeVar("T")

TWO_SIDED = 1.96  # half width of the 95 % interval of a normal variable [σ]


@overload
def rms(values: ArrayLike) -> float: ...
@overload
def rms(values: ArrayLike, axis: int) -> FloatArray: ...
def rms(values: ArrayLike, axis: int | None = None) -> float | FloatArray:
    """Root mean square √(mean x²) over `axis`, or over all values; in the unit of `values`, NaN if one of them is."""
    root: FloatArray = np.sqrt(np.mean(np.square(values), axis=axis))
    return float(root) if axis is None else root


def evenly_chosen(items: Sequence[T], count: int) -> tuple[T, ...]:
    """`count` of the items, from the first to the last with equal steps; all of them if they are no more."""
    if len(items) <= count:
        return tuple(items)
    return tuple(items[at] for at in np.linspace(0, len(items) - 1, count).round().astype(int))
