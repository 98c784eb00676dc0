"""Yardsticks: whether the model predicts better than models that know next to nothing."""

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
    """The yardsticks; `None` where nothing was long enough to be predicted."""
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
    return Section("yardsticks", "Yardsticks", "Yardsticks", "diagnosis/baselines.html", context)


def _answer(contest: Contest) -> str:
    """Whether both are beaten, in words."""
    margins = {name: contest.margin(name) for name in YARDSTICKS}
    if any(margin is None for margin in margins.values()):
        return "There are too few windows to say who predicts better."
    sure = [name for name, margin in margins.items() if margin is not None and margin.sure]
    ahead = [name for name, margin in margins.items() if margin is not None and margin.value > 0.0]
    if len(sure) == len(YARDSTICKS):
        return "The model predicts better than both yardsticks, beyond what the choice of windows may do."
    if len(ahead) == len(YARDSTICKS):
        unsure = " and the ".join(_TITLES[name].split(",")[0] for name in YARDSTICKS if name not in sure)
        return (
            f"The model predicts better than both yardsticks, but so few windows do not make it sure of the {unsure}."
        )
    behind = " and the ".join(_TITLES[name].split(",")[0] for name in YARDSTICKS if name not in ahead)
    return f"The model predicts no better than the {behind}: what acts on this rig is not described by it."


def _table(contest: Contest) -> Table:
    columns = [
        Column("predicted by", text=True),
        Column("RMS error"),
        Column("median of windows"),
        Column("with what was found is better by"),
        Column("95 % interval"),
        Column("in windows"),
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
