"""Figures for a report: common style, helpers for lines and axes, conversion to embedded SVG."""

import base64
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.style import context
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.formatting import brief
from harness.report.chart import Chart, thinning_note
from harness.report.palette import INK, LEFT_OUT_COLOUR, UNCERTAINTY_COLOUR, Look

WIDTH = 9.0  # [in]
_MAX_POINTS = 800  # per line; more are not visible at this width
_MAX_DOTS = 1500  # per cloud
_WIDE = 3.0  # ratio of the largest to the smallest value from which an axis is logarithmic
_TICKS = 4  # steps between ticks of an axis that is one of three side by side
_USE = "Drag to zoom, with Shift to move; Ctrl and wheel, the buttons or + − ← → 0 do the same."
_LINKED = "A click sets the instant of all that shows the same time."
_POINTS = "The point nearest to the mouse says what it is; ‹ and › go from point to point."

style = partial(context, Path(__file__).with_name("report.mplstyle"))
"""The common Matplotlib style, as a context or as a decorator."""


@dataclass(frozen=True)
class Picture:
    """An image that is part of the page.

    Attributes:
        source: data URL of the SVG.
        alt: alternative text.
        caption: printed below.
        width, height: of the drawing [px].
        still_note: what the caption adds on the image, which does not hold for the chart.
        chart: what replaces the image on screen where scripts run; `None` for nothing.
        beside: further charts, beside each other below it.
    """

    source: str
    alt: str
    caption: str | Markup
    width: int
    height: int
    chart: Chart | None = None
    still_note: str = ""
    beside: tuple[Chart, ...] = ()

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All that replace the image."""
        return self.beside if self.chart is None else (self.chart, *self.beside)

    @property
    def chart_note(self) -> str:
        """What the caption adds on the charts: how to use them, and whether they are thinned."""
        if not self.charts:
            return ""
        linked = f" {_LINKED}" if self.charts[0].clock else ""
        points = f" {_POINTS}" if any(one.pointed for one in self.charts) else ""
        return f"{_USE}{linked}{points}{thinning_note(self.charts)}"


def picture(
    figure: Figure,
    alt: str,
    caption: str | Markup,
    chart: Chart | None = None,
    still_note: str = "",
    beside: tuple[Chart, ...] = (),
) -> Picture:
    """Converts `figure` to an embedded image; call within `style`."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None}, dpi=160)
    width, height = figure.get_size_inches() * 96
    source = "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
    return Picture(source, alt, caption, round(width), round(height), chart, still_note, beside)


def drawing(height: float) -> Figure:
    """An empty figure of the page's width and of `height` [in]; call within `style`."""
    return Figure(figsize=(WIDTH, height), layout="constrained")


def thinning(samples: int) -> int:
    """Stride that reduces a line of `samples` points to at most `_MAX_POINTS`."""
    return max(1, -(-samples // _MAX_POINTS))


def joined(
    time: FloatArray,
    values: FloatArray,
    horizon: Horizon,
    keep: NDArray[np.bool_] | None = None,
    *,
    thin: bool = True,
) -> tuple[FloatArray, FloatArray]:
    """Concatenates runs to one line with gaps between them, by default thinned to the visible resolution.

    Args:
        time: stamps, shape (n,) [s].
        values: at the stamps of the horizon, shape (k,).
        horizon: of the runs.
        keep: stamps to draw, shape (n,), the others are skipped; `None` for all.
        thin: whether the line is thinned.
    """
    keep = np.ones(len(time), dtype=np.bool_) if keep is None else keep
    stride = thinning(len(values)) if thin else 1
    runs = zip(*(horizon.pieces(one) for one in (time[horizon.stamps], values, keep[horizon.stamps])), strict=True)
    parts = [
        np.pad(np.array([stamps, piece])[:, shown][:, ::stride], ((0, 0), (0, 1)), constant_values=np.nan)
        for stamps, piece, shown in runs
    ]
    times, line = np.concatenate(parts, axis=1)
    return times, line


def line(axes: Axes, time: FloatArray, values: FloatArray, look: Look) -> None:
    """Draws a line in the given look."""
    (drawn,) = axes.plot(time, values, color=look.colour, linewidth=look.width, zorder=look.layer)
    if look.dash:
        drawn.set_dashes(look.dash)


def signal(axes: Axes, time: FloatArray, values: FloatArray, look: Look) -> None:
    """Draws a line without gaps, thinned to the visible resolution."""
    thin = slice(None, None, thinning(len(time)))
    line(axes, time[thin], values[thin], look)


def sample(look: Look, label: str = "") -> Line2D:
    """Legend entry for a look."""
    entry = Line2D([], [], color=look.colour, linewidth=look.width, label=label or look.label)
    if look.dash:
        entry.set_dashes(look.dash)
    return entry


def left_out(axes: Axes, readings: FloatArray) -> list[Line2D]:
    """Draws readings that are left out of all fits, `time [s], position [m]`, shape (k, 2); legend entries."""
    if not len(readings):
        return []
    thin = readings[:: thinning(len(readings))]
    (drawn,) = axes.plot(thin[:, 0], thin[:, 1], "x", color=LEFT_OUT_COLOUR, markersize=3.0, zorder=2)
    drawn.set_label("left out of all fits")
    return [drawn]


def band(axes: Axes, time: FloatArray, low: FloatArray, high: FloatArray) -> None:
    """Draws an uncertainty band."""
    thin = slice(None, None, thinning(len(time)))
    time, low, high = time[thin], low[thin], high[thin]
    axes.fill_between(time, low, high, color=UNCERTAINTY_COLOUR, alpha=0.35, linewidth=0.0, zorder=1)


def zero(axes: Axes) -> None:
    """Draws the horizontal line at 0."""
    axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)


def dots(axes: Axes, x: FloatArray, y: FloatArray, look: Look) -> None:
    """Draws samples as a cloud of at most about 2 `_MAX_DOTS` dots."""
    thin = slice(None, None, max(1, len(x) // _MAX_DOTS))
    axes.plot(
        x[thin], y[thin], ".", color=look.colour, alpha=0.3, markersize=3, markeredgewidth=0, rasterized=True,
        zorder=look.layer,
    )  # fmt: skip


def means(axes: Axes, x: FloatArray, y: FloatArray, layer: int = 7) -> None:
    """Draws the means of bins with their standard errors, and the line at 0."""
    centre, mean, error = binned(x, y)
    axes.errorbar(centre, mean, yerr=error, color=INK, marker="o", markersize=3.5, linewidth=1.0, zorder=layer)
    zero(axes)


def against_state(
    row: Iterable[Axes], position: FloatArray, velocity: FloatArray, angle: FloatArray
) -> Iterator[tuple[Axes, FloatArray]]:
    """Three axes and their abscissas: position [m], velocity [m/s] and beam angle, given in radians."""
    names = ("position s [m]", "velocity ṡ [m/s]", "beam angle α [deg]")
    for axes, name, x in zip(row, names, (position, velocity, np.degrees(angle)), strict=True):
        axes.set_xlabel(name)
        axes.xaxis.set_major_locator(MaxNLocator(_TICKS))
        yield axes, x


def over_time(axes: Axes, begin: float, end: float) -> None:
    """Makes the abscissa time from `begin` to `end` [s]."""
    axes.set_xlim(begin, end)
    axes.set_xlabel("time [s]")


def frame(axes: Axes, values: FloatArray, margin: float = 0.35, least: float = 1e-3) -> None:
    """Sets the y limits to the range of `values` with a margin of at least `least`."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = max(margin * (high - low), least)
    axes.set_ylim(low - room, high + room)


def middle(values: FloatArray, outside: float) -> FloatArray:
    """Lowest and highest of the finite `values` without the share `outside` [%] at each end, shape (2,).

    Along a path that left the range where a law is defined, values may be infinite; zeros if none is finite.
    """
    finite = values[np.isfinite(values)]
    return np.percentile(finite, (outside, 100.0 - outside)) if finite.size else np.zeros(2)


def mark_exits(axes: Axes, time: FloatArray, values: FloatArray, look: Look) -> tuple[float, bool] | None:
    """Marks with triangles where a line leaves the y limits.

    Args:
        axes: with y limits set.
        time: shape (n,), NaN between runs [s].
        values: shape (n,).

    Returns:
        time of the first exit [s] and whether it is upwards; `None` if there is none.
    """
    low, high = axes.get_ylim()
    known = ~np.isnan(values)  # a gap between runs is not a return into the frame
    time, values = time[known], values[known]
    first: tuple[float, bool] | None = None
    for outside, edge, marker in ((values > high, high, "^"), (values < low, low, "v")):
        inside_before = np.concatenate(([True], ~outside[:-1]))
        at = np.flatnonzero(outside & inside_before)
        if at.size:
            axes.plot(
                time[at], np.full(at.size, edge), marker, color=look.colour, markersize=5, clip_on=False, zorder=9
            )
            left = float(time[at[0]]), marker == "^"
            first = left if first is None else min(first, left)
    return first


def plain_log(axes: Axes, which: str, ticks: Sequence[float] | None = None) -> None:
    """Makes an axis logarithmic with plain tick labels; `which` is "x" or "y"."""
    axis = getattr(axes, f"{which}axis")
    axes.set(**{f"{which}scale": "log"})
    if ticks is not None:
        axis.set_major_locator(FixedLocator(list(ticks)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: brief(value, 2)))
    axis.set_minor_formatter(NullFormatter())


def scaled(axes: Axes, which: str, values: Sequence[float]) -> None:
    """Makes an axis of positive values logarithmic, or where they differ little, one from zero."""
    if values and max(values) > _WIDE * min(values):
        low, high = math.floor(math.log10(min(values))) - 1, math.ceil(math.log10(max(values)))
        marks = (1,) if high - low > 3 else (1, 2, 5)
        plain_log(axes, which, [mark * 10.0**power for power in range(low, high + 1) for mark in marks])
    else:
        axes.set(**{f"{which}lim": (0.0, 1.25 * max(values, default=1.0))})


def binned(x: FloatArray, y: FloatArray, bins: int = 12) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean of y and its standard error in bins of equal sample count: mean x, mean y, error, shape (bins,) each.

    Samples are assumed independent; for smoothed signals the errors are therefore too small.
    """
    order = np.argsort(x)
    parts = [part for part in np.array_split(order, bins) if part.size > 2]
    return (
        np.array([np.mean(x[part]) for part in parts]),
        np.array([np.mean(y[part]) for part in parts]),
        np.array([np.std(y[part]) / np.sqrt(part.size) for part in parts]),
    )
