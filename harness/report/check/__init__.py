"""The report of `harness check`: fit for use or not, what is odd, which effects could show, what to record instead."""

from collections.abc import Callable, Mapping
from functools import partial

from harness.failures import Failures
from harness.report.check import answer, effects, recordings
from harness.report.check.content import Subject
from harness.report.page import Badge, Section, bodies_of, render_page

SECTIONS: Mapping[str, Callable[[Subject], Section | None]] = {
    "answer": answer.section,
    "effects": effects.section,
    "experiment": answer.experiment,
    "findings": answer.findings,
    "recordings": recordings.section,
}
"""In the order of the page; a section that does not apply returns `None`."""


def render_check(subject: Subject, failures: Failures) -> str:
    """The report as HTML text.

    Args:
        subject: what is reported.
        failures: to which sections that raise are added.
    """
    bodies = bodies_of({name: partial(section, subject) for name, section in SECTIONS.items()}, failures)
    badges = [Badge("not fit for use", "bad") if subject.reasons else Badge("fit for use", "good")]
    if subject.ahead is not None and subject.ahead.worse:
        badges.append(Badge("model worse than a ball at rest", "bad"))
    if subject.case.simulated:
        badges.append(Badge("simulated data", "warning"))
    return render_page(
        f"Ball and beam: check of {subject.case.name}",
        bodies,
        subtitle=f"origin: {subject.case.origin}" if subject.case.origin else "",
        badges=badges,
        failures=failures.all,
    )
