"""Picture of detection limits: each in typical sizes of its effect, so that all are on one logarithmic axis."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from harness.identify.design.detection import Limit
from harness.report.chart import Chart, Panel, Trace
from harness.report.check.wording import limit_text
from harness.report.palette import INK, Look
from harness.report.plots import Picture, drawing, picture, plain_log, style

_MARK = 3.5  # width of a point's look [px]
_KINDS = (
    (Look("as recorded", "#D55E00", None, _MARK), "o", "limit"),
    (Look("once the rest is explained", "#0072B2", None, _MARK), "D", "explained"),
)
_ABSCISSA = "detection limit in typical sizes of the effect"
_TALL = 32  # of a row on screen [px]: of all effects a screen holds the whole


_SMALLER = "to the right of the line it shows only if that is as many times smaller than the typical one"


@dataclass(frozen=True)
class _Point:
    """A limit that some size reaches.

    Attributes:
        row: of its effect, from the top.
        share: the limit in typical sizes [1].
        note: effect and limit in words.
    """

    row: int
    share: float
    note: str


def picture_of(limits: Sequence[Limit]) -> Picture | None:
    """Limits of all effects for screen and paper, the lowest on top; `None` if no size of any effect shows."""
    rows = _sorted(limits)
    if not any(_points(rows, kind) for *_, kind in _KINDS):
        return None
    with style():
        return picture(
            drawn(limits),
            f"Detection limits of {len(limits)} effects in their typical sizes, the lowest on top.",
            "Detection limits in typical sizes of their effects, on a logarithmic axis: to the left of the line at 1 "
            "an effect shows at its typical size, to the right of it only at as many times its typical size. "
            f"{inverse_text(rows, _SMALLER)}The table below has the same limits with their units.",
            _chart(rows),
        )


def inverse_text(limits: Sequence[Limit], consequence: str) -> str:
    """What follows for each effect that grows as its parameter falls, in a sentence each; empty without any."""
    told = [one for one in limits if one.inverse]
    return "".join(f"The {_plain(one)} grows as its `{one.parameter}` falls: {consequence}. " for one in told)


@style()
def drawn(limits: Sequence[Limit]) -> Figure:
    """Limits of all effects on a logarithmic axis, the lowest on top; the names say which show at no size."""
    rows = _sorted(limits)
    figure = drawing(0.9 + 0.19 * len(rows))
    axes = figure.add_subplot()
    for look, marker, kind in _KINDS:
        points = _points(rows, kind)
        places = [one.share for one in points], [one.row for one in points]
        axes.plot(*places, marker, color=look.colour, markersize=5, label=look.label)
    axes.axvline(1.0, color=INK, linewidth=1.0)
    plain_log(axes, "x")
    axes.set_yticks(range(len(rows)), [_name(one) for one in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel(f"{_ABSCISSA} [1]; to the left of 1 it shows")
    figure.legend(loc="outside upper left", ncols=2)
    return figure


def _chart(rows: Sequence[Limit]) -> Chart:
    """The same as data of the page."""
    traces = []
    for look, _, kind in _KINDS:
        points = _points(rows, kind)
        if points:
            x, y = [one.share for one in points], [-float(one.row) for one in points]
            traces.append(Trace(look.label, look, x, y, dots=True, notes=[one.note for one in points]))
    panel = Panel("effect", "", traces, zero=True, rows=[_name(one) for one in rows], row_height=_TALL)
    return Chart("detection-limits", [panel], _ABSCISSA, "1", log_x=True)


def _sorted(limits: Sequence[Limit]) -> list[Limit]:
    return sorted(limits, key=lambda one: (_share(one, one.explained), _share(one, one.limit)))


def _points(rows: Sequence[Limit], kind: str) -> list[_Point]:
    """Limits of one kind, without those that no size reaches."""
    found = []
    for row, one in enumerate(rows):
        limit = getattr(one, kind)
        share = _share(one, limit)
        if math.isfinite(share):
            unit = "" if one.unit == "1" else f" {one.unit}"
            found.append(_Point(row, share, f"{_plain(one)} {limit_text(one, limit)}{unit}"))
    return found


def _plain(one: Limit) -> str:
    return one.effect.replace("_", " ")


def _name(one: Limit) -> str:
    """Name of a row: the effect, and what cannot be seen of it."""
    if math.isinf(_share(one, one.explained)):
        return f"{_plain(one)} (at no size)"
    if not one.seen:
        return f"{_plain(one)} (not at its typical size)"
    return f"{_plain(one)} (as recorded at no size)" if math.isinf(_share(one, one.limit)) else _plain(one)


def _share(one: Limit, limit: float) -> float:
    """A limit over the typical size, the other way round for an effect of small values; infinite for no size."""
    if limit == 0.0 or math.isinf(limit):
        return math.inf
    return one.typical / limit if one.inverse else limit / one.typical
