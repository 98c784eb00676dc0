"""Section on residuals: position errors over time and against s, ṡ, α, and the residual acceleration of CAM."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes

from analytic.models import CAM
from analytic.motion import FloatArray
from harness.formatting import number
from harness.numerics import rms
from harness.report import plots
from harness.report.chart import Chart, Panel, Trace
from harness.report.clouds import Cloud, Row, against_state, stamped
from harness.report.comparison.overlay import CLOCK, UNCERTAINTY, marks
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import UNCERTAINTY_COLOUR, Look, label_of, look_of

SIGMA = Look("± 2 σ", UNCERTAINTY_COLOUR)


def section(subject: Subject) -> Section:
    """Residuals."""
    context = {
        "over_time": _over_time(subject),
        "against": _against(subject),
        "acceleration": _acceleration(subject),
    }
    return Section("residuals", "Residuals", "Residuals", "comparison/residuals.html", context)


@plots.style()
def _over_time(subject: Subject) -> plots.Picture:
    study, horizon = subject.study, subject.study.headline
    setting = study.setting
    figure = plots.drawing(3.6)
    axes = figure.add_subplot()
    time, u = plots.joined(setting.time, 1e3 * study.u_val_of(horizon), horizon)
    plots.band(axes, time, -2.0 * u, 2.0 * u)
    errors = {one.source: 1e3 * subject.error(one.source, horizon) for one in subject.ranked}
    # Limits the axis to the ball's travel: larger errors carry no further information.
    travel = 1e3 * float(np.ptp(setting.ball.position))
    seen = np.concatenate([*errors.values(), 2.0 * u, -2.0 * u])
    plots.frame(axes, np.clip(seen[np.isfinite(seen)], -travel, travel), margin=0.05)
    for source, error in errors.items():
        times, values = plots.joined(setting.time, error, horizon, subject.drawn)
        plots.line(axes, times, values, look_of(source))
        plots.mark_exits(axes, times, values, look_of(source))
    plots.zero(axes)
    plots.over_time(axes, setting.time[horizon.first[0]], setting.time[horizon.last[-1]])
    axes.set_ylabel(f"model − {subject.measured} [mm]")
    figure.legend(handles=[plots.sample(look_of(one)) for one in errors], loc="outside right upper", handlelength=2.6)
    return plots.picture(
        figure,
        f"Position error of every source over time, {subject.over(horizon)}, with the band of two u_val.",
        f"Position error of every source {subject.over(horizon)}; band: ± 2 u_val.",
        _errors_chart(subject, errors, frame=axes.get_ylim()),
        "Triangles: leaves the frame.",
    )


def _errors_chart(subject: Subject, errors: Mapping[str, FloatArray], frame: tuple[float, float]) -> Chart:
    """The same as data of the page; `errors` by source, shape (k,) each [mm]."""
    study, horizon = subject.study, subject.study.headline
    time = study.setting.time
    u_time, u = plots.joined(time, 2e3 * study.u_val_of(horizon), horizon, thin=False)
    traces = [Trace("uncertainty", UNCERTAINTY, u_time, u, low=-u)]
    for source, error in errors.items():
        traces.append(Trace(source, look_of(source), *plots.joined(time, error, horizon, subject.drawn, thin=False)))
    panel = Panel(f"model − {subject.measured}", "mm", traces, frame=frame, zero=True)
    return Chart("errors-over-time", [panel], clock=CLOCK, marks=marks(subject, horizon))


@plots.style()
def _against(subject: Subject) -> plots.Picture:
    horizon = subject.study.headline
    best = subject.ranked[0].source
    others = [one.source for one in subject.ranked if not one.same] or [subject.ranked[-1].source]
    shown = list(dict.fromkeys((best, CAM.name if best != CAM.name else others[0])))
    figure = plots.drawing(2.4 * len(shown))
    grid = figure.subplots(len(shown), 3, sharey="row", squeeze=False)
    rows = []
    for row, source in zip(grid, shown, strict=True):
        error = 1e3 * subject.error(source, horizon)
        seen = np.isfinite(error)
        error, at = error[seen], horizon.stamps[seen]
        _clouds(row, subject, error, at, look_of(source))
        row[0].set_ylabel(f"{label_of(source)}\nerror [mm]")
        rows.append(_row(subject, "error", "mm", Cloud(source, look_of(source), error), at, label_of(source)))
    for axes in grid[0]:
        axes.tick_params(labelbottom=True)
    return plots.picture(
        figure,
        f"Position errors of {' and '.join(map(label_of, shown))} against position, velocity and beam angle.",
        f"Position error of the closest source and a second one, {subject.over(horizon)}, against "
        "position, velocity and beam angle. Points: means of bins with their standard errors.",
        beside=against_state("errors-against", rows),
    )


def _row(
    subject: Subject, label: str, unit: str, cloud: Cloud, at: np.ndarray, title: str = "",
    frame: tuple[float, float] | None = None,
) -> Row:  # fmt: skip
    """The same at the stamps `at`, shape (n,), as data of the page."""
    setting = subject.study.setting
    ball, angle = setting.ball, setting.drive.states[:, 0]
    state = (stamped(setting.time[at]), ball.position[at], ball.velocity[at], angle[at])
    return Row(label, unit, [cloud], *state, frame=frame, title=title)


def _clouds(row: np.ndarray, subject: Subject, value: FloatArray, at: np.ndarray, look: Look) -> None:
    """`value` at the stamps `at` against s, ṡ and α, one axes each."""
    ball, angle = subject.study.setting.ball, subject.study.setting.drive.states[:, 0]
    for axes, x in plots.against_state(row, ball.position[at], ball.velocity[at], angle[at]):
        plots.dots(axes, x, value, look)
        plots.means(axes, x, value)


@plots.style()
def _acceleration(subject: Subject) -> plots.Picture:
    time, ball = subject.study.setting.time, subject.study.setting.ball
    residual, std = ball.residual, np.sqrt(ball.covariance[:, 2, 2].clip(min=0.0))
    look = look_of(CAM.name)
    figure = plots.drawing(5.0)
    panels = figure.subplot_mosaic([["time"] * 3, ["s", "v", "a"]])
    top: Axes = panels["time"]
    plots.band(top, time, residual - 2.0 * std, residual + 2.0 * std)
    top.plot(time, residual, color=look.colour, linewidth=1.2)
    plots.zero(top)
    plots.frame(top, residual, margin=0.25)
    plots.over_time(top, time[0], time[-1])
    at = np.flatnonzero(ball.trusted)
    row = np.array([panels["s"], panels["v"], panels["a"]])
    _clouds(row, subject, residual[at], at, look)
    low, high = np.percentile(residual[at], (1.0, 99.0))
    for axes in row:
        axes.set_ylim(low - 0.3 * (high - low) - 1e-4, high + 0.3 * (high - low) + 1e-4)
    for axes in (top, row[0]):
        axes.set_ylabel("residual acceleration\nof CAM [m/s²]")
    traces = [
        Trace("sigma", SIGMA, time, residual + 2.0 * std, low=residual - 2.0 * std),
        Trace("residual", replace(look, label="residual acceleration"), time, residual),
    ]
    panel = Panel("residual acceleration of CAM", "m/s²", traces, frame=top.get_ylim(), zero=True)
    cloud = Cloud("residual", replace(look, label="residual acceleration"), residual[at])
    clouds = _row(subject, "residual", "m/s²", cloud, at, frame=row[0].get_ylim())
    scatter, std_rms = float(np.std(residual[at])), rms(std[at])
    return plots.picture(
        figure,
        "Residual acceleration of CAM over time and against position, velocity and beam angle.",
        "Residual acceleration: the ball's acceleration that CAM does not explain, estimated from the recording, "
        "with its ± 2 σ band, over time and against s, ṡ, α. A step at ṡ = 0 indicates dry friction, a "
        "slope in ṡ viscous damping, an offset a level error, a slope in s a curved track. Its standard deviation "
        f"is {number(scatter)} m/s², its uncertainty {number(std_rms, 2)} m/s².",
        Chart("residual-acceleration", [panel], clock=CLOCK),
        beside=against_state("acceleration-against", [clouds]),
    )
