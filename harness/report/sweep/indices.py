"""Section: Sobol' indices, which parameter matters."""

from __future__ import annotations

import numpy as np

from harness.formatting import fixed, listed
from harness.report.chart import Chart, Panel, Trace
from harness.report.page import Section
from harness.report.palette import INK, Look, label_of, look_of
from harness.report.plots import Picture, drawing, picture, style
from harness.report.sweep.subject import Subject
from harness.report.tables import Table, texts
from harness.sweeps.indices import Indices
from harness.sweeps.results import MEASURED

_MOST_PICTURES = 6
_ORDERS = {"first": "first order: alone", "total": "total: with others"}
_APART = 0.28  # of a row, between its two indices
_MARK = 3.0  # width of a point's look [px]


def section(subject: Subject) -> Section | None:
    """Indices of every output; nothing where none were asked for."""
    if not subject.results.indices:
        return None
    drawn = [one for one in subject.results.indices if one.factors]
    return Section(
        "indices",
        "Which parameter matters",
        "Parameters",
        "sweep/indices.html",
        {
            "tables": tables(subject),
            "pictures": [_picture(subject, number, one) for number, one in enumerate(drawn[:_MOST_PICTURES])],
            "without": without(subject),
            "remarks": [remark for one in drawn for remark in _remarks(subject, one)],
        },
    )


def _remarks(subject: Subject, one: Indices) -> list[str]:
    """What to know of the indices of one output: samples left out, and values that no share of a variance has."""
    made = []
    if one.dropped:
        made.append(
            f"{_title(subject, one)}: {one.dropped} of {one.base_samples} samples of the design (`size`) left out, "
            "because a run of theirs failed."
        )
    beyond = [each.factor for each in one.factors if max(each.first, each.total) > 1.0]
    if beyond:
        made.append(
            f"{_title(subject, one)}: an index of {listed([f'`{name}`' for name in beyond])} is above 1, which no "
            f"share is: {one.base_samples} samples of the design leave it that uncertain; sweep more of them (`size`)."
        )
    return made


def without(subject: Subject) -> list[str]:
    """Outputs without indices, and why."""
    return [
        f"{_title(subject, one)}: no Sobol' indices, because {one.reason}."
        for one in subject.results.indices
        if one.reason
    ]


def tables(subject: Subject) -> list[Table]:
    """One an output, one row a factor."""
    made = []
    for one in subject.results.indices:
        if one.factors:
            rows = [
                (f"`{each.factor}`", _with(each.first, each.first_half), _with(each.total, each.total_half))
                for each in one.factors
            ]
            columns = [*texts("quantity"), "first order [1]", "total [1]"]
            made.append(Table(f"Sobol' indices: {_title(subject, one)}", columns, rows))
    return made


def _with(value: float, half: float) -> str:
    return f"{fixed(value, 3)} ± {fixed(half, 3)}"


def _title(subject: Subject, one: Indices) -> str:
    output = (
        f"RMS error against the {subject.measured} positions"
        if one.output == MEASURED
        else "largest difference from CAM"
    )
    values = ", ".join(f"{name} = {subject.value(value)}" for name, value in one.listed.items())
    return f"{label_of(one.source)}, {output}" + (f" ({values})" if values else "")


def chart(subject: Subject, number: int, one: Indices) -> Chart:
    """Indices of one output as data of the page, one row a factor: its total index below that of first order."""
    look = look_of(one.source)
    traces = []
    for key, colour, down in (("first", look.colour, 0.0), ("total", INK, _APART)):
        values = [getattr(each, key) for each in one.factors]
        halves = [getattr(each, f"{key}_half") for each in one.factors]
        places = -np.arange(len(one.factors)) - down
        names = [each.factor for each in one.factors]
        shown = Look(_ORDERS[key], colour, None, _MARK)
        traces.append(Trace(f"{key} order", shown, values, places, dots=True, notes=names, spread=halves))
    panel = Panel("quantity", "", traces, zero=True, rows=[each.factor for each in one.factors])
    return Chart(f"indices-{number}", [panel], "share of the error's variance", "1")


@style()
def _picture(subject: Subject, number: int, one: Indices) -> Picture:
    figure = drawing(1.0 + 0.42 * len(one.factors))
    axes = figure.subplots()
    places = np.arange(len(one.factors), dtype=float)[::-1]
    look = look_of(one.source)
    for shift, face, name in ((0.17, look.colour, "first"), (-0.17, "white", "total")):
        values = [getattr(each, name) for each in one.factors]
        halves = [getattr(each, f"{name}_half") for each in one.factors]
        axes.barh(
            places + shift, values, 0.3, xerr=halves, color=face, edgecolor=look.colour, ecolor=INK,
            label=_ORDERS[name],
        )  # fmt: skip
    axes.set_yticks(places, [each.factor for each in one.factors])
    axes.axvline(0.0, color=INK, linewidth=0.8)
    axes.set_xlabel("share of the error's variance [1]")
    figure.legend(loc="outside upper right", ncols=2)
    return picture(
        figure,
        f"Sobol' indices of {len(one.factors)} quantities",
        f"{_title(subject, one)}: share of its variance that each quantity explains, alone (first order, above) and "
        "with the others (total, below). Lines: 95 % intervals.",
        chart(subject, number, one),
    )
