"""The drive: how the recorded angle was read, and the smooth α, α̇, α̈ that every source was given."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from harness.formatting import number
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import INK
from harness.report.plots import WIDTH, Picture, band, frame, picture, style, thinning

_COLOUR = "#0B6E63"
_SOUND = (0.7, 1.4)  # of the residual ratio; beyond, readings scatter other than their sensor should
_DETAIL = 1.5  # [s]


def section(subject: Subject) -> Section:
    """The drive."""
    drive = subject.study.setting.drive
    sensor = drive.sensor
    noise = f"{number(math.degrees(sensor.noise))}°"
    if sensor.rounded:
        how = (
            f"as an encoder with counts of {number(math.degrees(sensor.resolution))}° (rounding, not noise, limits it)"
        )
    elif sensor.resolution > 0.0:
        how = f"as a noisy reading, σ = {noise}, in steps of {number(math.degrees(sensor.resolution))}°"
    else:
        how = f"as a continuous noisy reading, σ = {noise}"
    low, high = _SOUND
    if drive.residual_ratio > high:
        verdict = (
            "larger than the sensor explains: its noise or resolution is declared too small, or the angle has spikes"
        )
    elif drive.residual_ratio < low:
        verdict = "smaller than the sensor explains: its noise or resolution may be declared too large"
    else:
        verdict = "as this sensor explains"
    context = {
        "how": how,
        "noise_estimated": sensor.estimated,
        "ratio": drive.residual_ratio,
        "verdict": verdict,
        "picture": _picture(subject),
        "std": [float(np.degrees(np.sqrt(np.mean(column**2)))) for column in drive.std.T],
    }
    return Section("drive", "The drive", "Drive", "comparison/drive.html", context)


def _picture(subject: Subject) -> Picture:
    setting = subject.study.setting
    drive, time = setting.drive, setting.time
    recorded = np.degrees(setting.recording.angle)
    with style():
        figure = Figure(figsize=(WIDTH, 6.2), layout="constrained")
        panels = figure.subplot_mosaic([["angle", "detail"], ["rate", "rate"], ["acceleration", "acceleration"]])
        for name, title in (("angle", "beam angle"), ("detail", "a closer look where it is fastest")):
            axes: Axes = panels[name]
            axes.plot(
                time, recorded, ".", color="#777777", markersize=2.2, markeredgewidth=0, rasterized=True, zorder=2
            )
            _curve(axes, subject, 0)
            axes.set_title(title)
            axes.set_ylabel(r"$\alpha$ [deg]")
            axes.set_xlim(time[0], time[-1])
        fastest = float(time[int(np.argmax(np.abs(drive.states[:, 1])))])
        begin = min(max(fastest - 0.5 * _DETAIL, time[0]), max(time[-1] - _DETAIL, time[0]))
        near = (time >= begin) & (time <= begin + _DETAIL)
        panels["detail"].set_xlim(begin, begin + _DETAIL)
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
            f"Dots: {subject.measured} angle. Lines: what every source was driven with; bands: ± 2 σ of each. "
            "Derivatives are those of one smoothing spline, never differences of readings."
        )
        return picture(figure, alt, caption)


def _curve(axes: Axes, subject: Subject, order: int) -> None:
    drive = subject.study.setting.drive
    thin = slice(None, None, thinning(len(drive.time)))
    time, values, std = drive.time[thin], np.degrees(drive.states[thin, order]), np.degrees(drive.std[thin, order])
    band(axes, time, values - 2.0 * std, values + 2.0 * std)
    axes.plot(time, values, color=_COLOUR, linewidth=1.2, zorder=3)
