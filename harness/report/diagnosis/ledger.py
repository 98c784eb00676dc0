"""Section with the ledger: all fitted hypotheses in order, and whether each was kept."""

from __future__ import annotations

from harness.formatting import fixed
from harness.report.diagnosis.account import Account
from harness.report.page import Section
from harness.report.tables import Column, Row, Table


def section(account: Account) -> Section:
    """The ledger."""
    ledger = account.diagnosis.ledger
    context = {
        "attempts": len(ledger),
        "kept": sum(one.kept for one in ledger),
        "table": _table(account),
        "replay": account.replay,
    }
    return Section("ledger", "Ledger", "Ledger", "diagnosis/ledger.html", context)


def _table(account: Account) -> Table:
    columns = [
        Column("tried", text=True),
        Column("in addition to", text=True),
        Column("gain", hint="decrease of the criterion"),
        Column("kept", text=True),
        Column("reason", text=True),
        Column("hash", text=True, hint="of the entry in diagnosis.json, first eight digits"),
    ]
    rows = [
        Row(
            (
                f"`{one.title}`",
                ", ".join(f"`{name}`" for name in one.beside) or "the model as declared",
                fixed(one.gain, 1),
                "kept" if one.kept else "",
                one.because,
                f"`{line.hash[:8]}`",
            ),
            "best" if one.kept else "",
        )
        for one, line in zip(account.diagnosis.ledger, account.record.ledger, strict=True)
    ]
    return Table("All entries", columns, rows)
