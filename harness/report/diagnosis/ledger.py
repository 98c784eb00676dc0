"""Sections on what was fitted: rivals in place of each effect found, and the ledger of all hypotheses in order."""

import math

from harness.failures import Part
from harness.formatting import fixed
from harness.identify.estimate.fit import Estimator
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Line
from harness.identify.verdict import IdentifiedEffect
from harness.report.diagnosis.account import Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table, texts

_MAX_ROWS = 6  # per table
_MAX_DIFFERENCE = 1000.0  # of the criterion: what is so much worse tells nothing of the effect found


def rivals(account: Account) -> Section | None:
    """Hypotheses with another effect or spline term in place of each one found; `None` if nothing was found."""
    if not account.changed:
        return None
    tables = [_of_effect(account, one) for one in account.diagnosis.effects]
    if account.diagnosis.found.terms.spline is not None:
        tables += _of_spline(account)
    settings = account.diagnosis.problem.settings
    context = {
        "tables": [table for table in tables if table.rows],
        "near": f"{settings.rival:g}",
        "near_errors": f"{100.0 * settings.held_out_rival:g}",
        "by_errors": account.diagnosis.found.estimator is Estimator.FREE_RUNS,
    }
    return Section("rivals", "Rivals", "Rivals", "diagnosis/rivals.html", context)


def _of_effect(account: Account, effect: IdentifiedEffect) -> Table:
    found = account.diagnosis.found
    rest = {name for name in found.hypothesis.names if name != effect.name}
    others = {
        one.title: one
        for one in account.diagnosis.ledger
        if one.title not in found.hypothesis.names
        and set(one.beside) == rest
        and one.fit.hypothesis.spline is None
        and one.fit.estimator is found.estimator
    }
    beside = f" beside {', '.join(f'`{name}`' for name in sorted(rest))}" if rest else ""
    return _table(account, f"In place of `{effect.name}`{beside}", list(others.values()))


def _of_spline(account: Account) -> list[Table]:
    """Other spline terms, and effects of the catalogue where the spline term stands now."""
    ledger = account.diagnosis.ledger
    splines = [one for one in ledger if one.rule is Rule.SPLINE]
    others = [one for one in splines if _differs(account, one)]
    before = {one.beside for one in splines}
    effects = [one for one in ledger if one.beside in before and one.fit.hypothesis.spline is None]
    beside = ", ".join(f"`{name}`" for name in sorted({name for one in before for name in one}))
    ending = f", in addition to {beside}" if beside else ""
    return [
        _table(account, f"Another spline term in its place{ending}", others),
        _table(account, f"An effect of the catalogue in its place{ending}", effects),
    ]


def _differs(account: Account, one: Line) -> bool:
    """Whether a spline term is of another kind than the one found, which may have more or fewer nodes."""
    ours, theirs = account.diagnosis.found.hypothesis.spline, one.fit.hypothesis.spline
    return not one.kept and (ours is None or theirs is None or ours.kind != theirs.kind)


def _table(account: Account, caption: str, others: list[Line]) -> Table:
    """How far the others are behind, in BIC, or in held-out errors where these decided."""
    found, criterion = account.diagnosis.found, Criterion(account.diagnosis.problem.settings)
    by_errors = found.estimator is Estimator.FREE_RUNS

    def behind(one: Line) -> float:
        return criterion.gain(found, one.fit)

    rows = []
    for one in sorted((one for one in others if behind(one) < _MAX_DIFFERENCE), key=behind)[:_MAX_ROWS]:
        told = "no" if criterion.rivals(one.fit, found) else "yes"
        size = fixed(100.0 * math.expm1(behind(one)), 0) if by_errors else fixed(behind(one), 1)
        rows.append((f"`{one.title}`", str(len(one.fit.theta)), size, told))
    parameters = Column("parameters", hint="fitted parameters")
    above = "held-out error above what was found [%]" if by_errors else "BIC above what was found"
    return Table(caption, [*texts("instead"), parameters, above, *texts("told apart")], rows)


def ledger(account: Account) -> Section:
    """All hypotheses tried, in order, and whether each was kept."""
    lines = account.diagnosis.ledger
    rows = [
        Row(
            (
                f"`{one.title}`",
                ", ".join(f"`{name}`" for name in one.beside) or "the model as declared",
                fixed(one.gain, 1),
                "kept" if one.kept else "",
                one.because,
                f"`{recorded.hash[:8]}`",
            ),
            "best" if one.kept else "",
        )
        for one, recorded in zip(lines, account.record.ledger, strict=True)
    ]
    columns = [
        *texts("tried", "in addition to"),
        Column("gain", hint="decrease of the criterion"),
        *texts("kept", "reason"),
        Column("hash", text=True, hint="of the entry in diagnosis.json, first eight digits"),
    ]
    context = {
        "attempts": len(lines),
        "kept": sum(one.kept for one in lines),
        "table": Table("All entries", columns, rows),
        "failed": [str(one) for one in account.diagnosis.failures if one.part in (Part.CANDIDATE, Part.SEARCH)],
        "replay": account.replay,
    }
    return Section("ledger", "Ledger", "Ledger", "diagnosis/ledger.html", context)
