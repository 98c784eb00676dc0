"""Pictures of the recordings: beam angle, ball position, and the readings that are left out."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from harness.numerics import evenly_chosen
from harness.recording import Recording
from harness.report.check.content import Content, Subject
from harness.report.page import Section
from harness.report.palette import LEFT_OUT_COLOUR, MEASURED_COLOUR, Look
from harness.report.plots import Picture, dots, drawing, left_out, over_time, picture, signal, style, zero

_DRAWN = 3  # recordings; of more the first, the last and those between


def section(subject: Subject) -> Section:
    """Recordings to identify from."""
    case = subject.case
    names = evenly_chosen(case.identify, _DRAWN)
    what = "simulated" if case.simulated else "as recorded"
    text = f"Recordings to identify from, {what}: {len(names)} of {len(case.identify)} are drawn."
    pictures = tuple(_picture(case.recordings[name], what) for name in names)
    return Content(texts=(text,), pictures=pictures).section("recordings", "The recordings", "Recordings")


@style()
def drawn(one: Recording) -> Figure:
    """Beam angle and ball position over time, with what is left out of all fits."""
    figure = drawing(3.4)
    top, bottom = figure.subplots(2, 1, sharex=True)
    look = Look("", MEASURED_COLOUR)
    signal(top, one.time, np.degrees(one.angle), look)
    zero(top)
    top.set_ylabel(r"beam angle $\alpha$ [deg]")
    good = one.usable & ~one.outlier
    dots(bottom, one.time[good], one.position[good], look)
    marks = left_out(bottom, one.left_out)
    spikes = one.usable & one.outlier
    if spikes.any():
        marks += bottom.plot(
            one.time[spikes], one.position[spikes], "+", color=LEFT_OUT_COLOUR, markersize=6.0, label="outlier"
        )
    for begin, end in _unknown(one):
        bottom.axvspan(begin, end, color=LEFT_OUT_COLOUR, alpha=0.12, linewidth=0.0, zorder=0)
    if marks:
        bottom.legend(handles=marks)
    bottom.set_ylabel("position $s$ [m]")
    over_time(bottom, one.time[0], one.time[-1])
    return figure


@style()
def _picture(one: Recording, what: str) -> Picture:
    shaded = "" if one.usable.all() else " Shaded: the position is unknown or left out of all fits."
    caption = f"{one.name} ({what}).{shaded}"
    return picture(drawn(one), f"Beam angle and ball position of {one.name} over time", caption)


def _unknown(one: Recording) -> list[tuple[float, float]]:
    """Begin and end of the stretches without a usable position [s]."""
    bad = np.concatenate(([False], ~one.usable, [False]))
    edges = np.flatnonzero(np.diff(bad.astype(int)))
    last = len(one.time) - 1
    return [
        (float(one.time[max(begin - 1, 0)]), float(one.time[min(end, last)]))
        for begin, end in zip(edges[::2], edges[1::2], strict=True)
    ]
