"""Figure of the held-out errors that a diagnosis.json holds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from harness.metrics.score import WHOLE
from harness.report.diagnosis.account import FOUND, MODEL
from harness.report.palette import look_of
from harness.report.plots import drawing, plain_log, style

_APART = 1.04  # ratio of places between sources at one horizon
_REST = 2.0  # ratio of the place of the rest, whose length is not kept, to the longest horizon
_MARKERS = "osD^v"

_WHOLE_LABEL = "rest"

Error = tuple[str, str, float | None, float | None]
"""Source, horizon, RMS error before and after [m]; `None` where it is not known."""


@style()
def drawn(errors: Sequence[Error]) -> Figure:
    """RMS error over the prediction horizon by source, before and after, on logarithmic axes."""
    sources = list(dict.fromkeys(source for source, *_ in errors))
    horizons = _places([horizon for _, horizon, *_ in errors])
    known = {(source, horizon): values for source, horizon, *values in errors}
    figure = drawing(2.9)
    axes = figure.add_subplot()
    for at, source in enumerate(sources):
        x = np.array(list(horizons.values())) * _APART ** (at - 0.5 * (len(sources) - 1))
        values = np.array([known.get((source, one), (None, None)) for one in horizons], dtype=float).reshape(-1, 2)
        for column, look in enumerate((MODEL, FOUND)):
            axes.plot(x, 1e3 * values[:, column], _MARKERS[at % len(_MARKERS)], color=look.colour, markersize=5)
        axes.plot([], [], _MARKERS[at % len(_MARKERS)], color="#5b6672", markersize=5, label=look_of(source).label)
    if np.isfinite([value for *_, before, after in errors for value in (before, after) if value]).any():
        plain_log(axes, "y")
    if horizons:
        plain_log(axes, "x", list(horizons.values()))
        axes.set_xticks(list(horizons.values()), [_WHOLE_LABEL if one == WHOLE else one.split()[0] for one in horizons])
        axes.set_xlim(min(horizons.values()) / 1.3, max(horizons.values()) * 1.3)
    if len(horizons) > 1 and WHOLE in horizons:
        axes.axvline(horizons[WHOLE] / np.sqrt(_REST), color="#5b6672", linewidth=0.8, linestyle=":")
    axes.set(xlabel=f"prediction horizon [s]; {_WHOLE_LABEL}: all of a recording that follows", ylabel="RMS error [mm]")
    marks, _ = axes.get_legend_handles_labels()
    colours = [Patch(color=look.colour, label=label) for look, label in ((MODEL, "before"), (FOUND, "after"))]
    figure.legend(handles=[*colours, *marks], loc="outside right upper")
    return figure


def _places(names: Sequence[str]) -> dict[str, float]:
    """Place [s] on the axis of every horizon, such as "3 s", in ascending order; the rest is beyond all others."""
    lengths = {name: float(name.split()[0]) for name in names if name != WHOLE}
    places = dict(sorted(lengths.items(), key=lambda one: one[1]))
    if WHOLE in names:
        places[WHOLE] = _REST * max(places.values(), default=1.0)
    return places
