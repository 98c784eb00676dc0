"""Section on tolerance checks: each limit with value and margin."""

from __future__ import annotations

from markupsafe import Markup

from harness.formatting import fixed, number
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import swatch
from harness.report.tables import Column, Row, Table


def section(subject: Subject) -> Section | None:
    """The section; `None` if no checks were requested."""
    if not subject.checks:
        return None
    columns = [
        Column("source", text=True),
        Column("horizon", text=True),
        Column("metric", text=True),
        Column("value"),
        Column("limit"),
        Column("unit", text=True),
        Column("margin", "%"),
        Column("result", text=True),
    ]
    rows = [
        Row(
            (
                swatch(one.source),
                one.horizon,
                f"{one.metric}, against CAM" if one.against_cam else one.metric,
                number(one.value),
                f"{one.relation} {number(one.limit)}",
                "" if one.unit == "1" else one.unit,
                fixed(100.0 * one.margin, 0),
                Markup('<span class="badge {}">{}</span>').format(
                    *(("good", "kept") if one.passed else ("bad", "broken"))
                ),
            ),
            "" if one.passed else "failed",
        )
        for one in sorted(subject.checks, key=lambda one: one.passed)
    ]
    broken = sum(not one.passed for one in subject.checks)
    text = f"{broken} of {len(rows)} limits are broken" if broken else f"All {len(rows)} limits are kept"
    table = Table(f"{text}; broken ones come first.", columns, rows)
    return Section("checks", "Tolerances", "Checks", "comparison/checks.html", {"table": table})
