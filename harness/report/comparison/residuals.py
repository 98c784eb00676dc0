"""What is left over: position errors over time and against s, ṡ, α, and the acceleration that CAM lacks."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.models import CAM
from analytic.motion import FloatArray
from harness.formatting import number
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import INK, label_of, look_of
from harness.report.plots import (
    WIDTH,
    Picture,
    band,
    binned,
    frame,
    joined,
    line,
    mark_exits,
    picture,
    sample,
    style,
)

_DOTS = 1500  # of one cloud; more only blacken it


def section(subject: Subject) -> Section:
    """Residuals."""
    context = {
        "over_time": _over_time(subject),
        "against": _against(subject),
        "acceleration": _acceleration(subject),
    }
    return Section("residuals", "Residuals", "Residuals", "comparison/residuals.html", context)


def _over_time(subject: Subject) -> Picture:
    study, horizon = subject.study, subject.study.headline
    slices = horizon.slices()
    with style():
        figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
        axes = figure.add_subplot()
        time, u = joined(study.setting.time, 1e3 * study.u_val_of(horizon), slices)
        band(axes, time, -2.0 * u, 2.0 * u)
        errors = {one.source: 1e3 * subject.error(one.source, horizon) for one in subject.ranked}
        # An error larger than the ball's whole travel says no more than that.
        travel = 1e3 * float(np.ptp(study.setting.ball.position))
        seen = np.concatenate([error[np.isfinite(error)] for error in errors.values()] + [2.0 * u[np.isfinite(u)]])
        frame(axes, np.clip(np.concatenate((seen, -2.0 * u[np.isfinite(u)])), -travel, travel), margin=0.05)
        for one in subject.ranked:
            times, values = joined(study.setting.time, errors[one.source], slices, subject.drawn)
            line(axes, times, values, look_of(one.source))
            mark_exits(axes, times, values, look_of(one.source))
        axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
        axes.set_xlim(study.setting.time[slices[0].start], study.setting.time[slices[-1].stop - 1])
        axes.set_xlabel("time [s]")
        axes.set_ylabel(f"model − {subject.measured} [mm]")
        entries = [sample(look_of(one.source), label_of(one.source)) for one in subject.ranked]
        figure.legend(handles=entries, loc="outside right upper", handlelength=2.6)
        alt = f"Position error of every source over time, {subject.over(horizon)}, with the band of two u_val."
        caption = (
            f"Position error of every source {subject.over(horizon)}; grey: ± 2 u_val; triangles: leaves the frame."
        )
        return picture(figure, alt, caption)


def _against(subject: Subject) -> Picture:
    horizon = subject.study.headline
    best = subject.ranked[0].source
    second = CAM.name if best != CAM.name else next(
        (one.source for one in subject.ranked if not one.same), subject.ranked[-1].source
    )  # fmt: skip
    shown = [best] if best == second else [best, second]
    with style():
        figure = Figure(figsize=(WIDTH, 2.4 * len(shown)), layout="constrained")
        grid = figure.subplots(len(shown), 3, sharey="row", squeeze=False)
        for row, source in zip(grid, shown, strict=True):
            error = 1e3 * subject.error(source, horizon)
            runs, at = np.nonzero(np.isfinite(error))
            _clouds(row, subject, error[runs, at], at, look_of(source).colour)
            row[0].set_ylabel(f"{label_of(source)}\nerror [mm]")
        for axes in grid[0]:
            axes.tick_params(labelbottom=True)
        alt = f"Position errors of {' and '.join(map(label_of, shown))} against position, velocity and beam angle."
        caption = (
            f"Position error of the closest source and a second one, {subject.over(horizon)}, against where the "
            "ball was, how fast it ran, and how the beam stood. Points: means of bins with their standard errors."
        )
        return picture(figure, alt, caption)


def _clouds(row: np.ndarray, subject: Subject, value: FloatArray, at: np.ndarray, colour: str) -> None:
    """`value` at the stamps `at` against s, ṡ and α, one axes each."""
    setting = subject.study.setting
    ball, angle = setting.ball, np.degrees(setting.drive.states[:, 0])
    thin = slice(None, None, max(1, len(at) // _DOTS))
    for axes, x, name in zip(
        row,
        (ball.position[at], ball.velocity[at], angle[at]),
        ("position $s$ [m]", r"velocity $\dot s$ [m/s]", r"beam angle $\alpha$ [deg]"),
        strict=True,
    ):
        axes.plot(x[thin], value[thin], ".", color=colour, alpha=0.25, markersize=3, markeredgewidth=0, rasterized=True)
        centre, mean, error = binned(x, value)
        axes.errorbar(centre, mean, yerr=error, color=INK, marker="o", markersize=3.5, linewidth=1.0, zorder=5)
        axes.axhline(0.0, color=INK, linewidth=0.8, zorder=2)
        axes.set_xlabel(name)


def _acceleration(subject: Subject) -> Picture:
    setting = subject.study.setting
    ball = setting.ball
    residual, std = ball.residual, np.sqrt(ball.covariance[:, 2, 2].clip(min=0.0))
    colour = look_of(CAM.name).colour
    with style():
        figure = Figure(figsize=(WIDTH, 5.0), layout="constrained")
        panels = figure.subplot_mosaic([["time"] * 3, ["s", "v", "a"]])
        top: Axes = panels["time"]
        band(top, setting.time, residual - 2.0 * std, residual + 2.0 * std)
        top.plot(setting.time, residual, color=colour, linewidth=1.2)
        top.axhline(0.0, color=INK, linewidth=0.8)
        frame(top, residual, margin=0.25)
        top.set_xlim(setting.time[0], setting.time[-1])
        top.set_xlabel("time [s]")
        top.set_ylabel("acceleration beyond\nCAM [m/s²]")
        at = np.flatnonzero(ball.trusted)
        row = np.array([panels["s"], panels["v"], panels["a"]])
        _clouds(row, subject, residual[at], at, colour)
        low, high = np.percentile(residual[at], (1.0, 99.0))
        for axes in row:
            axes.set_ylim(low - 0.3 * (high - low) - 1e-4, high + 0.3 * (high - low) + 1e-4)
        row[0].set_ylabel("acceleration beyond\nCAM [m/s²]")
        alt = (
            "Acceleration of the ball that CAM does not explain, over time and against position, velocity and "
            "beam angle."
        )
        scatter, doubt = float(np.std(residual[at])), float(np.sqrt(np.mean(std[at] ** 2)))
        caption = (
            "Acceleration of the ball that CAM does not explain, estimated from the recording with its ± 2 σ "
            "band (grey), over "
            "time and against s, ṡ, α. A law shows as a shape: a step at ṡ = 0 is dry friction, a slope in ṡ "
            "viscous, an "
            f"offset a levelling error, a slope in s a curved track. Its spread is {number(scatter)} m/s², known to "
            f"± {number(doubt, 2)} m/s²."
        )
        return picture(figure, alt, caption)
