"""Rivals: what else could have been in the place of each effect, and how much worse it predicts."""

from __future__ import annotations

from harness.formatting import fixed
from harness.identify.estimate.fit import INFLATION
from harness.identify.selection.candidates import Entry
from harness.identify.verdict import RIVAL, Finding
from harness.report.diagnosis.account import Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table

_MOST = 6  # of one table; what comes after is far behind
_FAR = 1000.0  # behind: looked at only, and not fitted


def section(account: Account) -> Section | None:
    """Rivals; none where nothing was found to have any."""
    if not account.changed:
        return None
    tables = [_of_effect(account, one) for one in account.diagnosis.findings]
    if account.diagnosis.found.best.shape is not None:
        tables += _of_curve(account)
    context = {
        "tables": [table for table in tables if table.rows],
        "near": f"{RIVAL:g}",
        "counts": fixed(INFLATION**-2, 2),
    }
    return Section("rivals", "Rivals", "Rivals", "diagnosis/rivals.html", context)


def _of_effect(account: Account, finding: Finding) -> Table:
    found = account.diagnosis.found
    rest = {name for name in found.hypothesis.names if name != finding.name}
    others = {
        one.effect: one
        for one in account.diagnosis.ledger
        if one.effect not in found.hypothesis.names and set(one.beside) == rest and one.fit.hypothesis.shape is None
    }
    beside = f" beside {', '.join(f'`{name}`' for name in sorted(rest))}" if rest else ""
    return _table(account, f"In place of `{finding.name}`{beside}", list(others.values()))


def _of_curve(account: Account) -> list[Table]:
    """Other curves, and effects of the catalogue where the curve stands now."""
    ledger = account.diagnosis.ledger
    curves = [one for one in ledger if one.fit.hypothesis.shape is not None and one.effect.startswith("curve ")]
    before = {one.beside for one in curves}
    effects = [one for one in ledger if one.beside in before and one.fit.hypothesis.shape is None]
    beside = ", ".join(f"`{name}`" for name in sorted({name for one in before for name in one}))
    ending = f", beside {beside}" if beside else ""
    return [
        _table(account, f"Another curve in its place{ending}", [one for one in curves if not one.kept]),
        _table(account, f"An effect of the catalogue in its place{ending}", effects),
    ]


def _table(account: Account, caption: str, others: list[Entry]) -> Table:
    """Beside a curve the BIC decides, else the scaled one (`Fit.score`)."""
    found = account.diagnosis.found
    curve = found.hypothesis.shape is not None

    def behind(one: Entry) -> float:
        return one.fit.bic - found.bic if curve else one.fit.score - found.score

    columns = [
        Column("instead", text=True),
        Column("numbers", hint="fitted numbers"),
        Column(f"{'BIC' if curve else 'scaled BIC'} above what was found"),
        Column("told apart", text=True),
    ]
    rows = []
    for one in sorted((one for one in others if behind(one) < _FAR), key=behind)[:_MOST]:
        told = "yes" if behind(one) >= RIVAL else "no"
        rows.append(Row((f"`{one.effect}`", str(len(one.fit.numbers)), fixed(behind(one), 1), told)))
    return Table(caption, columns, rows)
