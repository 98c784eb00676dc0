"""The report of `harness run`: all models and engines on one recording; one module per concept."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from harness.comparison.study import Study
from harness.failures import Failures
from harness.report.comparison import (
    ablation,
    drive,
    engines,
    friction,
    horizons,
    inputs,
    paper,
    replay,
    residuals,
    result,
    scores,
)
from harness.report.comparison.subject import Subject
from harness.report.page import Badge, Section, bodies_of, render_page
from harness.tolerances import Checked

SECTIONS: Mapping[str, Callable[[Subject], Section | None]] = {
    "result": result.section,
    "replay": replay.section,
    "checks": scores.checks,
    "horizons": horizons.section,
    "residuals": residuals.section,
    "attribution": engines.attribution,
    "paper": paper.section,
    "ablation": ablation.section,
    "friction": friction.section,
    "drive": drive.section,
    "metrics": scores.metrics,
    "engines": engines.health,
    "inputs": inputs.inputs,
    "reproduce": inputs.reproduce,
}
"""In the order of the page; a section that does not apply returns `None`."""


def render_comparison(
    study: Study,
    manifest: Mapping[str, object],
    *,
    checks: Sequence[Checked] = (),
    command: str = "",
    failures: Failures | None = None,
) -> str:
    """The comparison report as HTML text.

    Args:
        study: the comparison.
        manifest: hashes, versions, settings, as written to manifest.json.
        checks: outcomes of tolerance checks, if requested.
        command: to repeat the run; empty for the manifest's.
        failures: collects sections that raise, which then say so; `None` lets them raise.
    """
    subject = Subject(study, manifest, tuple(checks), command or str(manifest.get("command", "")))
    bodies = bodies_of({name: partial(section, subject) for name, section in SECTIONS.items()}, failures)
    return render_page(
        f"Ball and beam: {study.setting.case.name}, {study.setting.recording.name}",
        bodies,
        subtitle=subject.subtitle,
        badges=_badges(subject),
        failures=() if failures is None else failures.all,
    )


def _badges(subject: Subject) -> list[Badge]:
    badges = [Badge("simulated data", "warning")] if subject.simulated else []
    failed = sorted({failure.engine for failure in subject.study.engine_failures})
    badges += [Badge(f"{name} failed", "bad") for name in failed]
    badges += [Badge("the ball lifts off", "warning")] if subject.study.lift_offs else []
    if subject.checks:
        missed = sum(not one.passed for one in subject.checks)
        many = f"{missed} check{'s' if missed > 1 else ''} failed"
        badges.append(Badge(many, "bad") if missed else Badge("all checks passed", "good"))
    return badges
