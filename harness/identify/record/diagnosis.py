"""All of diagnosis.json."""

from __future__ import annotations

import json
from typing import Literal

from pydantic import Field, model_validator

from harness.identify.record.answer import AllErrorsRecord, BaselinesRecord, EffectRecord, UnlistedRecord
from harness.identify.record.model import ModelRecord
from harness.identify.record.next_experiment import NextExperimentRecord
from harness.identify.record.notices import FailureRecord, FindingRecord
from harness.identify.record.parts import Finite, RecordPart
from harness.identify.record.search import FitRecord, InputsRecord, LedgerLine, ProblemRecord
from harness.provenance import SEAL, seal_of

SCHEMA = 3
"""Version of the format."""


class DiagnosisRecord(RecordPart):
    """diagnosis.json."""

    version: Literal[3] = Field(default=3, alias="schema", description="Version of this format.")
    verdict: Literal["none", "effect", "unlisted", "not_identifiable"]
    sentence: str
    effects: tuple[EffectRecord, ...]
    unlisted: UnlistedRecord | None
    errors: AllErrorsRecord
    hidden_by_unknown_rig: tuple[str, ...]
    baselines: BaselinesRecord | None
    ledger: tuple[LedgerLine, ...]
    fits: dict[str, FitRecord]
    found: str = Field(default="", description="Name of the fit that is the result.")
    problem: ProblemRecord
    model: ModelRecord
    inputs: InputsRecord
    next_experiment: NextExperimentRecord | None
    failures: tuple[FailureRecord, ...] = ()
    findings: tuple[FindingRecord, ...] = ()
    wall_time_s: Finite
    files: dict[str, str] = Field(default={}, description="SHA-256 of the files written with it.")
    sealed: str = Field(default="", description="SHA-256 of the canonical JSON of all the rest.")

    @model_validator(mode="after")
    def _of_the_same_recordings(self) -> DiagnosisRecord:
        if self.model.phases != len(self.problem.recordings):
            raise ValueError(
                f"model.phases is {self.model.phases}, but problem.recordings names {len(self.problem.recordings)}"
            )
        return self

    @property
    def seal(self) -> str:
        """What `sealed` has to be."""
        return seal_of(json.loads(self.model_dump_json(by_alias=True)))

    @property
    def intact(self) -> bool:
        """Whether its content is what was sealed, by this version or by one whose files lack keys that came later."""
        as_read = json.loads(self.model_dump_json(by_alias=True, exclude_unset=True))
        return self.sealed in (self.seal, seal_of(as_read))

    def with_seal(self) -> DiagnosisRecord:
        """The same, sealed."""
        return self.model_copy(update={SEAL: self.seal})

    def text(self) -> str:
        """Content of the file, sealed."""
        return self.with_seal().model_dump_json(by_alias=True, indent=2)
