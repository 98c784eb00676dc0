"""What the report of `harness check` is made of, and the content of one of its sections."""

from __future__ import annotations

from dataclasses import dataclass

from harness.identify.design.detection import Detection
from harness.identify.design.proposal import Proposal
from harness.identify.validation.at_rest import AgainstRest
from harness.recording import Case
from harness.recording.findings import DataFinding
from harness.report.page import Section
from harness.report.plots import Picture
from harness.report.tables import Table

TEMPLATE = "check/section.html"


@dataclass(frozen=True)
class Subject:
    """A checked case with the data of its report.

    Attributes:
        case: the input.
        sentence: the answer.
        reasons: why it is not fit for use; empty if it is.
        detection: detection limits; `None` if there is no use in computing them.
        proposal: what to record instead; `None` if every effect shows or no motion would help.
        next_sentence: what to record instead, in words; empty if every effect shows.
        ahead: errors over 1 s against those of a ball at rest; `None` where they were not computed.
    """

    case: Case
    sentence: str
    reasons: tuple[str, ...]
    detection: Detection | None
    proposal: Proposal | None
    next_sentence: str
    ahead: AgainstRest | None = None


@dataclass(frozen=True)
class Content:
    """What a section shows, in this order."""

    answer: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    findings: tuple[DataFinding, ...] = ()
    pictures: tuple[Picture, ...] = ()
    tables: tuple[Table, ...] = ()
    notes: tuple[str, ...] = ()

    def section(self, anchor: str, title: str, short: str) -> Section:
        """As a section of the page."""
        return Section(anchor, title, short, TEMPLATE, {"content": self})
