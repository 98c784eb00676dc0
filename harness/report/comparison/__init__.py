"""The report of `harness run`: one recording, every model and engine. A section is one module and one line here."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from harness.comparison.study import Study
from harness.report.comparison import (
    ablation,
    attribution,
    checks,
    drive,
    engines,
    friction,
    horizons,
    inputs,
    paper,
    reproduce,
    residuals,
    result,
    scores,
)
from harness.report.comparison.subject import Subject
from harness.report.page import Badge, Section, render_page
from harness.tolerances import Checked

SECTIONS: tuple[Callable[[Subject], Section | None], ...] = (
    result.section,
    checks.section,
    horizons.section,
    residuals.section,
    attribution.section,
    paper.section,
    ablation.section,
    friction.section,
    drive.section,
    scores.section,
    engines.section,
    inputs.section,
    reproduce.section,
)
"""In the order of the page; a section that has nothing to say is `None`."""


def render_comparison(
    study: Study, manifest: Mapping[str, object], *, checks: Sequence[Checked] = (), command: str = ""
) -> str:
    """The comparison report as HTML text.

    Args:
        study: what is reported.
        manifest: hashes, versions, settings, as written to manifest.json.
        checks: results of tolerance checks, if any were asked for.
        command: what repeats the run; empty for the manifest's.
    """
    subject = Subject(study, manifest, tuple(checks), command or str(manifest.get("command", "")))
    sections = [made for section in SECTIONS if (made := section(subject)) is not None]
    return render_page(
        f"Ball and beam: {subject.case_name}, {study.setting.recording.name}",
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
