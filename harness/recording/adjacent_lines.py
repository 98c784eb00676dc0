"""Straight lines through the readings just before and just after each instant: whether they meet, and how they turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from analytic.motion import FloatArray

FINEST = 0.01  # s; nothing that pushes a ball is shorter, and lines of few values are soon computed
LEAST_VARIANCE = 1e-18  # about a line [m²]: what rounding leaves


def block_length(time: FloatArray) -> int:
    """Readings, at stamps of shape (n,) [s], that are averaged so that the means are about `FINEST` apart."""
    return max(1, int(FINEST / float(np.median(np.diff(time)))))


def block_means(values: FloatArray, block: int) -> FloatArray:
    """Means of so many consecutive values each, shape (n // block,); what is left over at the end is left out."""
    count = len(values) // block
    return values[: count * block].reshape(count, block).mean(axis=1)


@dataclass(frozen=True)
class AdjacentLines:
    """Lines through `width` values before and after every instant between two stamps; shape (n − 2 width + 1,) each.

    Entry i is about the instant before stamp i + width, half-way from the stamp before. Standard errors are by the
    scatter about both lines. Units are those of positions; where the values are angles, they are in rad for m.

    Attributes:
        width: values of a line.
        before, after: the slopes [m/s].
        slope_error: standard error of their difference [m/s].
        gap: the line after minus the line before, at the instant [m].
        gap_error: its standard error [m].
        apart: from the middle of one line to that of the other [s].
        length: from the first stamp of one line to the last of the other [s].
    """

    width: int
    before: FloatArray
    after: FloatArray
    slope_error: FloatArray
    gap: FloatArray
    gap_error: FloatArray
    apart: FloatArray
    length: FloatArray

    @property
    def turn(self) -> FloatArray:
        """Slope after minus slope before, shape (n − 2 width + 1,) [m/s]."""
        return self.after - self.before


def adjacent_lines(time: FloatArray, values: FloatArray, width: int) -> AdjacentLines:
    """At every instant with so many values before and after it.

    Args:
        time: strictly increasing, shape (n,) [s].
        values: shape (n,) [m].
        width: values of a line, three at least; n is twice as many at least.
    """
    windows, stamps = sliding_window_view(values, width), sliding_window_view(time, width)
    middle, mean = stamps.mean(axis=1), windows.mean(axis=1)
    since = stamps - middle[:, None]
    spread = (since**2).sum(axis=1)
    slope = (since * windows).sum(axis=1) / spread
    scatter = ((windows - mean[:, None] - slope[:, None] * since) ** 2).sum(axis=1)
    first, second = slice(0, len(time) - 2 * width + 1), slice(width, None)
    variance = (scatter[first] + scatter[second]) / (2 * width - 4)
    quiet = np.median(variance) / 4.0  # by chance, or by rounding, the scatter may be far less than elsewhere
    variance = np.maximum(variance, max(quiet, LEAST_VARIANCE))
    instant = 0.5 * (time[width - 1 : len(time) - width] + time[width : len(time) - width + 1])
    ends = [mean[part] + slope[part] * (instant - middle[part]) for part in (first, second)]
    share = sum(1.0 / width + (instant - middle[part]) ** 2 / spread[part] for part in (first, second))
    return AdjacentLines(
        width,
        before=slope[first],
        after=slope[second],
        slope_error=np.sqrt(variance * (1.0 / spread[first] + 1.0 / spread[second])),
        gap=ends[1] - ends[0],
        gap_error=np.sqrt(variance * share),
        apart=middle[second] - middle[first],
        length=stamps[second][:, -1] - stamps[first][:, 0],
    )
