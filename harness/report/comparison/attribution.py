"""Why each engine is off: its step size, its contact model, or physics that no model here has."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter

from harness.comparison.attribution import Attribution
from harness.formatting import length, number, percent
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import label_of, swatch
from harness.report.plots import WIDTH, Picture, picture, style
from harness.report.tables import Column, Row, Table

_PARTS = {
    "numerical": ("step size", "#0072B2", "engine − engine at dt → 0"),
    "contact": ("contact model", "#E69F00", "engine at dt → 0 − CAM"),
    "physics": ("physics no model has", "#882255", "CAM − recording"),
}
_SEEN = 1e-9  # shorter lengths are not drawn [m]


def section(subject: Subject) -> Section | None:
    """The attribution of each engine whose free runs succeeded."""
    parts = subject.study.attributions
    if not subject.study.engines:
        return None
    split = {one.source for one in parts}
    context = {
        "table": _table(parts) if parts else None,
        "picture": _picture(subject, parts) if parts else None,
        "missing": [label_of(engine.name) for engine, _ in subject.study.engines if engine.name not in split],
        "duration": subject.duration,
    }
    return Section(
        "attribution", "Where the engines' errors come from", "Attribution", "comparison/attribution.html", context
    )


def _table(parts: tuple[Attribution, ...]) -> Table:
    columns = [Column("engine", text=True), Column("step", "ms")]
    for title, _, formula in _PARTS.values():
        columns += [Column(title, "RMS", hint=formula), Column("share", hint="of the mean square error")]
    columns.append(Column("sum", "RMS"))
    rows = []
    for one in parts:
        rms, shares = one.rms(), one.shares()
        cells = [cell for name in _PARTS for cell in (length(rms[name]), _share(shares[name]))]
        rows.append(Row((swatch(one.source), number(1e3 * one.time_step), *cells, length(rms["total"]))))
    return Table(
        "Parts of each engine's error over the whole free run; they add up to it without remainder", columns, rows
    )


def _share(value: float) -> str:
    return "< 0.1 %" if abs(value) < 5e-4 else percent(value)


def _picture(subject: Subject, parts: tuple[Attribution, ...]) -> Picture:
    time = subject.study.setting.time
    with style():
        figure = Figure(figsize=(WIDTH, 3.2), layout="constrained")
        grid = figure.subplots(1, len(parts), sharey=True, squeeze=False)[0]
        highest = _SEEN
        for axes, one in zip(grid, parts, strict=True):
            axes.set_yscale("log")
            axes.yaxis.set_major_locator(FixedLocator([1e-9, 1e-6, 1e-3, 1.0]))
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: length(value, 1)))
            axes.yaxis.set_minor_locator(FixedLocator([]))
            for name, (title, colour, _) in _PARTS.items():
                size = np.where(one.use, np.abs(getattr(one, name)), np.nan)
                highest = max(highest, float(np.nanmax(size)))
                axes.plot(time, np.maximum(size, _SEEN), color=colour, linewidth=1.2, label=title)
            axes.set_title(label_of(one.source))
            axes.set_xlabel("time [s]")
            axes.set_xlim(time[0], time[-1])
        grid[0].set_ylim(_SEEN, 3.0 * highest)
        grid[0].set_ylabel("size of each part")
        handles, labels = grid[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=3)
        alt = (
            "Size of the numerical, contact and physics parts of the error of "
            f"{', '.join(label_of(p.source) for p in parts)}."
        )
        caption = "Size of the three parts over the whole free run, logarithmic: what lies decades below cannot matter."
        return picture(figure, alt, caption)
