"""The report of `harness diagnose`: what the model lacks. A section is one module and one line here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from harness.identify.diagnosis import Diagnosis
from harness.parallel import on_all_cores
from harness.recording import Case
from harness.report.diagnosis import (
    baselines,
    errors,
    experiment,
    inputs,
    ledger,
    residual_acceleration,
    rivals,
    spline_term,
    verdict,
)
from harness.report.diagnosis.account import Account
from harness.report.page import Badge, Section, render_page

SECTIONS: tuple[Callable[[Account], Section | None], ...] = (
    verdict.section,
    residual_acceleration.section,
    spline_term.section,
    errors.section,
    baselines.section,
    rivals.section,
    experiment.section,
    ledger.section,
    inputs.section,
)
"""In the order of the page; a section that has nothing to say is `None`."""


def render_diagnosis(
    diagnosis: Diagnosis, record: Mapping[str, object], case: Case, *, command: str = "", replay: str = ""
) -> str:
    """The diagnosis report as HTML text.

    Args:
        diagnosis: what is reported.
        record: as written to diagnosis.json.
        case: what was handed in.
        command: what repeats the diagnosis; empty if it is not known.
        replay: what replays its ledger; likewise.
    """
    account = Account(diagnosis, record, case, command, replay)
    made = on_all_cores([partial(section, account) for section in SECTIONS])
    return render_page(
        f"Ball and beam: diagnosis of {account.case_name}",
        [section for section in made if section is not None],
        subtitle=account.subtitle,
        badges=[Badge("simulated data", "warning")] if account.simulated else [],
    )
