"""First screen: the answer in words, one picture, one table."""

from __future__ import annotations

import math
from collections.abc import Sequence

from harness.errors import EngineFailure
from harness.formatting import aligned, brief, fixed, plus_minus
from harness.metrics import Score
from harness.recording.findings import Finding
from harness.report.answer import answer
from harness.report.comparison.overlay import overlay
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import swatch
from harness.report.standing import Standing
from harness.report.tables import Column, Row, Table


def section(subject: Subject) -> Section:
    """The answer."""
    study = subject.study
    warnings, others = _warnings(subject)
    return Section(
        "answer",
        "Which model to trust",
        "Answer",
        "comparison/result.html",
        {
            "sentences": answer(study),
            "failures": [str(failure) for failure in _first_of_each(study.failures)],
            "failed_runs": len(study.failures),
            "warnings": warnings,
            "other_warnings": others,
            "picture": overlay(subject, study.headline),
            "table": _table(subject),
            "caveats": _caveats(subject),
        },
    )


def _warnings(subject: Subject) -> tuple[list[Finding], int]:
    """The warnings that touch this recording, and how many there are of the case's other recordings."""
    setting = subject.study.setting
    elsewhere = tuple(name for name in setting.case.recordings if name != setting.recording.name)
    warnings = [one for one in setting.case.findings if one.severity == "warning"]
    here = [one for one in warnings if not one.where.startswith(elsewhere)]
    return here, len(warnings) - len(here)


def _table(subject: Subject) -> Table:
    study, headline = subject.study, subject.study.headline
    scores = [study.score_of(one.source, headline) for one in subject.ranked]
    tube = f"{1e3 * scores[0].tolerance_m:g}"
    columns = [
        Column("source", text=True),
        Column("RMS error", "mm", hint="RMS of e_s = model − recording, ± standard error over the windows"),
        Column("largest", "mm", hint="largest |e_s|"),
        Column("at the end", "mm", hint="median over the runs of |e_s| at their end"),
        Column(
            "fit",
            "%",
            hint="100 (1 − ‖e_s‖/‖s − mean s‖): 100 is perfect, below 0 worse than a ball that stays in place",
        ),
        Column("largest velocity error", "mm/s"),
        Column("late by", "ms", hint="shift of highest correlation"),
        Column(f"outside ± {tube} mm", "%"),
        Column("E/u_val", hint="RMS of error over validation uncertainty (ASME V&V 20), about 1 for a perfect model"),
        Column("ISO 18571", hint="overall rating of ISO/TS 18571:2014, 1 is perfect"),
        Column("beside the closest", text=True),
    ]
    numbers = zip(
        _errors(scores),
        aligned([1e3 * one.max_error_m for one in scores]),
        aligned([one.end_error_median_mm for one in scores]),
        [fixed(one.fit_percent, 1 if abs(one.fit_percent) < 1000 else 0) for one in scores],
        aligned([1e3 * one.max_velocity_error_m_s for one in scores]),
        [fixed(one.lag_ms, 0) for one in scores],
        [fixed(100.0 * one.fraction_outside_tube, 0) for one in scores],
        aligned([one.rms_error_over_uncertainty for one in scores], 2),
        [fixed(one.iso18571_rating, 2) for one in scores],
        strict=True,
    )
    rows = []
    for standing, cells in zip(subject.ranked, numbers, strict=True):
        failed = bool(study.run_of(standing.source, headline).failures)
        kind = "failed" if failed else "best" if standing.same else ""
        rows.append(Row((swatch(standing.source), *cells, _beside(standing, failed, subject)), kind))
    runs = f"{scores[0].windows} runs" if scores[0].windows > 1 else "one run"
    return Table(f"Position errors {subject.over(headline)} ({runs}, {scores[0].samples} samples)", columns, rows)


def _errors(scores: list[Score]) -> list[str]:
    if all(math.isnan(one.rms_error_standard_error_mm) for one in scores):
        return aligned([one.rms_error_mm for one in scores])
    return [plus_minus(one.rms_error_mm, one.rms_error_standard_error_mm) for one in scores]


def _beside(standing: Standing, failed: bool, subject: Subject) -> str:
    if failed:
        return "failed"
    if standing.source == subject.ranked[0].source:
        return "closest"
    if standing.same:
        return "same motion"
    return "worse" if standing.separated else "not told apart"


def _caveats(subject: Subject) -> list[str]:
    """What a reader has to keep in mind, in the order of weight."""
    setting = subject.study.setting
    said: list[str] = []
    if subject.simulated:
        said.append(f"The recording is simulated, not measured ({setting.case.origin}).")
    if setting.fitted is not None:
        said.append(
            "Parts of the rig are not documented and were estimated from these recordings (see Inputs): errors "
            "are those of the best rig of this kind, not of a prediction from known quantities."
        )
    if setting.case.declared:
        names = ", ".join(one.name.replace("_", " ") for one in setting.case.declared)
        said.append(f"Declared to act, and so in every model and engine: {names}.")
    coefficient, speed = setting.rig.friction_coefficient, 1e3 * setting.rig.transition_velocity
    said.append(
        f"The friction models run with the paper's f_b = {brief(coefficient)} and v_t = {brief(speed)} mm/s, "
        "fitted there to another rig; what each reading can do at its best stands under Ablation."
    )
    return said


def _first_of_each(failures: Sequence[EngineFailure]) -> list[EngineFailure]:
    """One failure an engine: the first."""
    return list({failure.engine: failure for failure in reversed(failures)}.values())[::-1]
