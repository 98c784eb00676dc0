"""Every metric of every source, one table a horizon."""

from __future__ import annotations

from harness.comparison.horizons import Horizon
from harness.formatting import fixed, number
from harness.metrics import METRICS
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import label_of
from harness.report.tables import Column, Row, Table


def section(subject: Subject) -> Section:
    """All metrics."""
    headline = subject.study.headline
    others = [one for one in subject.study.setting.horizons if one is not headline]
    context = {
        "headline": _table(subject, headline),
        "others": [(one.name, _table(subject, one)) for one in others],
        "meanings": [
            (metric.name, metric.description, metric.unit, metric.better.value) for metric in METRICS.values()
        ],
    }
    return Section("metrics", "All metrics", "Metrics", "comparison/scores.html", context)


def _table(subject: Subject, horizon: Horizon) -> Table:
    scores = [subject.study.score_of(one.source, horizon) for one in subject.ranked]
    columns = [Column("metric", text=True), Column("unit", text=True)]
    columns += [Column(label_of(one.source)) for one in scores]
    rows = []
    for metric in METRICS.values():
        values = [getattr(one, metric.name) for one in scores]
        name = metric.name.removesuffix(_suffix(metric.unit)).replace("_", " ")
        rows.append(
            Row(
                (
                    name,
                    metric.unit if metric.unit != "1" else "",
                    *(fixed(v, 3) if metric.unit == "1" else number(v) for v in values),
                )
            )
        )
    rows.append(Row(("iso18571 rank", "", *(one.iso18571_rank for one in scores))))
    return Table(f"All metrics {subject.over(horizon)}", columns, rows)


def _suffix(unit: str) -> str:
    """The unit as a field's name ends in it."""
    return {"1": "", "%": "_percent"}.get(unit, "_" + unit.replace("/", "_").replace(" ", "_"))
