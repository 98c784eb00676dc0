"""Texts in figures that cover neither each other nor what they name."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox

from harness.formatting import brief

_MIN_LABEL_DISTANCE = 0.08  # share of the axis; closer labels are merged
_POINT = 3.0  # half the width that a point takes [px]
# Where a label may stand beside its point, the best place first: near it, then above and below in rows [pt].
_BESIDE = tuple(
    (x, y)
    for y in (4.0, -10.0, 14.0, -20.0, 24.0, -30.0, 34.0, -40.0)
    for x in ((4.0, -24.0) if abs(y) < 12.0 else (-10.0,))
)


def label_exits(axes: Axes, exits: Sequence[tuple[float, bool]]) -> None:
    """Labels the triangles of `mark_exits` with exit times; close ones share a label."""
    begin, end = axes.get_xlim()
    for upwards in (True, False):
        times = sorted(time for time, up in exits if up is upwards)
        groups: list[list[float]] = []
        for time in times:
            if groups and time - groups[-1][-1] < _MIN_LABEL_DISTANCE * (end - begin):
                groups[-1].append(time)
            else:
                groups.append([time])
        taken: list[Bbox] = []
        for group in groups:
            first, last = brief(group[0], 2), brief(group[-1], 2)
            who = "1 source leaves" if len(group) == 1 else f"{len(group)} sources leave"
            when = f"at {first} s" if first == last else f"at {first}–{last} s"
            right = group[-1] > begin + 0.7 * (end - begin)
            label = axes.annotate(
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
            _clear(label, taken, [(label.xyann[0], height) for height in (3, 15, 27, 39)])


def label_points(
    axes: Axes, points: Sequence[tuple[float, float]], texts: Sequence[str], colours: Sequence[str]
) -> None:
    """Writes a text beside each point, so that texts cover neither each other nor points.

    Call it when the limits of the axes are set and all else of the figure is drawn, since it depends on the layout.

    Args:
        axes: of the points.
        points: in the units of the axes.
        texts: one a point.
        colours: of the texts, which tell whose they are where points lie close together.
    """
    figure = axes.get_figure(root=True)
    if not points or figure is None:
        return
    figure.draw_without_rendering()
    at = axes.transData.transform(points)
    taken = [Bbox.from_extents(x - _POINT, y - _POINT, x + _POINT, y + _POINT) for x, y in at]
    legend = axes.get_legend()
    taken += [] if legend is None else [legend.get_window_extent()]
    for point, text, colour in zip(points, texts, colours, strict=True):
        label = axes.annotate(text, point, _BESIDE[0], textcoords="offset points", fontsize=7, color=colour)
        _clear(label, taken, _BESIDE)


def _clear(label: Annotation, taken: list[Bbox], offsets: Sequence[tuple[float, float]]) -> None:
    """Moves a label to the first of the offsets [pt] at which it covers nothing that is taken, and takes its place."""
    for offset in offsets:
        label.xyann = offset
        box = label.get_window_extent()
        if box.count_overlaps(taken) == 0:
            break
    taken.append(box)
