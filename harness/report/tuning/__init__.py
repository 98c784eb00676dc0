"""The report of `harness tune`: tuned parameters of an engine, what they gain, and what cannot be told."""

from collections.abc import Callable, Mapping
from functools import partial

from harness.failures import Failures
from harness.report.page import Badge, Section, bodies_of, render_page
from harness.report.tuning import replay, sections
from harness.report.tuning.subject import Subject

SECTIONS: Mapping[str, Callable[[Subject], Section | None]] = {
    "answer": sections.answer,
    "replay": replay.section,
    "errors": sections.errors,
    "identifiability": sections.identifiability,
    "screening": sections.screening,
    "inputs": sections.inputs,
}
"""In the order of the page; a section that does not apply returns `None`."""


def render_tuning(subject: Subject, failures: Failures) -> str:
    """The report as HTML text.

    Args:
        subject: what is reported.
        failures: those to show at the top, to which sections that raise are added.
    """
    bodies = bodies_of({name: partial(section, subject) for name, section in SECTIONS.items()}, failures)
    badges = [Badge("simulated data", "warning")] if subject.case.simulated else []
    origin = f"origin: {subject.case.origin}" if subject.case.origin else ""
    scene = f" with {subject.scene_file}" if subject.scene_file else ""
    return render_page(
        f"Ball and beam: tuning of {subject.engine}{scene} on {subject.case.name}",
        bodies,
        subtitle=origin,
        badges=[*badges, Badge("incomplete", "bad")] if failures.all else badges,
        failures=failures.all,
    )
