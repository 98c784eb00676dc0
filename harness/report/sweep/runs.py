"""Section: every run, its errors over each quantity that was varied."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

from matplotlib.figure import Figure

from harness.report import plots
from harness.report.chart import Chart, Panel, Trace
from harness.report.page import Section
from harness.report.palette import INK, Look, label_of, look_of
from harness.report.sweep.subject import Subject
from harness.sweeps.drawn_runs import DrawnRun, logarithmic, numeric_factors

BEST = Look("best fit", INK, None, 7.0, 8)
_MOST_FACTORS = 8
_DOT = 2.5  # width of a run's look [px]
OUTPUTS = {
    "error_measured": ("RMS error", "RMS error against the recording"),
    "error_cam": ("difference from CAM", "largest difference from CAM"),
}
"""Label of the axis in a chart, and what it is in full, by the attribute of a run."""


def section(subject: Subject) -> Section | None:
    """One picture a factor; nothing where no number was varied, or every run failed."""
    names = numeric_factors(subject.plan)
    if not subject.runs or not names:
        return None
    context = {
        "pictures": [picture for name in names[:_MOST_FACTORS] if (picture := _picture(subject, name)) is not None],
        "more": names[_MOST_FACTORS:],
        "drawn": len(subject.runs),
        "good": subject.good,
        "measured": subject.measured,
    }
    return Section("runs", "Every run", "Runs", "sweep/runs.html", context)


def note(subject: Subject, run: DrawnRun) -> str:
    """What a run is, in words: number, recording, values of what was varied."""
    values = [f"{name} = {subject.value(value)}" for name, value in run.values.items()]
    best = ["best fit of its source"] if run.best else []
    return ", ".join([f"run {run.number}", run.where, *values, *best])


def by_source(runs: Sequence[DrawnRun]) -> dict[str, list[DrawnRun]]:
    """Runs by source, in the order of their first."""
    found: dict[str, list[DrawnRun]] = {}
    for one in runs:
        found.setdefault(one.source, []).append(one)
    return found


def cloud(subject: Subject, source: str, runs: Sequence[DrawnRun], x: Sequence[float], output: str) -> Trace:
    """Runs of one source as points that tell what they are."""
    look = look_of(source)
    return Trace(
        source, Look(look.label, look.colour, None, _DOT, look.layer), x, [getattr(one, output) for one in runs],
        dots=True, notes=[note(subject, one) for one in runs],
    )  # fmt: skip


def positive(runs: Sequence[DrawnRun], output: str) -> list[DrawnRun]:
    """Runs with an error: CAM has none against itself."""
    return [one for one in runs if getattr(one, output) > 0.0]


def _with(subject: Subject, name: str) -> list[DrawnRun]:
    return [one for one in subject.runs if name in one.values]


def _x(runs: Sequence[DrawnRun], name: str) -> list[float]:
    return [float(one.values[name]) for one in runs]


def _unit(subject: Subject, name: str) -> str:
    factors = chain.from_iterable(subject.plan.spec.factors.values())
    return next(one.unit for one in factors if one.name == name)


def chart(subject: Subject, name: str) -> Chart:
    """Errors over one factor as data of the page."""
    runs = _with(subject, name)
    panels = []
    for output, (label, title) in OUTPUTS.items():
        traces = []
        for source, own in by_source(positive(runs, output)).items():
            traces.append(cloud(subject, source, own, _x(own, name), output))
        best = [one for one in positive(runs, output) if one.best] if output == "error_measured" else []
        if best:
            y = [one.error_measured for one in best]
            notes = [f"{label_of(one.source)}, {note(subject, one)}" for one in best]
            traces.insert(0, Trace("best", BEST, _x(best, name), y, dots=True, notes=notes))
        if traces:
            panels.append(Panel(label, "m", traces, log=True, title=title))
    log_x = logarithmic(subject.plan, name)
    return Chart(f"runs-{name}", panels, x_label=name, x_unit=_unit(subject, name), log_x=log_x)


@plots.style()
def drawn(subject: Subject, name: str) -> Figure:
    """The same as a still picture."""
    runs = _with(subject, name)
    figure = plots.drawing(2.9)
    for axes, (output, (_, title)) in zip(figure.subplots(1, 2), OUTPUTS.items(), strict=True):
        kept = positive(runs, output)
        for source, own in by_source(kept).items():
            look = look_of(source)
            axes.plot(
                _x(own, name), [getattr(one, output) for one in own], "o", color=look.colour, markersize=3.5,
                markeredgewidth=0.0, alpha=0.6, rasterized=True, label=look.label, zorder=look.layer,
            )  # fmt: skip
        best = [one for one in kept if one.best] if output == "error_measured" else []
        if best:
            axes.plot(
                _x(best, name), [one.error_measured for one in best], "o", markersize=8, markerfacecolor="none",
                markeredgecolor=BEST.colour, label=BEST.label, zorder=BEST.layer,
            )  # fmt: skip
        unit = _unit(subject, name)
        axes.set(xlabel=f"{name} [{unit}]" if unit else name, ylabel=f"{title} [m]")
        axes.margins(0.08)
        if kept:
            plots.scaled(axes, "y", [getattr(one, output) for one in kept])
            axes.legend(loc="best")
        if logarithmic(subject.plan, name):
            plots.scaled(axes, "x", _x(runs, name))
    return figure


def _picture(subject: Subject, name: str) -> plots.Picture | None:
    made = chart(subject, name)
    if not made.panels:
        return None
    with plots.style():
        unit = _unit(subject, name)
        caption = (
            f"Errors in m of every run over `{name}`{f' in {unit}' if unit not in ('', '1') else ''}, one point a run; "
            "the run with the smallest RMS error of each model or engine is ringed."
        )
        return plots.picture(drawn(subject, name), f"Errors of every run over {name}", caption, made)
