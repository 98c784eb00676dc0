"""Baselines: whether the model predicts better than models that know no physics of a rolling ball."""

from __future__ import annotations

from collections.abc import Sequence

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
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.page import Section
from harness.report.tables import Row, Table, texts

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
    margins = {name: margin for name in BASELINES if (margin := compared.margin(name)) is not None}
    if len(margins) < len(BASELINES):
        return "There are too few windows for a comparison."
    sure = [name for name, margin in margins.items() if margin.sure]
    ahead = [name for name, margin in margins.items() if margin.value > 0.0]
    if len(sure) == len(BASELINES):
        return "The model predicts better than both baselines, beyond what the choice of windows may do."
    if len(ahead) == len(BASELINES):
        unsure = _all_but(sure)
        return f"The model predicts better than both baselines, but so few windows do not make it sure of the {unsure}."
    return f"The model predicts no better than the {_all_but(ahead)}: what acts on this rig is not described by it."


def _all_but(names: Sequence[str]) -> str:
    """The baselines that are not among `names`."""
    return " and the ".join(_TITLES[name].split(",")[0] for name in BASELINES if name not in names)


def _table(compared: BaselineComparison) -> Table:
    rows = []
    for name, errors in compared.errors.items():
        margin = compared.margin(name) if name in BASELINES else None
        judged = (NONE, NONE)
        if margin is not None:
            judged = length(margin.value), f"{length(margin.low)} … {length(margin.high)}"
        won = f"{compared.won(name)} of {compared.windows}" if name in BASELINES else NONE
        row = (_TITLES[name], length(compared.rms(name)), length(float(np.median(errors))), *judged, won)
        rows.append(Row(row, "best" if name == min(compared.errors, key=compared.rms) else ""))
    columns = [
        *texts("model"), "RMS error", "median of windows", "improvement with the effects found", "95 % interval",
        "windows with smaller error",
    ]  # fmt: skip
    return Table("Held-out predictions", columns, rows)
