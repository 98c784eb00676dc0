"""Interactive clouds of samples against the ball's position and velocity and the beam's angle, with means of bins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray
from harness.formatting import number
from harness.report.chart import Chart, Panel, Trace
from harness.report.palette import INK, Look
from harness.report.plots import binned

MEANS = Look("means of bins", INK, None, 1.2, 7)
_MOST = 800  # dots of a cloud
_DOT = 1.5  # width of a dot's look [px]


@dataclass(frozen=True)
class Cloud:
    """Samples of one quantity.

    Attributes:
        key, look: as of a trace.
        values: shape (n,).
        averaged: whether means of bins are drawn.
    """

    key: str
    look: Look
    values: FloatArray
    averaged: bool = True


@dataclass(frozen=True)
class Row:
    """Clouds in one pair of axes.

    Attributes:
        label, unit: of the ordinate.
        clouds: with the same stamps.
        notes: what each sample is, n texts.
        position, velocity, angle: of the samples, shape (n,) each [m, m/s, rad].
        frame: limits of the ordinate; `None` for those of the data.
        title: above the axes.
    """

    label: str
    unit: str
    clouds: Sequence[Cloud]
    notes: Sequence[str]
    position: FloatArray
    velocity: FloatArray
    angle: FloatArray
    frame: tuple[float, float] | None = None
    title: str = ""


def against_state(anchor: str, rows: Sequence[Row]) -> tuple[Chart, ...]:
    """Three charts: against position, velocity and angle, one panel a row; each dot tells what it is."""
    return tuple(
        Chart(f"{anchor}-{name}", [_panel(row, getattr(row, name), factor) for row in rows], label, unit)
        for name, label, unit, factor in (
            ("position", "position", "m", 1.0),
            ("velocity", "velocity", "m/s", 1.0),
            ("angle", "beam angle", "°", 180.0 / np.pi),
        )
    )


def stamped(times: FloatArray, recording: str = "") -> list[str]:
    """Notes of samples at these times, shape (n,) [s], of a recording if it is named."""
    where = f"{recording} " if recording else ""
    return [f"{where}at {number(time, 4)} s" for time in times]


def traces_of(clouds: Sequence[Cloud], notes: Sequence[str], x: FloatArray) -> list[Trace]:
    """Dots of clouds, thinned, and the means of their bins.

    Args:
        clouds: with the same n stamps.
        notes: what each sample is, n texts.
        x: abscissa, shape (n,).
    """
    thin = slice(None, None, max(1, -(-len(x) // _MOST)))
    told = list(notes)[thin]
    traces = [
        Trace(
            one.key, Look(one.look.label, one.look.colour, None, _DOT), x[thin], one.values[thin],
            dots=True, notes=told,
        )
        for one in clouds
    ]  # fmt: skip
    for one in clouds:
        if one.averaged:
            centre, mean, error = binned(x, one.values)
            traces.append(Trace("means", MEANS, centre, mean, notes=["± standard error"] * len(mean), spread=error))
    return traces


def _panel(row: Row, x: FloatArray, factor: float) -> Panel:
    traces = traces_of(row.clouds, row.notes, factor * x)
    return Panel(row.label, row.unit, traces, frame=row.frame, zero=True, title=row.title)
