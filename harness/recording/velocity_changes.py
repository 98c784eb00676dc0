"""Changes of the ball's velocity from just before an instant to just after it, by lines through its readings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from analytic.motion import FloatArray

FINEST = 0.01  # s; nothing that pushes a ball is shorter, and lines of few values are soon computed


def block_length(time: FloatArray) -> int:
    """Readings, at stamps of shape (n,) [s], that are averaged so that the means are about `FINEST` apart."""
    return max(1, int(FINEST / float(np.median(np.diff(time)))))


def block_means(values: FloatArray, block: int) -> FloatArray:
    """Means of so many consecutive values each, shape (n // block,); what is left over at the end is left out."""
    count = len(values) // block
    return values[: count * block].reshape(count, block).mean(axis=1)


@dataclass(frozen=True)
class VelocityChanges:
    """Lines through `width` values before and after every instant between two stamps; shape (n − 2 width + 1,) each.

    Entry i is about the instant before stamp i + width.

    Attributes:
        width: values of a line.
        change: slope after minus slope before [m/s].
        before, after: the slopes [m/s].
        error: standard error of the change, by the scatter about the lines [m/s].
        apart: from the middle of one line to that of the other [s].
    """

    width: int
    change: FloatArray
    before: FloatArray
    after: FloatArray
    error: FloatArray
    apart: FloatArray


def velocity_changes(time: FloatArray, values: FloatArray, width: int) -> VelocityChanges:
    """At every instant with so many values before and after it.

    Args:
        time: strictly increasing, shape (n,) [s].
        values: shape (n,) [m].
        width: values of a line, three at least; n is twice as many at least.
    """
    windows, stamps = sliding_window_view(values, width), sliding_window_view(time, width)
    middle = stamps.mean(axis=1)
    since = stamps - middle[:, None]
    spread = (since**2).sum(axis=1)
    slope = (since * windows).sum(axis=1) / spread
    scatter = ((windows - windows.mean(axis=1)[:, None] - slope[:, None] * since) ** 2).sum(axis=1)
    first, second = slice(0, len(time) - 2 * width + 1), slice(width, None)
    quiet = np.median(scatter) / (width - 2) / 4.0  # by chance, or by rounding, the scatter may be far less than usual
    variance = np.maximum((scatter[first] + scatter[second]) / (2 * width - 4), quiet)
    error = np.sqrt(variance * (1.0 / spread[first] + 1.0 / spread[second]))
    change, apart = slope[second] - slope[first], middle[second] - middle[first]
    return VelocityChanges(width, change, slope[first], slope[second], error, apart)
