"""Before and after: errors by horizon, on data that found the effects and on data that did not."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from harness.identify.verify import KNOWN, Errors
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.numbers import NONE, brief, fixed, length, number
from harness.report.page import Section
from harness.report.plots import WIDTH, Picture, picture, plain_log, style
from harness.report.tables import Column, Row, Table


def section(account: Account) -> Section:
    """Errors before and after."""
    several = len(account.diagnosis.problem.records) > 1
    context = {
        "split": "each recording in turn, with values fitted to the others"
        if several
        else "each half of the recording, with values fitted to the other",
        "known": brief(KNOWN),
        "picture": _picture(account),
        "table": _table(account),
    }
    return Section("errors", "Errors before and after", "Errors", "diagnosis/errors.html", context)


def _columns(account: Account) -> tuple[Errors, ...]:
    held, identify = account.diagnosis.heldout, account.diagnosis.identify
    return held.before, held.after, identify.before, identify.after


def _horizons(account: Account) -> list[str]:
    return list(dict.fromkeys(name for one in _columns(account) for name in one.rms))


def _table(account: Account) -> Table:
    each = _columns(account)
    columns = [
        Column("RMS error over", text=True),
        Column("held out, before"),
        Column("held out, after"),
        Column("found from, before", apart=True),
        Column("found from, after"),
    ]
    rows = [
        Row((_title(name), *(length(one.rms[name]) if name in one.rms else NONE for one in each)))
        for name in _horizons(account)
    ]
    rows.append(Row(("innovations over the reading's noise", *(number(one.ratio) for one in each))))
    rows.append(Row(("correlation of neighbouring innovations", *(fixed(one.whiteness, 3) for one in each))))
    return Table("Errors of predicted positions", columns, rows)


def _title(name: str) -> str:
    return f"the rest, from the first {brief(KNOWN)} s" if name == "whole" else f"windows of {name}"


def _picture(account: Account) -> Picture:
    names = _horizons(account)
    places = np.arange(len(names))
    lines: list[tuple[str, Mapping[str, float], str, str, str]] = []
    held, identify = account.diagnosis.heldout, account.diagnosis.identify
    for kind, both, style_, marker in (("held out", held, "-", "o"), ("found from", identify, ":", "s")):
        lines.append((f"{kind}, before", both.before.rms, MODEL.colour, style_, marker))
        lines.append((f"{kind}, after", both.after.rms, FOUND.colour, style_, marker))
    with style():
        figure = Figure(figsize=(WIDTH, 2.9), layout="constrained")
        axes = figure.add_subplot()
        for label, rms, colour, dash, marker in lines:
            values = [1e3 * rms.get(name, np.nan) for name in names]
            axes.plot(places, values, dash, color=colour, marker=marker, markersize=5, linewidth=1.6, label=label)
        noise = 1e3 * float(np.sqrt(account.diagnosis.problem.noise))
        axes.axhline(noise, color="#5b6672", linewidth=1.0, dashes=(2.0, 2.0), label="noise of a reading")
        plain_log(axes, "y")
        axes.set_xticks(places, ["the rest" if name == "whole" else name for name in names])
        axes.set_xlabel("predicted ahead")
        axes.set_ylabel("RMS error [mm]")
        figure.legend(loc="outside right upper")
        caption = "RMS error of predicted positions by how far they are predicted ahead; logarithmic."
        return picture(figure, caption, caption)
