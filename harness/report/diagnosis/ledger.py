"""The ledger: every attempt, in the order in which it was made, and what became of it."""

from __future__ import annotations

from harness.report.diagnosis.account import Account
from harness.report.numbers import fixed
from harness.report.page import Section
from harness.report.tables import Column, Row, Table


def section(account: Account) -> Section:
    """The ledger."""
    ledger = account.diagnosis.ledger
    context = {"attempts": len(ledger), "kept": sum(one.kept for one in ledger), "table": _table(account)}
    return Section("ledger", "Ledger", "Ledger", "diagnosis/ledger.html", context)


def _table(account: Account) -> Table:
    columns = [
        Column("tried", text=True),
        Column("beside", text=True),
        Column("gain", "BIC", hint="how much lower the BIC is than without it"),
        Column("kept", text=True),
        Column("because", text=True),
    ]
    rows = [
        Row(
            (
                f"`{one.effect}`",
                ", ".join(f"`{name}`" for name in one.beside) or "the model as declared",
                fixed(one.gain, 1),
                "kept" if one.kept else "",
                one.because,
            ),
            "best" if one.kept else "",
        )
        for one in account.diagnosis.ledger
    ]
    return Table("Every attempt", columns, rows)
