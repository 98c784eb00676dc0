"""Figure of the recording and all sources over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.formatting import number
from harness.report import plots
from harness.report.comparison.subject import Subject
from harness.report.palette import MEASURED_COLOUR, UNCERTAINTY_COLOUR, look_of
from harness.report.standing import Standing, standings


@plots.style()
def overlay(subject: Subject, horizon: Horizon) -> plots.Picture:
    """Positions of all sources on one horizon as an image of the page."""
    shown = "whole free run" if horizon.seconds is None else f"windows of {horizon.seconds:g} s"
    best = ", ".join(f"{look_of(one.source).label} {number(1e3 * one.rms)} mm" for one in _ranked(subject, horizon))
    dots = "" if horizon.seconds is None else "Dots: restarts from the estimated state. "
    return plots.picture(
        drawn(subject, horizon),
        f"Ball position over time, {shown}: {subject.measured} and all sources. RMS errors: {best}.",
        f"{subject.measured.capitalize()} ball position (black) and every source {subject.over(horizon)}, closest "
        f"first. {dots}Grey: ± 2 u_val, the expected error of a perfect model. Triangles: a source leaves the frame.",
    )


def _ranked(subject: Subject, horizon: Horizon) -> list[Standing]:
    return subject.ranked if horizon is subject.study.headline else standings(subject.study, horizon)


@plots.style()
def drawn(subject: Subject, horizon: Horizon) -> Figure:
    """Positions of all sources on one horizon, framed by the recording's own range."""
    figure = plots.drawing(3.7)
    axes = figure.add_subplot()
    time, slices = subject.study.setting.time, horizon.slices()
    plots.frame(axes, _draw_recording(subject, horizon, axes))
    entries = [
        Line2D([], [], color=MEASURED_COLOUR, linewidth=1.7, label=subject.measured),
        Patch(color=UNCERTAINTY_COLOUR, alpha=0.35, linewidth=0, label=r"± 2 $u_\mathrm{val}$"),
    ]
    entries += plots.left_out(axes, subject.study.setting.recording.left_out)
    plots.over_time(axes, time[horizon.first[0]], time[horizon.last[-1]])
    exits = []
    for one in _ranked(subject, horizon):
        look, run = look_of(one.source), subject.study.run_of(one.source, horizon)
        run_time, values = plots.joined(time, run.position, slices)
        plots.line(axes, run_time, values, look)
        left = plots.mark_exits(axes, run_time, values, look)
        exits += [] if left is None else [left]
        entries.append(plots.sample(look, f"{look.label}  {'failed' if run.failures else number(1e3 * one.rms)}"))
    if horizon.seconds is None:
        plots.label_exits(axes, exits)
    axes.set_ylabel("ball position $s$ [m]")
    legend = figure.legend(
        handles=entries, loc="outside right upper", title="RMS error [mm]", alignment="left", handlelength=2.6
    )
    legend.get_title().set_fontsize(8.5)
    return figure


def _draw_recording(subject: Subject, horizon: Horizon, axes: Axes) -> FloatArray:
    """Draws the recording, its uncertainty band and the starts of runs; returns the positions shown [m]."""
    study = subject.study
    setting, u_val = study.setting, study.u_val_of(horizon)
    position = np.where(setting.ball.trusted, setting.recording.position, np.nan)
    slices = horizon.slices()
    span = slice(slices[0].start, slices[-1].stop)
    shown = subject.drawn[span]
    # Above the band and below the engines' dashed lines.
    axes.plot(setting.time[span][shown], position[span][shown], color=MEASURED_COLOUR, linewidth=1.4, zorder=4)
    time, u = plots.joined(setting.time, u_val, slices)
    _, centre = plots.joined(setting.time, np.broadcast_to(setting.ball.position, u_val.shape), slices)
    plots.band(axes, time, centre - 2.0 * u, centre + 2.0 * u)
    if horizon.seconds is not None:
        first = horizon.first
        axes.plot(
            setting.time[first], setting.ball.position[first], "o", color=MEASURED_COLOUR, markersize=3.2, zorder=8
        )
    return position[span]
