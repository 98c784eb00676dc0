"""The ledger: every attempt, in the order in which it was made, and what became of it."""

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
    lines = account.record.get("ledger")
    hashes = [str(line["hash"]) for line in lines] if isinstance(lines, list) else []
    columns = [
        Column("tried", text=True),
        Column("beside", text=True),
        Column("gain", hint="how much lower the criterion is than without it"),
        Column("kept", text=True),
        Column("because", text=True),
        Column("hash", text=True, hint="of the attempt in diagnosis.json, first eight digits"),
    ]
    rows = [
        Row(
            (
                f"`{one.title}`",
                ", ".join(f"`{name}`" for name in one.beside) or "the model as declared",
                fixed(one.gain, 1),
                "kept" if one.kept else "",
                one.because,
                f"`{hashed[:8]}`",
            ),
            "best" if one.kept else "",
        )
        for one, hashed in zip(account.diagnosis.ledger, hashes, strict=True)
    ]
    return Table("Every attempt", columns, rows)
