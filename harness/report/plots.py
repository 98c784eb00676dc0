"""Pictures for a page: one style, units on every axis, vector graphics that carry their own letters."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.formatting import brief
from harness.report.palette import GRID_COLOUR, INK, MEASURED_COLOUR, UNCERTAINTY_COLOUR, Look

WIDTH = 9.0  # [in]
_NEIGHBOURS = 0.08  # of the axis; texts closer than this would overlap
_MOST_POINTS = 800  # of one line; more cannot be seen at this width

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "mathtext.fontset": "dejavusans",
    "axes.edgecolor": "#8a94a0",
    "axes.labelcolor": INK,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID_COLOUR,
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "text.color": INK,
    "xtick.color": "#4c5967",
    "ytick.color": "#4c5967",
    "lines.solid_capstyle": "round",
    "svg.fonttype": "path",
    "svg.hashsalt": "harness",  # the same picture is the same file
    "axes.unicode_minus": True,
}


@dataclass(frozen=True)
class Picture:
    """An image that is part of the page.

    Attributes:
        source: data address of the SVG.
        alt: what it shows, for those who do not see it.
        caption: printed below.
        width, height: of the drawing [px].
    """

    source: str
    alt: str
    caption: str | Markup
    width: int
    height: int


@contextmanager
def style() -> Iterator[None]:
    """The style of all pictures."""
    with mpl.rc_context(STYLE):
        yield


def picture(figure: Figure, alt: str, caption: str | Markup) -> Picture:
    """`figure` as an image of the page; call it within `style`."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None}, dpi=160)
    width, height = figure.get_size_inches() * 96
    source = "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
    return Picture(source, alt, caption, round(width), round(height))


def thinning(samples: int) -> int:
    """Every how manieth of so many samples a line needs."""
    return max(1, -(-samples // _MOST_POINTS))


def joined(
    time: FloatArray, pieces: FloatArray, slices: Sequence[slice], keep: NDArray[np.bool_] | None = None
) -> tuple[FloatArray, FloatArray]:
    """Runs as one line with gaps between them, thinned to what can be seen.

    Args:
        time: stamps, shape (n,) [s].
        pieces: one run a row, shape (runs, n).
        slices: the stamps of each run.
        keep: stamps to draw, shape (n,); a line passes over the others. `None` for all.
    """
    keep = np.ones(len(time), dtype=np.bool_) if keep is None else keep
    stride = thinning(sum(where.stop - where.start for where in slices))
    gap = np.array([np.nan])
    times: list[FloatArray] = []
    values: list[FloatArray] = []
    for row, where in zip(pieces, slices, strict=True):
        times += [time[where][keep[where]][::stride], gap]
        values += [row[where][keep[where]][::stride], gap]
    return np.concatenate(times), np.concatenate(values)


def line(axes: Axes, time: FloatArray, values: FloatArray, look: Look) -> Line2D:
    """One source's line in its look."""
    (drawn,) = axes.plot(time, values, color=look.colour, linewidth=look.width, zorder=look.layer)
    if look.dash:
        drawn.set_dashes(look.dash)
    return drawn


def sample(look: Look, label: str) -> Line2D:
    """An entry of a legend."""
    entry = Line2D([], [], color=look.colour, linewidth=look.width, label=label)
    if look.dash:
        entry.set_dashes(look.dash)
    return entry


def measured_line(axes: Axes, time: FloatArray, values: FloatArray) -> Line2D:
    """The recording: always black, above the band and below the engines' dashes."""
    (drawn,) = axes.plot(time, values, color=MEASURED_COLOUR, linewidth=1.4, zorder=4)
    return drawn


def band(axes: Axes, time: FloatArray, low: FloatArray, high: FloatArray) -> None:
    """What is left open: a grey band."""
    thin = slice(None, None, thinning(len(time)))
    time, low, high = time[thin], low[thin], high[thin]
    axes.fill_between(time, low, high, color=UNCERTAINTY_COLOUR, alpha=0.35, linewidth=0.0, zorder=1)


def frame(axes: Axes, values: FloatArray, margin: float = 0.35, least: float = 1e-3) -> None:
    """Limits of y: the range of `values` with a margin, whatever else is drawn."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = max(margin * (high - low), least)
    axes.set_ylim(low - room, high + room)


def mark_exits(axes: Axes, time: FloatArray, values: FloatArray, look: Look) -> tuple[float, bool] | None:
    """Marks with triangles where a line leaves the frame upwards or downwards.

    Args:
        axes: with its limits of y set.
        time: shape (n,), NaN between runs [s].
        values: shape (n,).

    Returns:
        when it first leaves [s], and whether upwards; `None` if it never does.
    """
    low, high = axes.get_ylim()
    known = ~np.isnan(values)  # a gap is no return into the frame; a new run begins inside by itself
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


def tell_exits(axes: Axes, exits: Sequence[tuple[float, bool]]) -> None:
    """Writes beside the triangles of `mark_exits`, when lines leave; neighbours share a text."""
    begin, end = axes.get_xlim()
    for upwards in (True, False):
        times = sorted(time for time, up in exits if up is upwards)
        groups: list[list[float]] = []
        for time in times:
            if groups and time - groups[-1][-1] < _NEIGHBOURS * (end - begin):
                groups[-1].append(time)
            else:
                groups.append([time])
        for group in groups:
            first, last = brief(group[0], 2), brief(group[-1], 2)
            who = "1 source leaves" if len(group) == 1 else f"{len(group)} sources leave"
            when = f"at {first} s" if first == last else f"at {first}–{last} s"
            right = group[-1] > begin + 0.7 * (end - begin)
            axes.annotate(
                f"{who} {when}",
                (group[0] if right else group[-1], axes.get_ylim()[upwards]),
                (-7 if right else 7, 3),
                textcoords="offset points",
                ha="right" if right else "left",
                va="bottom",
                fontsize=8,
                bbox={"facecolor": "white", "alpha": 0.6, "linewidth": 0, "pad": 1.0},
                zorder=10,
            )


def plain_log(axes: Axes, which: str, ticks: Sequence[float] | None = None) -> None:
    """A logarithmic axis with plain numbers; `which` is "x" or "y"."""
    axis = axes.xaxis if which == "x" else axes.yaxis
    (axes.set_xscale if which == "x" else axes.set_yscale)("log")
    if ticks is not None:
        axis.set_major_locator(FixedLocator(list(ticks)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: brief(value, 2)))
    axis.set_minor_formatter(NullFormatter())


def binned(x: FloatArray, y: FloatArray, bins: int = 12) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mean of y and its standard error in bins of equally many samples: centre, mean, error, shape (bins,).

    Neighbouring samples are taken for independent, so that errors of smoothed signals come out somewhat small.
    """
    order = np.argsort(x)
    parts = [part for part in np.array_split(order, bins) if part.size > 2]
    return (
        np.array([np.mean(x[part]) for part in parts]),
        np.array([np.mean(y[part]) for part in parts]),
        np.array([np.std(y[part]) / np.sqrt(part.size) for part in parts]),
    )
