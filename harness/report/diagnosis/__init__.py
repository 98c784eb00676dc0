"""The report of `harness diagnose`: missing physics of the model. Each section is a module listed in `SECTIONS`."""

from collections.abc import Callable, Mapping
from functools import partial

from harness.failures import Failures
from harness.identify.diagnosis import Diagnosis
from harness.identify.record import DiagnosisRecord
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
from harness.report.diagnosis import replay as replay_section
from harness.report.diagnosis.account import Account
from harness.report.page import Badge, Section, bodies_of, render_page

SECTIONS: Mapping[str, Callable[[Account], Section | None]] = {
    "verdict": verdict.section,
    "replay": replay_section.section,
    "residual_acceleration": residual_acceleration.section,
    "spline_term": spline_term.section,
    "errors": errors.section,
    "baselines": baselines.section,
    "rivals": ledger.rivals,
    "next_experiment": experiment.section,
    "ledger": ledger.ledger,
    "inputs": inputs.section,
}
"""In the order of the page; a section that does not apply returns `None`."""


def render_diagnosis(
    diagnosis: Diagnosis,
    record: DiagnosisRecord,
    case: Case,
    *,
    command: str = "",
    replay: str = "",
    jobs: int = 1,
    failures: Failures | None = None,
) -> str:
    """The diagnosis report as HTML text.

    Args:
        diagnosis: what is reported.
        record: as written to diagnosis.json.
        case: what was handed in.
        command: what repeats the diagnosis; empty if it is not known.
        replay: what replays its ledger; likewise.
        jobs: processes to draw in (`harness.parallel`); 1 for this one.
        failures: those to show at the top, to which sections that raise are added; `None` shows those of the diagnosis
            and lets a section raise.
    """
    account = Account(diagnosis, record, case, command, replay)
    bodies = bodies_of({name: partial(section, account) for name, section in SECTIONS.items()}, failures, jobs)
    badges = [Badge("simulated data", "warning")] if case.simulated else []
    failed = diagnosis.failures if failures is None else failures.all
    return render_page(
        f"Ball and beam: diagnosis of {case.name}",
        bodies,
        subtitle=account.subtitle,
        badges=[*badges, Badge("incomplete", "bad")] if failed else badges,
        failures=failed,
    )
