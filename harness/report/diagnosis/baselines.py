"""Baselines: whether the model predicts better than models that know no physics of a rolling ball."""

from __future__ import annotations

import numpy as np

from harness.formatting import NONE, brief, length
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BASELINES,
    BEFORE,
    BLACK_BOX,
    INTEGRATOR,
    BaselineComparison,
)
from harness.metrics.paired import Margin
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table

_TITLES = {
    BEFORE: MODEL.label,
    AFTER: FOUND.label,
    INTEGRATOR: "double integrator, s̈ = k (α + α₀)",
    BLACK_BOX: "output-error model of order 2",
}


def section(account: Account) -> Section | None:
    """The baselines; `None` where nothing was long enough to be predicted."""
    compared = account.diagnosis.baselines
    if compared is None:
        return None
    context = {
        "answer": _answer(compared),
        "worse": compared.rms(AFTER) > compared.rms(BEFORE),
        "known": brief(KNOWN),
        "ahead": brief(AHEAD),
        "windows": compared.windows,
        "table": _table(compared),
    }
    return Section("baselines", "Baselines", "Baselines", "diagnosis/baselines.html", context)


def _answer(compared: BaselineComparison) -> str:
    """Whether both are beaten, in words."""
    margins = {name: compared.margin(name) for name in BASELINES}
    if any(margin is None for margin in margins.values()):
        return "There are too few windows to say who predicts better."
    sure = [name for name, margin in margins.items() if margin is not None and margin.sure]
    ahead = [name for name, margin in margins.items() if margin is not None and margin.value > 0.0]
    if len(sure) == len(BASELINES):
        return "The model predicts better than both baselines, beyond what the choice of windows may do."
    if len(ahead) == len(BASELINES):
        unsure = " and the ".join(_TITLES[name].split(",")[0] for name in BASELINES if name not in sure)
        return f"The model predicts better than both baselines, but so few windows do not make it sure of the {unsure}."
    behind = " and the ".join(_TITLES[name].split(",")[0] for name in BASELINES if name not in ahead)
    return f"The model predicts no better than the {behind}: what acts on this rig is not described by it."


def _table(compared: BaselineComparison) -> Table:
    columns = [
        Column("predicted by", text=True),
        Column("RMS error"),
        Column("median of windows"),
        Column("with what was found is better by"),
        Column("95 % interval"),
        Column("in windows"),
    ]
    rows = []
    for name, errors in compared.errors.items():
        margin = compared.margin(name) if name in BASELINES else None
        judged = (length(margin.value), _interval(margin)) if margin else (NONE, NONE)
        won = f"{compared.won(name)} of {compared.windows}" if name in BASELINES else NONE
        row = (_TITLES[name], length(compared.rms(name)), length(float(np.median(errors))), *judged, won)
        rows.append(Row(row, "best" if name == min(compared.errors, key=compared.rms) else ""))
    return Table("Held-out predictions", columns, rows)


def _interval(margin: Margin) -> str:
    return f"{length(margin.low)} … {length(margin.high)}"
