"""The answer, what is odd in the input, and what to record instead."""

from __future__ import annotations

from harness.report.check.content import Content, Subject
from harness.report.page import Section
from harness.report.palette import MEASURED_COLOUR, Look
from harness.report.proposed import picture_of

EXPECTED = Look("", MEASURED_COLOUR)


def section(subject: Subject) -> Section:
    """Whether the recordings are fit for use, and why not."""
    return Content(answer=(subject.sentence, *subject.reasons)).section("answer", "Answer", "Answer")


def findings(subject: Subject) -> Section:
    """What the loader and its detectors found."""
    found = subject.case.findings
    content = Content(texts=() if found else ("Nothing odd was found in these files.",), findings=found)
    return content.section("findings", "What is odd", "Findings")


def experiment(subject: Subject) -> Section | None:
    """The motion that would show more; `None` if every effect shows."""
    if not subject.next_sentence:
        return None
    made = subject.proposal
    content = Content(
        texts=(subject.next_sentence.replace("_", " "),),
        pictures=() if made is None else (picture_of(made, EXPECTED, "the declared model"),),
        notes=() if made is None else ("`next_experiment.csv` beside this page holds the beam angle.",),
    )
    return content.section("experiment", "What to record instead", "Next")
