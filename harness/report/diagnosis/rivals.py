"""Section on rivals: hypotheses with another effect or spline term in place of each one found."""

from __future__ import annotations

from harness.formatting import fixed
from harness.identify.estimate.fit import INFLATION
from harness.identify.selection.candidates import Entry
from harness.identify.verdict import RIVAL, Finding
from harness.report.diagnosis.account import Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table

_MAX_ROWS = 6  # per table
_MAX_DIFFERENCE = 1000.0  # of the criterion; worse hypotheses were screened but not fitted


def section(account: Account) -> Section | None:
    """The section; `None` if nothing was found."""
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
    beside = f" in addition to {', '.join(f'`{name}`' for name in sorted(rest))}" if rest else ""
    return _table(account, f"Instead of `{finding.name}`{beside}", list(others.values()))


def _of_curve(account: Account) -> list[Table]:
    """Other spline terms, and effects of the catalogue, instead of the spline term."""
    ledger = account.diagnosis.ledger
    curves = [one for one in ledger if one.fit.hypothesis.shape is not None and one.effect.startswith("curve ")]
    before = {one.beside for one in curves}
    effects = [one for one in ledger if one.beside in before and one.fit.hypothesis.shape is None]
    beside = ", ".join(f"`{name}`" for name in sorted({name for one in before for name in one}))
    ending = f", in addition to {beside}" if beside else ""
    return [
        _table(account, f"Another spline term{ending}", [one for one in curves if not one.kept]),
        _table(account, f"An effect of the catalogue instead of the spline term{ending}", effects),
    ]


def _table(account: Account, caption: str, others: list[Entry]) -> Table:
    """Compares BIC for spline terms, else quasi-BIC (`Fit.score`)."""
    found = account.diagnosis.found
    curve = found.hypothesis.shape is not None

    def difference(one: Entry) -> float:
        return one.fit.bic - found.bic if curve else one.fit.score - found.score

    columns = [
        Column("alternative", text=True),
        Column("parameters", hint="fitted parameters"),
        Column(f"{'BIC' if curve else 'quasi-BIC'} difference"),
        Column("distinguishable", text=True),
    ]
    rows = []
    for one in sorted((one for one in others if difference(one) < _MAX_DIFFERENCE), key=difference)[:_MAX_ROWS]:
        told = "yes" if difference(one) >= RIVAL else "no"
        rows.append(Row((f"`{one.effect}`", str(len(one.fit.numbers)), fixed(difference(one), 1), told)))
    return Table(caption, columns, rows)
