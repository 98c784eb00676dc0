"""What failed, and what is odd in the input."""

from __future__ import annotations

from typing import Literal

from harness.failures import described
from harness.identify.record.parts import RecordPart
from harness.recording.findings import DataFinding


class FailureRecord(RecordPart):
    """A part that failed and was left out, as `harness.failures.Failed`; the exit code is then 3."""

    part: Literal["engine", "candidate", "search", "validation", "baselines", "next_experiment", "prediction", "report"]
    name: str
    message: str
    where: str

    def __str__(self) -> str:
        return described(self.part, self.name, self.message, self.where)


class FindingRecord(RecordPart):
    """A warning or note on the input, as `harness.recording.DataFinding`; `code` is its short, stable name."""

    severity: Literal["warning", "note"]
    where: str
    text: str
    code: str

    def finding(self) -> DataFinding:
        """The same as the recording layer has it."""
        return DataFinding(self.severity, self.where, self.text, self.code)
