"""The report of `harness run`: all models and engines on one recording; one module per concept."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from harness.comparison.study import Study
from harness.report.comparison import (
    ablation,
    drive,
    engines,
    friction,
    horizons,
    inputs,
    paper,
    residuals,
    result,
    scores,
)
from harness.report.comparison.subject import Subject
from harness.report.page import Badge, Section, render_page
from harness.tolerances import Checked

SECTIONS: tuple[Callable[[Subject], Section | None], ...] = (
    result.section,
    scores.checks,
    horizons.section,
    residuals.section,
    engines.attribution,
    paper.section,
    ablation.section,
    friction.section,
    drive.section,
    scores.metrics,
    engines.health,
    inputs.inputs,
    inputs.reproduce,
)
"""In the order of the page; a section that does not apply returns `None`."""


def render_comparison(
    study: Study, manifest: Mapping[str, object], *, checks: Sequence[Checked] = (), command: str = ""
) -> str:
    """The comparison report as HTML text.

    Args:
        study: the comparison.
        manifest: hashes, versions, settings, as written to manifest.json.
        checks: outcomes of tolerance checks, if requested.
        command: to repeat the run; empty for the manifest's.
    """
    subject = Subject(study, manifest, tuple(checks), command or str(manifest.get("command", "")))
    sections = [made for section in SECTIONS if (made := section(subject)) is not None]
    return render_page(
        f"Ball and beam: {study.setting.case.name}, {study.setting.recording.name}",
        sections,
        subtitle=subject.subtitle,
        badges=_badges(subject),
    )


def _badges(subject: Subject) -> list[Badge]:
    badges = [Badge("simulated data", "warning")] if subject.simulated else []
    failed = sorted({failure.engine for failure in subject.study.failures})
    badges += [Badge(f"{name} failed", "bad") for name in failed]
    if subject.checks:
        missed = sum(not one.passed for one in subject.checks)
        many = f"{missed} check{'s' if missed > 1 else ''} failed"
        badges.append(Badge(many, "bad") if missed else Badge("all checks passed", "good"))
    return badges
