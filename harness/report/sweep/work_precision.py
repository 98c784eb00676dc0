"""Section: work and precision, error against time of each engine and step size."""

from __future__ import annotations

import math
from dataclasses import replace

from matplotlib.figure import Figure

from harness.formatting import brief, length, number
from harness.report.chart import Chart, Panel, Trace
from harness.report.labels import label_points
from harness.report.page import Section
from harness.report.palette import label_of, look_of, swatch
from harness.report.plots import Picture, drawing, picture, scaled, style
from harness.report.sweep.runs import OUTPUTS, by_source, cloud, positive
from harness.report.sweep.subject import Subject
from harness.report.tables import Column, Table, texts
from harness.sweeps.factors import CAM_SOURCE
from harness.sweeps.results import Results, WorkPrecision

_ATTRIBUTES = ("error_cam", "error_measured")
_MARK = 3.0  # width of the medians' look [px]


def section(subject: Subject) -> Section | None:
    """Error against time; nothing where step sizes were sampled and no engine ran."""
    results = subject.results
    if not results.work_precision:
        return None
    return Section(
        "work-precision",
        "Accuracy and processor time",
        "Accuracy",
        "sweep/work_precision.html",
        {
            "picture": _picture(subject) if _drawable(results) else None,
            "table": table(results, marked=True),
            "horizon": subject.horizon,
            "measured": subject.measured,
        },
    )


def table(results: Results, *, marked: bool = False) -> Table | None:
    """One row a source and step size; `marked` with the source's colour."""
    if not results.work_precision:
        return None
    fastest = min((one.seconds for one in results.work_precision if one.seconds > 0.0), default=math.nan)
    rows = [
        (
            swatch(one.source) if marked else label_of(one.source),
            "—" if one.time_step is None else brief(one.time_step),
            number(one.seconds, 2),
            number(one.seconds / fastest, 2),
            "0" if one.source == CAM_SOURCE else length(one.error_cam),
            "0" if one.source == CAM_SOURCE else length(one.error_cam_max),
            length(one.error_measured),
            str(one.runs),
            str(one.failed),
        )
        for one in results.work_precision
    ]
    columns = [
        *texts("model or engine"),
        "time step [s]",
        Column("time per second", "s", hint="processor time of a run per second of motion, median of the runs"),
        Column("over the fastest", "1"),
        Column("difference from CAM", "median", hint="largest in a run, median of the runs"),
        Column("difference from CAM", "largest", hint="largest of all runs"),
        Column("RMS error", "median", hint="against the recorded positions, median of the runs"),
        "runs",
        "failed",
    ]
    return Table("Processor time and accuracy by time step", columns, rows)


def _points(results: Results, attribute: str) -> dict[str, list[WorkPrecision]]:
    found: dict[str, list[WorkPrecision]] = {}
    for one in results.work_precision:
        if one.seconds > 0.0 and getattr(one, attribute) > 0.0:
            found.setdefault(one.source, []).append(one)
    return found


def _drawable(results: Results) -> bool:
    return bool(_points(results, "error_cam") or _points(results, "error_measured"))


@style()
def drawn(results: Results) -> Figure:
    """Error against CAM and against the measurement, over the time of a run per second of motion."""
    figure = drawing(3.6)
    left, right = figure.subplots(1, 2)
    for axes, attribute in zip((left, right), _ATTRIBUTES, strict=True):
        for source, points in _points(results, attribute).items():
            look = look_of(source)
            x, y = [one.seconds for one in points], [getattr(one, attribute) for one in points]
            axes.plot(x, y, "o-", color=look.colour, markersize=4, linewidth=1.2, label=look.label)
        axes.set(xlabel="processor time per second of motion [s]", ylabel=f"{OUTPUTS[attribute][1]} [m]")
        axes.margins(0.12)
        values = [getattr(one, attribute) for points in _points(results, attribute).values() for one in points]
        scaled(axes, "x", [one.seconds for one in results.work_precision if one.seconds > 0.0])
        scaled(axes, "y", values)
        if axes.has_data():
            axes.legend(loc="best")
    for axes, attribute in zip((left, right), _ATTRIBUTES, strict=True):
        named = [one for points in _points(results, attribute).values() for one in points if one.time_step is not None]
        label_points(
            axes,
            [(one.seconds, getattr(one, attribute)) for one in named],
            [brief(one.time_step) for one in named if one.time_step is not None],
            [look_of(one.source).colour for one in named],
        )
    return figure


def chart(subject: Subject) -> Chart:
    """The same as data of the page, with every run beside the medians."""
    panels = []
    for attribute in _ATTRIBUTES:
        label, title = OUTPUTS[attribute]
        traces = []
        for source, runs in by_source(positive(subject.runs, attribute)).items():
            one = cloud(subject, source, runs, [run.seconds for run in runs], attribute)
            traces.append(replace(one, key=f"{source} runs", look=replace(one.look, label=f"{label_of(source)}, runs")))
        for source, points in _points(subject.results, attribute).items():
            notes = [_note(one) for one in points]
            look = replace(look_of(source), dash=None, width=_MARK, label=f"{label_of(source)}, medians")
            values = [getattr(one, attribute) for one in points]
            traces.append(Trace(source, look, [one.seconds for one in points], values, notes=notes))
        if traces:
            panels.append(Panel(label, "m", traces, log=True, title=title))
    return Chart("work-precision-chart", panels, "processor time per second of motion", "s", log_x=True)


def _note(one: WorkPrecision) -> str:
    step = "" if one.time_step is None else f"time step {brief(one.time_step)} s, "
    good = one.runs - one.failed
    return f"{step}{'one run' if good == 1 else f'median of {good} runs'}"


def _picture(subject: Subject) -> Picture:
    with style():
        return picture(
            drawn(subject.results),
            "Error over processor time, one line an engine, one point a time step",
            "Largest difference from CAM and RMS error against the recording, in m, over the processor time that a "
            "second of motion takes, in s; medians of all runs with one time step. To the lower left is better.",
            chart(subject),
            "The time step in s is beside each point.",
        )
