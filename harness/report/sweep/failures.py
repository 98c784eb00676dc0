"""Section: failed runs by name."""

from __future__ import annotations

from harness.report.page import Section
from harness.report.palette import label_of
from harness.report.sweep.subject import Subject
from harness.report.tables import Table, texts
from harness.sweeps.results import Results


def section(subject: Subject) -> Section | None:
    """Which failures there were; nothing without any."""
    if not subject.results.failures:
        return None
    return Section(
        "failures",
        "Failed runs by name",
        "Failures",
        "sweep/failures.html",
        {"table": table(subject.results), "failed": subject.results.failed, "runs": subject.results.runs},
    )


def table(results: Results) -> Table:
    """One row a source and name."""
    rows = [
        (label_of(one.source), f"`{one.failure}`", str(one.runs), str(one.example), one.message)
        for one in results.failures
    ]
    return Table("Failures", [*texts("model or engine", "failure"), "runs", "first run", *texts("what it said")], rows)
