"""The answer, what is odd in the input, and what to record instead."""

from __future__ import annotations

import numpy as np

from harness.identify.design.proposal import Proposal
from harness.report.check.content import Content, Subject
from harness.report.page import Section
from harness.report.palette import MEASURED_COLOUR, Look
from harness.report.plots import Picture, drawing, over_time, picture, signal, style, zero


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
        pictures=() if made is None else (_picture(made),),
        notes=() if made is None else ("`next_experiment.csv` beside this page holds the beam angle.",),
    )
    return content.section("experiment", "What to record instead", "Next")


@style()
def _picture(proposal: Proposal) -> Picture:
    figure = drawing(3.4)
    top, bottom = figure.subplots(2, 1, sharex=True)
    look = Look("", MEASURED_COLOUR)
    signal(top, proposal.time, np.degrees(proposal.angle), look)
    zero(top)
    top.set_ylabel(r"beam angle $\alpha$ [deg]")
    signal(bottom, proposal.time, proposal.reading, look)
    bottom.set_ylabel("position $s$ [m]")
    over_time(bottom, proposal.time[0], proposal.time[-1])
    name = proposal.profile.name
    caption = f"The profile “{name}”: {proposal.profile.words}. Simulated, with the declared model."
    return picture(figure, f"Beam angle and expected ball position of the profile {name} over time", caption)
