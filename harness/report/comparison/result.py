"""First section: conclusions in words, one figure, one table."""

import math

from harness.formatting import aligned, brief, fixed, plus_minus
from harness.metrics import Score
from harness.recording.findings import DataFinding, warnings_of
from harness.report.answer import answer
from harness.report.comparison.overlay import overlay
from harness.report.comparison.subject import Subject
from harness.report.page import Section
from harness.report.palette import swatch
from harness.report.standing import Standing
from harness.report.tables import Column, Row, Table, texts


def section(subject: Subject) -> Section:
    """The answer."""
    study = subject.study
    warnings, others = _warnings(subject)
    failures = study.engine_failures
    failed_first = {failure.engine: str(failure) for failure in reversed(failures)}
    context = {
        "sentences": answer(study),
        "failures": list(failed_first.values())[::-1],
        "failed_runs": len(failures),
        "warnings": warnings,
        "other_warnings": others,
        "picture": overlay(subject, study.headline),
        "table": _table(subject),
        "caveats": _caveats(subject),
    }
    return Section("answer", "Which model to trust", "Answer", "comparison/result.html", context)


def _warnings(subject: Subject) -> tuple[list[DataFinding], int]:
    """Warnings on this recording, and the number of warnings on other recordings of the case."""
    setting = subject.study.setting
    here = warnings_of(setting.case.findings_on([setting.recording.name]))
    return list(here), len(warnings_of(setting.case.findings)) - len(here)


def _table(subject: Subject) -> Table:
    study, headline = subject.study, subject.study.headline
    scores = [study.score_of(one.source, headline) for one in subject.ranked]
    tube = f"{1e3 * scores[0].tolerance_m:g}"
    columns = [
        *texts("source"),
        Column("RMS error", "mm", hint="RMS of e_s = model − recording, ± standard error over the windows"),
        Column("largest", "mm", hint="largest |e_s|"),
        Column("at the end", "mm", hint="median over the runs of |e_s| at their end"),
        Column("fit", "%", hint="100 (1 − ‖e_s‖/‖s − mean s‖): 100 is perfect, below 0 worse than a constant"),
        "largest velocity error [mm/s]",
        Column("late by", "ms", hint="shift of highest correlation"),
        f"outside ± {tube} mm [%]",
        Column("E/u_val", hint="RMS of error over validation uncertainty (ASME V&V 20), about 1 for a perfect model"),
        Column("ISO 18571", hint="overall rating of ISO/TS 18571:2014, 1 is perfect"),
        *texts("compared with the closest"),
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
    return "worse" if standing.separated else "not distinguishable"


def _caveats(subject: Subject) -> list[str]:
    """Caveats, the most important first."""
    setting = subject.study.setting
    said: list[str] = []
    if subject.simulated:
        said.append(f"The recording is simulated, not measured ({setting.case.origin}).")
    if setting.fitted is not None:
        said.append(
            "Unknown quantities of the rig were estimated from these recordings (see Inputs): errors are those of "
            "a fitted rig, not of a prediction from known quantities."
        )
    if setting.case.declared:
        names = ", ".join(one.name.replace("_", " ") for one in setting.case.declared)
        said.append(f"Declared effects, included in every model and engine: {names}.")
    coefficient, speed = setting.rig.friction_coefficient, 1e3 * setting.rig.transition_velocity
    said.append(
        f"The friction models run with the paper's f_b = {brief(coefficient)} and v_t = {brief(speed)} mm/s, "
        "fitted to another rig; for the best fit of each reading see Ablation."
    )
    return said
