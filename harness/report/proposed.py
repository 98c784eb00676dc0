"""The proposed next experiment as a picture: its beam angle and the ball position to expect, within the envelope."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.motion import FloatArray
from harness.identify.design.proposal import Proposal
from harness.report import plots
from harness.report.chart import Chart, Panel, Trace
from harness.report.palette import Look

LIMIT = Look("", "#5b6672", (4.0, 3.0), 1.0, 2)
_MARGIN = 0.08  # of the ordinate, beyond what is drawn


@plots.style()
def picture_of(proposal: Proposal, look: Look, model: str) -> plots.Picture:
    """Angle and expected position over time, for screen and paper.

    Args:
        proposal: what is drawn.
        look: of both lines; its label is not used.
        model: what expects the position, in words.
    """
    envelope, name = proposal.envelope, proposal.profile.name
    angle = np.degrees(proposal.angle)
    limits, positions = np.degrees([-envelope.angle, envelope.angle]), np.array([envelope.low, envelope.high])
    figure = plots.drawing(4.0)
    top, bottom = figure.subplots(2, 1, sharex=True)
    for axes, values, edges, label in (
        (top, angle, limits, "beam angle α [deg]"),
        (bottom, proposal.reading, positions, "position s [m]"),
    ):
        plots.signal(axes, proposal.time, values, look)
        for edge in edges:
            plots.line(axes, proposal.time[[0, -1]], np.full(2, edge), LIMIT)
        axes.margins(y=_MARGIN)
        axes.set_ylabel(label)
    plots.zero(top)
    plots.over_time(bottom, proposal.time[0], proposal.time[-1])
    panels = (
        _panel(proposal, replace(look, label="beam angle"), angle, limits, "°"),
        _panel(proposal, replace(look, label="expected position"), proposal.reading, positions, "m"),
    )
    return plots.picture(
        figure,
        f"Beam angle of the profile {name} and the ball's position to be expected, over time.",
        f"The profile “{name}”: {proposal.profile.words}. Above: beam angle, below: position expected by {model}. "
        "Dashed: assumed operating envelope, 1.2 times the largest angle of the recordings and the permitted range of "
        "the ball.",
        Chart("next-experiment", panels, clock="next experiment"),
    )


def _panel(proposal: Proposal, look: Look, values: FloatArray, edges: FloatArray, unit: str) -> Panel:
    """One quantity as data of the page.

    Args:
        proposal: gives the time.
        look: of its line, with its name.
        values: shape (n,).
        edges: limits of the envelope, shape (2,).
        unit: of both.
    """
    limit, ends = replace(LIMIT, label=f"limits of the {look.label.split()[-1]}"), proposal.time[[0, -1]]
    traces = [
        Trace(look.label, look, proposal.time, values),
        *(Trace(limit.label, limit, ends, np.full(2, edge)) for edge in edges),
    ]
    return Panel(look.label, unit, traces, zero=bool(edges[0] < 0.0))
