"""Sections of numbers: tolerance checks with value and margin, and all metrics of all sources."""

from __future__ import annotations

from markupsafe import Markup

from harness.comparison.horizons import Horizon
from harness.formatting import fixed, number
from harness.metrics import METRICS
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import label_of, swatch
from harness.report.tables import Row, Table, texts

_BADGES = {
    True: Markup('<span class="badge good">kept</span>'),
    False: Markup('<span class="badge bad">broken</span>'),
}


def checks(subject: Subject) -> Section | None:
    """Each limit; `None` if no checks were requested."""
    if not subject.checks:
        return None
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
                _BADGES[one.passed],
            ),
            "" if one.passed else "failed",
        )
        for one in sorted(subject.checks, key=lambda one: one.passed)
    ]
    broken = sum(not one.passed for one in subject.checks)
    text = f"{broken} of {len(rows)} limits are broken" if broken else f"All {len(rows)} limits are kept"
    columns = [*texts("source", "horizon", "metric"), "value", "limit", *texts("unit"), "margin [%]", *texts("result")]
    table = Table(f"{text}; broken ones come first.", columns, rows)
    return Section("checks", "Tolerances", "Checks", "comparison/checks.html", {"table": table})


def metrics(subject: Subject) -> Section:
    """All metrics, one table per horizon."""
    headline = subject.study.headline
    others = [one for one in subject.study.setting.horizons if one is not headline]
    context = {
        "headline": _metrics(subject, headline),
        "others": [(one.name, _metrics(subject, one)) for one in others],
        "meanings": [
            (metric.name, metric.description, metric.unit, metric.better.value) for metric in METRICS.values()
        ],
    }
    return Section("metrics", "All metrics", "Metrics", "comparison/scores.html", context)


def _metrics(subject: Subject, horizon: Horizon) -> Table:
    scores = [subject.study.score_of(one.source, horizon) for one in subject.ranked]
    rows = []
    for metric in METRICS.values():
        unit = "" if metric.unit == "1" else metric.unit
        # A field's name ends in its unit.
        suffix = {"": "", "%": "_percent"}.get(unit, "_" + unit.replace("/", "_").replace(" ", "_"))
        values = [getattr(one, metric.name) for one in scores]
        name = metric.name.removesuffix(suffix).replace("_", " ")
        rows.append((name, unit, *(number(value) if unit else fixed(value, 3) for value in values)))
    rows.append(("iso18571 rank", "", *(one.iso18571_rank for one in scores)))
    columns = [*texts("metric", "unit"), *(label_of(one.source) for one in scores)]
    return Table(f"All metrics {subject.over(horizon)}", columns, rows)
