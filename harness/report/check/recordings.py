"""Pictures of the recordings: beam angle, ball position, and the readings that are left out."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from harness.numerics import evenly_chosen
from harness.recording import Recording
from harness.report.chart import Chart, Mark, Panel, Trace
from harness.report.check.content import Content, Subject
from harness.report.page import Section
from harness.report.palette import LEFT_OUT_COLOUR, MEASURED_COLOUR, Look
from harness.report.plots import Picture, dots, drawing, left_out, over_time, picture, signal, style, zero

ANGLE = Look("beam angle", MEASURED_COLOUR)
POSITION = Look("position", MEASURED_COLOUR)
LEFT_OUT = Look("left out of all fits", LEFT_OUT_COLOUR)
OUTLIER = Look("outlier", LEFT_OUT_COLOUR, None, 3.0)
_DRAWN = 3  # recordings; of more the first, the last and those between


def section(subject: Subject) -> Section:
    """Recordings to identify from."""
    case = subject.case
    names = evenly_chosen(case.identify, _DRAWN)
    what = "simulated" if case.simulated else "as recorded"
    text = f"Recordings to identify from, {what}: {len(names)} of {len(case.identify)} are drawn."
    pictures = tuple(_picture(number, case.recordings[name], what) for number, name in enumerate(names))
    return Content(texts=(text,), pictures=pictures).section("recordings", "The recordings", "Recordings")


@style()
def drawn(one: Recording) -> Figure:
    """Beam angle and ball position over time, with what is left out of all fits."""
    figure = drawing(3.4)
    top, bottom = figure.subplots(2, 1, sharex=True)
    signal(top, one.time, np.degrees(one.angle), ANGLE)
    zero(top)
    top.set_ylabel("beam angle α [deg]")
    good = one.usable & ~one.outlier
    dots(bottom, one.time[good], one.position[good], POSITION)
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
    bottom.set_ylabel("position s [m]")
    over_time(bottom, one.time[0], one.time[-1])
    return figure


@style()
def _picture(number: int, one: Recording, what: str) -> Picture:
    shaded = "" if one.usable.all() else " Shaded: the position is unknown or left out of all fits."
    caption = f"{one.name} ({what}).{shaded}"
    return picture(drawn(one), f"Beam angle and ball position of {one.name} over time", caption, _chart(number, one))


def _chart(number: int, one: Recording) -> Chart:
    """The same as data of the page."""
    spikes = one.usable & one.outlier
    # The line passes over spikes, and has gaps where no position is usable.
    position = np.where(one.usable, one.position, np.nan)[~spikes]
    below = [Trace("position", POSITION, one.time[~spikes], position)]
    for key, look, time, values in (
        ("left_out", LEFT_OUT, *one.left_out.T),
        ("outlier", OUTLIER, one.time[spikes], one.position[spikes]),
    ):
        if len(time):
            below.append(Trace(key, look, time, values, dots=True))
    panels = (
        Panel("beam angle α", "°", [Trace("angle", ANGLE, one.time, np.degrees(one.angle))], zero=True),
        Panel("position s", "m", below),
    )
    marks = [Mark("left_out", "no usable position", begin, end) for begin, end in _unknown(one)]
    return Chart(f"recording-{number}", panels, clock=f"recording {one.name}", marks=marks)


def _unknown(one: Recording) -> list[tuple[float, float]]:
    """Begin and end of the stretches without a usable position [s]."""
    bad = np.concatenate(([False], ~one.usable, [False]))
    edges = np.flatnonzero(np.diff(bad.astype(int)))
    last = len(one.time) - 1
    return [
        (float(one.time[max(begin - 1, 0)]), float(one.time[min(end, last)]))
        for begin, end in zip(edges[::2], edges[1::2], strict=True)
    ]
