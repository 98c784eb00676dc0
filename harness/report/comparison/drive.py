"""Section on the drive: sensor model of the recorded angle, and the smoothed α, α̇, α̈ used by every source."""

import math

import numpy as np
from matplotlib.axes import Axes

from harness.formatting import number
from harness.numerics import rms
from harness.report.chart import Chart, Panel, Trace
from harness.report.comparison.overlay import CLOCK
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import UNCERTAINTY_COLOUR, Look
from harness.report.plots import Picture, band, drawing, frame, picture, signal, style, zero

_SIGMA = Look("± 2 σ", UNCERTAINTY_COLOUR)
_SMOOTH = Look("smooth", "#0B6E63", None, 1.2, 3)
_PLAUSIBLE_RATIO = (0.7, 1.4)  # of residual to expected scatter; outside, the declared sensor is probably wrong
_DETAIL_DURATION = 1.5  # of the enlarged plot [s]


def section(subject: Subject) -> Section:
    """The drive."""
    drive = subject.study.setting.drive
    sensor = drive.sensor
    noise = f"{number(math.degrees(sensor.noise))}°"
    if sensor.rounded:
        how = f"encoder with counts of {number(math.degrees(sensor.resolution))}° (limited by quantisation, not noise)"
    elif sensor.resolution > 0.0:
        how = f"noisy readings, σ = {noise}, in steps of {number(math.degrees(sensor.resolution))}°"
    else:
        how = f"continuous noisy readings, σ = {noise}"
    low, high = _PLAUSIBLE_RATIO
    if drive.residual_ratio > high:
        verdict = "larger than expected: the declared noise or resolution is too small, or the angle has spikes"
    elif drive.residual_ratio < low:
        verdict = "smaller than expected: the declared noise or resolution may be too large"
    else:
        verdict = "as expected"
    context = {
        "how": how,
        "noise_estimated": sensor.estimated,
        "ratio": drive.residual_ratio,
        "verdict": verdict,
        "picture": _picture(subject),
        "std": [float(np.degrees(rms(column))) for column in drive.std.T],
    }
    return Section("drive", "The drive", "Drive", "comparison/drive.html", context)


@style()
def _picture(subject: Subject) -> Picture:
    setting = subject.study.setting
    drive, time = setting.drive, setting.time
    recorded = np.degrees(setting.recording.angle)
    figure = drawing(6.2)
    panels = figure.subplot_mosaic([["angle", "detail"], ["rate", "rate"], ["acceleration", "acceleration"]])
    for name, order, label in (
        ("angle", 0, "α [deg]"),
        ("detail", 0, "α [deg]"),
        ("rate", 1, "α̇ [deg/s]"),
        ("acceleration", 2, "α̈ [deg/s²]"),
    ):
        axes: Axes = panels[name]
        if order == 0:
            size = 4.0 if name == "detail" else 2.2
            axes.plot(
                time, recorded, ".", color="#777777", markersize=size, markeredgewidth=0, rasterized=True, zorder=2
            )
        else:
            zero(axes)
        values, std = np.degrees(drive.states[:, order]), np.degrees(drive.std[:, order])
        band(axes, drive.time, values - 2.0 * std, values + 2.0 * std)
        signal(axes, drive.time, values, _SMOOTH)
        axes.set_ylabel(label)
        axes.set_xlim(time[0], time[-1])
    panels["angle"].set_title("beam angle")
    panels["detail"].set_title("detail at the largest rate")
    fastest = float(time[int(np.argmax(np.abs(drive.states[:, 1])))])
    begin = min(max(fastest - 0.5 * _DETAIL_DURATION, time[0]), max(time[-1] - _DETAIL_DURATION, time[0]))
    near = (time >= begin) & (time <= begin + _DETAIL_DURATION)
    panels["detail"].set_xlim(begin, begin + _DETAIL_DURATION)
    frame(panels["detail"], recorded[near], margin=0.08)
    panels["acceleration"].set_xlabel("time [s]")
    return picture(
        figure,
        "Recorded beam angle with the smooth angle, its rate and its acceleration, each with a band of two "
        "standard deviations.",
        f"Dots: {subject.measured} angle. Lines: smoothed signals that drive every source; bands: ± 2 σ. "
        "α̇ and α̈ are derivatives of the smoothing spline, not differences of readings.",
        _chart(subject),
    )


def _chart(subject: Subject) -> Chart:
    """Angle, rate and acceleration over the whole recording as data of the page."""
    setting = subject.study.setting
    drive, recorded = setting.drive, np.degrees(setting.recording.angle)
    panels = []
    for order, (name, unit) in enumerate((("α", "deg"), ("α̇", "deg/s"), ("α̈", "deg/s²"))):
        values, std = np.degrees(drive.states[:, order]), np.degrees(drive.std[:, order])
        traces = [
            Trace("drive-sigma", _SIGMA, drive.time, values + 2.0 * std, low=values - 2.0 * std),
            Trace("drive-smooth", _SMOOTH, drive.time, values),
        ]
        if order == 0:
            look = Look(subject.measured, "#777777")
            traces.insert(1, Trace("drive-readings", look, setting.time, recorded, dots=True))
        panels.append(Panel(name, unit, traces, zero=order > 0))
    return Chart("drive-over-time", panels, clock=CLOCK)
