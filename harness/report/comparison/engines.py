"""Did the engines behave: failures first, then what was watched during their runs, then their settings."""

from __future__ import annotations

from collections.abc import Sequence

from harness.comparison.sources import SourceRuns
from harness.engines.health import Health
from harness.formatting import fixed, length, number
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import label_of, swatch
from harness.report.tables import Column, Row, Table

_COLUMNS = [
    Column("engine", text=True),
    Column("horizon", text=True),
    Column("runs", "sound of all"),
    Column("steps"),
    Column("contacts", "fewest–most"),
    Column("least normal force", "N"),
    Column("height error"),
    Column("off the middle"),
    Column("slip", "mm/s"),
    Column("angle error", "rad"),
]


def section(subject: Subject) -> Section | None:
    """The engines' health."""
    study = subject.study
    if not study.engines:
        return None
    runs = [study.run_of(engine.name, horizon) for engine, _ in study.engines for horizon in study.setting.horizons]
    warnings = {(label_of(run.source), warning) for run in runs for health in run.health for warning in health.warnings}
    settings = [
        (label_of(engine.name), engine.version(), list(parameters.model_dump().items()))
        for engine, parameters in study.engines
    ]
    return Section(
        "engines",
        "Engines",
        "Engines",
        "comparison/engines.html",
        {
            "failures": [(run.horizon.name, str(failure)) for run in runs for failure in run.failures],
            "warnings": sorted(warnings),
            "table": Table(
                "Extremes over all runs; an unsound run is refused, never scored", _COLUMNS, [_row(r) for r in runs]
            ),
            "settings": settings,
        },
    )


def _row(run: SourceRuns) -> Row:
    sound, count = len(run.health), len(run.health) + len(run.failures)
    cells = _extremes(run.health) if run.health else ("—",) * 7
    return Row((swatch(run.source), run.horizon.name, f"{sound} of {count}", *cells), "failed" if run.failures else "")


def _extremes(health: Sequence[Health]) -> tuple[str, ...]:
    fewest, most = min(h.contacts_min for h in health), max(h.contacts_max for h in health)
    return (
        fixed(sum(h.steps for h in health), 0),
        f"{fewest}" if fewest == most else f"{fewest}–{most}",
        number(min(h.normal_force_min for h in health)),
        length(max(h.height_error_max for h in health), 2),
        length(max(h.lateral_offset_max for h in health), 2),
        number(1e3 * max(h.slip_max for h in health), 2),
        number(max(h.angle_error_max for h in health), 2),
    )
