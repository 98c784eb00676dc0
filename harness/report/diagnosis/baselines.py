"""Section comparing the model's predictions with those of two baseline models."""

from __future__ import annotations

import numpy as np

from harness.formatting import NONE, brief, length
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BEFORE,
    BLACK_BOX,
    INTEGRATOR,
    YARDSTICKS,
    Contest,
    Margin,
)
from harness.identify.validation.baselines import AHEAD
from harness.identify.validation.held_out import KNOWN
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
    """The section; `None` if the recordings are too short for prediction windows."""
    contest = account.diagnosis.contest
    if contest is None:
        return None
    context = {
        "answer": _answer(contest),
        "worse": contest.rms(AFTER) > contest.rms(BEFORE),
        "known": brief(KNOWN),
        "ahead": brief(AHEAD),
        "windows": contest.windows,
        "table": _table(contest),
    }
    return Section("baselines", "Comparison with baseline models", "Baselines", "diagnosis/baselines.html", context)


def _answer(contest: Contest) -> str:
    """Whether the model predicts better than both baselines, in words."""
    margins = {name: contest.margin(name) for name in YARDSTICKS}
    if any(margin is None for margin in margins.values()):
        return "There are too few windows for a comparison."
    sure = [name for name, margin in margins.items() if margin is not None and margin.sure]
    ahead = [name for name, margin in margins.items() if margin is not None and margin.value > 0.0]
    if len(sure) == len(YARDSTICKS):
        return "The model predicts significantly better than both baselines."
    if len(ahead) == len(YARDSTICKS):
        unsure = " and the ".join(_TITLES[name].split(",")[0] for name in YARDSTICKS if name not in sure)
        return f"The model predicts better than both baselines, but not significantly better than the {unsure}."
    behind = " and the ".join(_TITLES[name].split(",")[0] for name in YARDSTICKS if name not in ahead)
    return f"The model predicts no better than the {behind}: it does not describe this rig."


def _table(contest: Contest) -> Table:
    columns = [
        Column("model", text=True),
        Column("RMS error"),
        Column("median of windows"),
        Column("improvement with the effects found"),
        Column("95 % interval"),
        Column("windows with smaller error"),
    ]
    rows = []
    for name, misses in contest.misses.items():
        margin = contest.margin(name) if name in YARDSTICKS else None
        judged = (length(margin.value), _interval(margin)) if margin else (NONE, NONE)
        won = f"{contest.won(name)} of {contest.windows}" if name in YARDSTICKS else NONE
        row = (_TITLES[name], length(contest.rms(name)), length(float(np.median(misses))), *judged, won)
        rows.append(Row(row, "best" if name == min(contest.misses, key=contest.rms) else ""))
    return Table("Held-out predictions", columns, rows)


def _interval(margin: Margin) -> str:
    return f"{length(margin.low)} … {length(margin.high)}"
