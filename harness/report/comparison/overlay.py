"""Figure of the recording and all sources over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from analytic.motion import FloatArray
from harness.comparison.horizons import Horizon
from harness.engines.health import Failure
from harness.formatting import number
from harness.report import plots
from harness.report.chart import Chart, Mark, Panel, Trace
from harness.report.comparison.subject import Subject
from harness.report.labels import label_exits
from harness.report.palette import LEFT_OUT_COLOUR, MEASURED_COLOUR, UNCERTAINTY_COLOUR, Look, look_of
from harness.report.standing import Standing, standings

CLOCK = "recording"  # of all charts over the recording's time, and of the replay
MEASURED = "measured"
UNCERTAINTY = Look("± 2 u_val", UNCERTAINTY_COLOUR)
LEFT_OUT = Look("left out of all fits", LEFT_OUT_COLOUR)
RESTARTS = Look("restarts", MEASURED_COLOUR, None, 3.0)


@plots.style()
def overlay(subject: Subject, horizon: Horizon) -> plots.Picture:
    """Positions of all sources on one horizon as an image of the page."""
    shown = "whole free run" if horizon.seconds is None else f"windows of {horizon.seconds:g} s"
    best = ", ".join(f"{look_of(one.source).label} {number(1e3 * one.rms)} mm" for one in _ranked(subject, horizon))
    dots = "" if horizon.seconds is None else "Dots: restarts from the estimated state. "
    return plots.picture(
        drawn(subject, horizon),
        f"Ball position over time, {shown}: {subject.measured} and all sources. RMS errors: {best}.",
        f"{subject.measured.capitalize()} ball position and every source {subject.over(horizon)}, closest "
        f"first. {dots}Band: ± 2 u_val, the expected error of a perfect model.",
        chart(subject, horizon),
        "Triangles: a source leaves the frame.",
    )


def anchor(horizon: Horizon) -> str:
    """Of the chart of a horizon's positions."""
    return f"positions-{horizon.name}"


def chart(subject: Subject, horizon: Horizon) -> Chart:
    """The same as data of the page."""
    study = subject.study
    setting = study.setting
    time = setting.time
    span = slice(horizon.first[0], horizon.last[-1] + 1)
    position = np.where(setting.ball.trusted, setting.recording.position, np.nan)[span]
    shown = subject.drawn[span]
    u_time, u = plots.joined(time, study.u_val_of(horizon), horizon, thin=False)
    _, centre = plots.joined(time, setting.ball.position[horizon.stamps], horizon, thin=False)
    traces = [
        Trace("uncertainty", UNCERTAINTY, u_time, centre + 2.0 * u, low=centre - 2.0 * u),
        Trace(MEASURED, Look(subject.measured, MEASURED_COLOUR, None, 1.7), time[span][shown], position[shown]),
    ]
    for one in _ranked(subject, horizon):
        run = study.run_of(one.source, horizon)
        traces.append(Trace(one.source, look_of(one.source), *plots.joined(time, run.position, horizon, thin=False)))
    left_out = setting.recording.left_out
    if len(left_out):
        traces.append(Trace("left_out", LEFT_OUT, left_out[:, 0], left_out[:, 1], dots=True))
    if horizon.seconds is not None:
        first = horizon.first
        traces.append(Trace("starts", RESTARTS, time[first], setting.ball.position[first], dots=True))
    low, high = float(np.nanmin(position)), float(np.nanmax(position))
    room = max(0.35 * (high - low), 1e-3)
    panel = Panel("ball position s", "m", traces, frame=(low - room, high + room))
    return Chart(anchor(horizon), [panel], clock=CLOCK, marks=marks(subject, horizon))


def marks(subject: Subject, horizon: Horizon) -> list[Mark]:
    """Failures of engines and lift-off of the ball in the runs of a horizon, in the order of time."""
    found = {}
    for source in subject.study.sources:
        run = subject.study.run_of(source, horizon)
        for failure in run.failures:
            found[failure.time, source] = f"{look_of(source).label} failed: {failure.reason}"
        for time in run.lifted_off:
            found.setdefault((time, source), f"{look_of(source).label}: {Failure.LIFTED_OFF.value}")
    by_time: dict[tuple[float, str], list[str]] = {}
    for (time, _), text in found.items():
        who, _, what = text.partition(": ")
        by_time.setdefault((time, what), []).append(who)
    return [Mark("failure", f"{', '.join(who)}: {what}", time, time) for (time, what), who in sorted(by_time.items())]


def _ranked(subject: Subject, horizon: Horizon) -> list[Standing]:
    return subject.ranked if horizon is subject.study.headline else standings(subject.study, horizon)


@plots.style()
def drawn(subject: Subject, horizon: Horizon) -> Figure:
    """Positions of all sources on one horizon, framed by the recording's own range."""
    figure = plots.drawing(3.7)
    axes = figure.add_subplot()
    time = subject.study.setting.time
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
        run_time, values = plots.joined(time, run.position, horizon)
        plots.line(axes, run_time, values, look)
        left = plots.mark_exits(axes, run_time, values, look)
        exits += [] if left is None else [left]
        entries.append(plots.sample(look, f"{look.label}  {'failed' if run.failures else number(1e3 * one.rms)}"))
    if horizon.seconds is None:
        label_exits(axes, exits)
    axes.set_ylabel("ball position s [m]")
    legend = figure.legend(
        handles=entries, loc="outside right upper", title="RMS error [mm]", alignment="left", handlelength=2.6
    )
    legend.get_title().set_fontsize(8.5)
    return figure


def _draw_recording(subject: Subject, horizon: Horizon, axes: Axes) -> FloatArray:
    """Draws the recording, its uncertainty band and the starts of runs; returns the positions shown [m]."""
    study = subject.study
    setting = study.setting
    position = np.where(setting.ball.trusted, setting.recording.position, np.nan)
    span = slice(horizon.first[0], horizon.last[-1] + 1)
    shown = subject.drawn[span]
    # Above the band and below the engines' dashed lines.
    axes.plot(setting.time[span][shown], position[span][shown], color=MEASURED_COLOUR, linewidth=1.4, zorder=4)
    time, u = plots.joined(setting.time, study.u_val_of(horizon), horizon)
    _, centre = plots.joined(setting.time, setting.ball.position[horizon.stamps], horizon)
    plots.band(axes, time, centre - 2.0 * u, centre + 2.0 * u)
    if horizon.seconds is not None:
        first = horizon.first
        axes.plot(
            setting.time[first], setting.ball.position[first], "o", color=MEASURED_COLOUR, markersize=3.2, zorder=8
        )
    return position[span]
