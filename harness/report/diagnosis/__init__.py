"""The report of `harness diagnose`: missing physics of the model. Each section is a module listed in `SECTIONS`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from harness.identify.diagnosis import Diagnosis
from harness.identify.record import DiagnosisRecord
from harness.parallel import side_by_side
from harness.recording import Case
from harness.report.diagnosis import (
    baselines,
    errors,
    experiment,
    inputs,
    ledger,
    residual_acceleration,
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
    ledger.rivals,
    experiment.section,
    ledger.ledger,
    inputs.section,
)
"""In the order of the page; a section that does not apply returns `None`."""


def render_diagnosis(
    diagnosis: Diagnosis, record: DiagnosisRecord, case: Case, *, command: str = "", replay: str = "", jobs: int = 1
) -> str:
    """The diagnosis report as HTML text.

    Args:
        diagnosis: what is reported.
        record: as written to diagnosis.json.
        case: what was handed in.
        command: what repeats the diagnosis; empty if it is not known.
        replay: what replays its ledger; likewise.
        jobs: processes to draw in (`harness.parallel`); 1 for this one.
    """
    account = Account(diagnosis, record, case, command, replay)
    made = side_by_side([partial(section, account) for section in SECTIONS], jobs)
    return render_page(
        f"Ball and beam: diagnosis of {case.name}",
        [section for section in made if section is not None],
        subtitle=account.subtitle,
        badges=[Badge("simulated data", "warning")] if case.simulated else [],
    )
