"""The report of `harness diagnose`: what the model lacks. A section is one module and one line here."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from harness.identify.verdict import Diagnosis
from harness.recording import Case
from harness.report.diagnosis import curve, errors, inputs, ledger, rivals, trace, verdict
from harness.report.diagnosis.account import Account
from harness.report.page import Badge, Section, render_page

SECTIONS: tuple[Callable[[Account], Section | None], ...] = (
    verdict.section,
    errors.section,
    trace.section,
    curve.section,
    rivals.section,
    ledger.section,
    inputs.section,
)
"""In the order of the page; a section that has nothing to say is `None`."""


def render_diagnosis(diagnosis: Diagnosis, record: Mapping[str, object], case: Case, *, command: str = "") -> str:
    """The diagnosis report as HTML text.

    Args:
        diagnosis: what is reported.
        record: as written to diagnosis.json.
        case: what was handed in.
        command: what repeats the diagnosis; empty if it is not known.
    """
    account = Account(diagnosis, record, case, command)
    sections = [made for section in SECTIONS if (made := section(account)) is not None]
    return render_page(
        f"Ball and beam: diagnosis of {account.case_name}",
        sections,
        subtitle=account.subtitle,
        badges=[Badge("simulated data", "warning")] if account.simulated else [],
    )
