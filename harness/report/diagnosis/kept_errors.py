"""Figure of the held-out errors that a diagnosis.json holds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from harness.report.diagnosis.account import FOUND, MODEL
from harness.report.palette import look_of
from harness.report.plots import drawing, plain_log, style

_APART = 0.09  # between sources at one horizon
_MARKERS = "osD^v"

Error = tuple[str, str, float | None, float | None]
"""Source, horizon, RMS error before and after [m]; `None` where it is not known."""


@style()
def drawn(errors: Sequence[Error]) -> Figure:
    """RMS error by prediction horizon and source, before and after, on a logarithmic axis."""
    sources = list(dict.fromkeys(source for source, *_ in errors))
    horizons = list(dict.fromkeys(horizon for _, horizon, *_ in errors))
    known = {(source, horizon): values for source, horizon, *values in errors}
    figure = drawing(2.9)
    axes = figure.add_subplot()
    for at, source in enumerate(sources):
        x = np.arange(len(horizons)) + _APART * (at - 0.5 * (len(sources) - 1))
        values = np.array([known.get((source, one), (None, None)) for one in horizons], dtype=float).reshape(-1, 2)
        for column, look in enumerate((MODEL, FOUND)):
            axes.plot(x, 1e3 * values[:, column], _MARKERS[at % len(_MARKERS)], color=look.colour, markersize=5)
        axes.plot([], [], _MARKERS[at % len(_MARKERS)], color="#5b6672", markersize=5, label=look_of(source).label)
    if np.isfinite([value for *_, before, after in errors for value in (before, after) if value]).any():
        plain_log(axes, "y")
    axes.set_xticks(range(len(horizons)), ["rest" if one == "whole" else one for one in horizons])
    axes.set(xlabel="prediction horizon", ylabel="RMS error [mm]")
    marks, _ = axes.get_legend_handles_labels()
    colours = [Patch(color=look.colour, label=label) for look, label in ((MODEL, "before"), (FOUND, "after"))]
    figure.legend(handles=[*colours, *marks], loc="outside right upper")
    return figure
