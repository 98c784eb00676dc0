"""Baselines: whether the model predicts better than models that know no physics of a rolling ball."""

from collections.abc import Mapping, Sequence

import numpy as np

from harness.formatting import NONE, brief, listed, number
from harness.identify.problem.windows import AHEAD, KNOWN
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BASELINES,
    BEFORE,
    FORECASTS,
    BaselineComparison,
)
from harness.report.diagnosis.account import FOUND, MODEL, Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table, texts
from harness.report.wording import fitted_numbers, words

TITLES: Mapping[str, str] = {
    BEFORE: MODEL.label,
    AFTER: FOUND.label,
    FORECASTS: "fitted to forecasts, for predictions alone",
    "at_rest": "ball at rest",
    "constant_velocity": "ball at constant velocity",
    "double_integrator": "double integrator, s̈ = k (α + α₀)",
    "output_error_2": "output-error model of order 2, a black box fitted to the forecast",
    "output_error_3": "output-error model of order 3, a black box fitted to the forecast",
}
"""What each source of the comparison is called."""


def section(account: Account) -> Section | None:
    """The baselines; `None` where nothing was long enough to be predicted."""
    compared = account.diagnosis.baselines
    if compared is None:
        return None
    context = {
        "answer": _answer(compared),
        "worse": compared.rms(AFTER) > compared.rms(BEFORE),
        "tried": FORECASTS in compared.errors,
        "used": compared.predicting == FORECASTS,
        "fitted": fitted_numbers(account.diagnosis),
        "found": bool(account.diagnosis.effects),
        "common": [words(name) for name in _common(account)],
        "known": brief(KNOWN),
        "ahead": brief(AHEAD),
        "blocks": compared.blocks,
        "table": _table(compared),
    }
    return Section("baselines", "Baselines", "Baselines", "diagnosis/baselines.html", context)


def _common(account: Account) -> Sequence[str]:
    """Effects that predictions use though they were not found."""
    diagnosis = account.diagnosis
    if diagnosis.forecasting is None:
        return ()
    return [name for name in diagnosis.forecasting.hypothesis.names if name not in diagnosis.found.hypothesis.names]


def short_title(name: str) -> str:
    """The title of a source without its explanation."""
    return TITLES[name].split(",")[0]


def _answer(compared: BaselineComparison) -> str:
    """Whether all are beaten, in words."""
    margins = {name: margin for name in BASELINES if (margin := compared.margin(name)) is not None}
    if len(margins) < len(BASELINES):
        return "There are too few blocks for a comparison."
    sure = [name for name, margin in margins.items() if margin.sure]
    ahead = [name for name, margin in margins.items() if margin.value > 0.0]
    if len(sure) == len(BASELINES):
        return "The model predicts better than all baselines, beyond what the choice of blocks may do."
    if len(ahead) == len(BASELINES):
        unsure = _all_but(sure)
        return f"The model predicts better than all baselines, but so few blocks do not make it sure of the {unsure}."
    return f"The model predicts no better than the {_all_but(ahead)}: what acts on this rig is not described by it."


def _all_but(names: Sequence[str]) -> str:
    """The baselines that are not among `names`."""
    return listed([short_title(name) for name in BASELINES if name not in names])


def _table(compared: BaselineComparison) -> Table:
    """One row a source, all lengths in the same unit."""

    def mm(value: float) -> str:
        return number(1e3 * value, 3)

    rows = []
    for name, errors in compared.errors.items():
        margin = compared.margin(name) if name in BASELINES else None
        judged = (NONE, NONE) if margin is None else (mm(margin.value), f"{mm(margin.low)} … {mm(margin.high)}")
        won = f"{compared.won(name)} of {compared.blocks}" if name in BASELINES else NONE
        row = (TITLES[name], mm(compared.rms(name)), mm(float(np.median(errors))), *judged, won)
        rows.append(Row(row, "best" if name == min(compared.errors, key=compared.rms) else ""))
    columns = [
        *texts("model"), Column("RMS error", "mm"), Column("median of blocks", "mm"),
        Column("improvement by the model", "mm"), Column("95 % interval", "mm"), "blocks with smaller error",
    ]  # fmt: skip
    return Table("Held-out predictions", columns, rows)
