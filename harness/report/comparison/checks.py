"""Tolerance checks: each limit, what was found, how much room is left."""

from __future__ import annotations

from markupsafe import Markup

from harness.formatting import fixed, number
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import swatch
from harness.report.tables import Column, Row, Table


def section(subject: Subject) -> Section | None:
    """The checks, if any were asked for."""
    if not subject.checks:
        return None
    columns = [
        Column("source", text=True),
        Column("horizon", text=True),
        Column("metric", text=True),
        Column("value"),
        Column("limit"),
        Column("unit", text=True),
        Column("room left", "%"),
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
                    *(("good", "kept") if one.passed else ("bad", "missed"))
                ),
            ),
            "" if one.passed else "failed",
        )
        for one in sorted(subject.checks, key=lambda one: one.passed)
    ]
    missed = sum(not one.passed for one in subject.checks)
    text = f"{missed} of {len(rows)} limits are missed" if missed else f"All {len(rows)} limits are kept"
    table = Table(f"{text}; the missed ones come first.", columns, rows)
    return Section("checks", "Tolerances", "Checks", "comparison/checks.html", {"table": table})
