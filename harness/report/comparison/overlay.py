"""The picture everybody wants first: the recording against all sources."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.formatting import number
from harness.report.comparison.subject import Subject
from harness.report.palette import MEASURED_COLOUR, UNCERTAINTY_COLOUR, look_of
from harness.report.plots import (
    WIDTH,
    Picture,
    band,
    frame,
    joined,
    line,
    mark_exits,
    measured_line,
    picture,
    sample,
    style,
    tell_exits,
)
from harness.report.standing import Standing, standings

Exit = tuple[float, bool]
"""When a line leaves the frame [s], and whether upwards."""


def overlay(subject: Subject, horizon: Horizon) -> Picture:
    """Positions of all sources on one horizon, framed by the recording's own range."""
    ranked = subject.ranked if horizon is subject.study.headline else standings(subject.study, horizon)
    with style():
        figure = Figure(figsize=(WIDTH, 3.7), layout="constrained")
        axes = figure.add_subplot()
        recorded = _draw_recording(subject, horizon, axes)
        frame(axes, recorded)
        entries = [
            Line2D([], [], color=MEASURED_COLOUR, linewidth=1.7, label=subject.measured),
            Patch(color=UNCERTAINTY_COLOUR, alpha=0.35, linewidth=0, label=r"± 2 $u_\mathrm{val}$"),
        ]
        axes.set_xlim(subject.study.setting.time[horizon.first[0]], subject.study.setting.time[horizon.last[-1]])
        exits = []
        for one in ranked:
            entry, left = _draw(subject, horizon, axes, one)
            entries.append(entry)
            exits += [] if left is None else [left]
        if horizon.seconds is None:
            tell_exits(axes, exits)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("ball position $s$ [m]")
        legend = figure.legend(
            handles=entries, loc="outside right upper", title="RMS error [mm]", alignment="left", handlelength=2.6
        )
        legend.get_title().set_fontsize(8.5)
        shown = "whole free run" if horizon.seconds is None else f"windows of {horizon.seconds:g} s"
        return picture(figure, _alt(subject, ranked, shown), _caption(subject, horizon))


def _draw_recording(subject: Subject, horizon: Horizon, axes: Axes) -> FloatArray:
    """Draw the recording, its band and where runs begin; return the positions shown [m]."""
    study = subject.study
    setting, u_val = study.setting, study.u_val_of(horizon)
    position = np.where(setting.ball.trusted, setting.recording.position, np.nan)
    slices = horizon.slices()
    span = slice(slices[0].start, slices[-1].stop)
    drawn = subject.drawn[span]
    measured_line(axes, setting.time[span][drawn], position[span][drawn])
    time, u = joined(setting.time, u_val, slices)
    _, centre = joined(setting.time, np.broadcast_to(setting.ball.position, u_val.shape), slices)
    band(axes, time, centre - 2.0 * u, centre + 2.0 * u)
    if horizon.seconds is not None:
        first = horizon.first
        axes.plot(
            setting.time[first], setting.ball.position[first], "o", color=MEASURED_COLOUR, markersize=3.2, zorder=8
        )
    return position[span]


def _draw(subject: Subject, horizon: Horizon, axes: Axes, standing: Standing) -> tuple[Line2D, Exit | None]:
    look = look_of(standing.source)
    run = subject.study.run_of(standing.source, horizon)
    time, values = joined(subject.study.setting.time, run.position, horizon.slices())
    line(axes, time, values, look)
    left = mark_exits(axes, time, values, look)
    text = "failed" if run.failures else number(1e3 * standing.rms)
    return sample(look, f"{look.label}  {text}"), left


def _alt(subject: Subject, ranked: list[Standing], shown: str) -> str:
    best = ", ".join(f"{look_of(one.source).label} {number(1e3 * one.rms)} mm" for one in ranked)
    return f"Ball position over time, {shown}: {subject.measured} and all sources. RMS errors: {best}."


def _caption(subject: Subject, horizon: Horizon) -> str:
    text = (
        f"{subject.measured.capitalize()} ball position (black) and every source {subject.over(horizon)}, closest "
        "first. "
    )
    if horizon.seconds is not None:
        text += "Dots: where every source starts anew from the estimated state. "
    return text + (
        "Grey: where a perfect model could lie (± 2 u_val: sensor, angle and start). Triangles: a source leaves "
        "the frame."
    )
