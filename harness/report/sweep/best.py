"""Section: the combination of values that fits the measurement best, and how errors lie over each factor."""

from __future__ import annotations

from harness.formatting import length
from harness.report.page import Section
from harness.report.palette import label_of
from harness.report.sweep.subject import Subject
from harness.report.tables import Table, texts


def section(subject: Subject) -> Section | None:
    """Best fit of each source."""
    results = subject.results
    if not results.best:
        return None
    return Section(
        "best-fit",
        f"Best fit to the {subject.measured} positions",
        "Best fit",
        "sweep/best.html",
        {"table": table(subject), "recordings": len(subject.plan.recordings), "horizon": subject.horizon},
    )


def table(subject: Subject) -> Table:
    """One row a source."""
    rows = []
    for one in subject.results.best:
        values = (
            ", ".join(f"`{name}` = {subject.value(value)}" for name, value in one.values.items()) or "nothing varied"
        )
        rows.append(
            (
                label_of(one.source),
                length(one.error),
                length(one.largest),
                values,
                str(one.run),
                str(one.candidates),
                str(one.recordings),
            )
        )
    columns = [
        *texts("model or engine"),
        "smallest RMS error",
        "largest RMS error",
        *texts("values of the smallest"),
        "run",
        "tried",
        "recordings",
    ]
    return Table("", columns, rows)
