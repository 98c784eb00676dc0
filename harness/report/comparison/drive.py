"""Section on the drive: sensor model of the recorded angle, and the smoothed α, α̇, α̈ used by every source."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harness.formatting import number
from harness.numerics import rms
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import INK
from harness.report.plots import WIDTH, Picture, band, frame, picture, style, thinning

_COLOUR = "#0B6E63"
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


def _picture(subject: Subject) -> Picture:
    setting = subject.study.setting
    drive, time = setting.drive, setting.time
    recorded = np.degrees(setting.recording.angle)
    with style():
        figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
        panels = figure.subplot_mosaic([["angle", "detail"], ["rate", "rate"], ["acceleration", "acceleration"]])
        for name, title in (("angle", "beam angle"), ("detail", "detail at the largest rate")):
            axes: Axes = panels[name]
            axes.plot(
                time, recorded, ".", color="#777777", markersize=2.2, markeredgewidth=0, rasterized=True, zorder=2
            )
            _curve(axes, subject, 0)
            axes.set_title(title)
            axes.set_ylabel(r"$\alpha$ [deg]")
            axes.set_xlim(time[0], time[-1])
        fastest = float(time[int(np.argmax(np.abs(drive.states[:, 1])))])
        begin = min(max(fastest - 0.5 * _DETAIL_DURATION, time[0]), max(time[-1] - _DETAIL_DURATION, time[0]))
        near = (time >= begin) & (time <= begin + _DETAIL_DURATION)
        panels["detail"].set_xlim(begin, begin + _DETAIL_DURATION)
        frame(panels["detail"], recorded[near], margin=0.08)
        for line in panels["detail"].lines[:1]:
            line.set_markersize(4.0)
        for name, order, label in (
            ("rate", 1, r"$\dot\alpha$ [deg/s]"),
            ("acceleration", 2, r"$\ddot\alpha$ [deg/s²]"),
        ):
            _curve(panels[name], subject, order)
            panels[name].axhline(0.0, color=INK, linewidth=0.6)
            panels[name].set_xlim(time[0], time[-1])
            panels[name].set_ylabel(label)
        panels["acceleration"].set_xlabel("time [s]")
        alt = (
            "Recorded beam angle with the smooth angle, its rate and its acceleration, each with a band of two "
            "standard deviations."
        )
        caption = (
            f"Dots: {subject.measured} angle. Lines: smoothed signals that drive every source; bands: ± 2 σ. "
            "α̇ and α̈ are derivatives of the smoothing spline, not differences of readings."
        )
        return picture(figure, alt, caption)


def _curve(axes: Axes, subject: Subject, order: int) -> None:
    drive = subject.study.setting.drive
    thin = slice(None, None, thinning(len(drive.time)))
    time, values, std = drive.time[thin], np.degrees(drive.states[thin, order]), np.degrees(drive.std[thin, order])
    band(axes, time, values - 2.0 * std, values + 2.0 * std)
    axes.plot(time, values, color=_COLOUR, linewidth=1.2, zorder=3)
