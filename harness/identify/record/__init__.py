"""diagnosis.json as one model: what `harness diagnose` writes, what `harness predict` and `harness replay` read.

Its JSON Schema is harness/data/diagnosis.schema.json (`make schema`). Everything is in SI units, intervals are 95 %
intervals, and what is not a finite number is null.
"""

from harness.identify.record.answer import (
    AllErrorsRecord,
    AlsoRecord,
    BaselinesRecord,
    BeforeAfterRecord,
    DependenceRecord,
    EffectRecord,
    EngineRecord,
    ErrorsRecord,
    MarginRecord,
    ParameterRecord,
    RmsRecord,
    ShapeRecord,
    UnlistedRecord,
)
from harness.identify.record.covariance import covariance_fault
from harness.identify.record.diagnosis import DiagnosisRecord
from harness.identify.record.file import FILE, SCHEMA_FILE, read_record, schema_text, unusable
from harness.identify.record.model import (
    AT_BOUND,
    ActingRecord,
    ColourRecord,
    ForecastRecord,
    ModelRecord,
    RigRecord,
    SensorsRecord,
    SplineTermRecord,
)
from harness.identify.record.next_experiment import LimitsRecord, NextExperimentRecord, SeparationRecord
from harness.identify.record.notices import FailureRecord, FindingRecord
from harness.identify.record.search import (
    EvidenceRecord,
    FitRecord,
    FittedEffect,
    InputsRecord,
    LedgerLine,
    LedgerRecord,
    ProblemRecord,
    SourcesRecord,
)

__all__ = [
    "AT_BOUND",
    "FILE",
    "SCHEMA_FILE",
    "ActingRecord",
    "AllErrorsRecord",
    "AlsoRecord",
    "BaselinesRecord",
    "BeforeAfterRecord",
    "ColourRecord",
    "DependenceRecord",
    "DiagnosisRecord",
    "EffectRecord",
    "EngineRecord",
    "ErrorsRecord",
    "EvidenceRecord",
    "FailureRecord",
    "FindingRecord",
    "FitRecord",
    "FittedEffect",
    "ForecastRecord",
    "InputsRecord",
    "LedgerLine",
    "LedgerRecord",
    "LimitsRecord",
    "MarginRecord",
    "ModelRecord",
    "NextExperimentRecord",
    "ParameterRecord",
    "ProblemRecord",
    "RigRecord",
    "RmsRecord",
    "SensorsRecord",
    "SeparationRecord",
    "ShapeRecord",
    "SourcesRecord",
    "SplineTermRecord",
    "UnlistedRecord",
    "covariance_fault",
    "read_record",
    "schema_text",
    "unusable",
]
