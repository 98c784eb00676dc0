"""The search: every decision, the fits that were compared, and the problem that they are fits of."""

from __future__ import annotations

from pydantic import Field, model_validator

from harness.identify.record.covariance import CovarianceRows, check_square
from harness.identify.record.model import (
    ActingRecord,
    ColourRecord,
    EstimatorName,
    RigRecord,
    SplineTermRecord,
)
from harness.identify.record.parts import Finite, NotNegative, Number, Positive, RecordPart


class EvidenceRecord(RecordPart):
    """Evidence of a decision (`harness.identify.selection.decision.Evidence`), with fits by name."""

    winner: str | None = None
    holder: str | None = None
    without: tuple[str, ...] = ()
    before: tuple[Number, ...] = ()
    after: tuple[Number, ...] = ()
    tests: int = 1
    nested: bool = False
    weight: Number = 1.0


class LedgerLine(RecordPart):
    """One decision of the search; `fit` and `against` name the fits compared, `hash` covers the line."""

    effect: str
    tried: tuple[str, ...]
    beside: tuple[str, ...]
    gain: Number
    kept: bool
    because: str
    rule: str
    fit: str
    against: str
    evidence: EvidenceRecord
    hash: str = ""


class FittedEffect(RecordPart):
    """An effect of a fit, with its law."""

    name: str
    law: str


class FitRecord(RecordPart):
    """A fit of the ledger: hypothesis, scaled parameters, process noise, deviance and criterion.

    `abandoned` if it was not continued to convergence, as it was behind the best candidate or none promised anything.
    `held_out_m` is the RMS error of every held-out block, where the fit was cross-validated. Errors exceeded the
    foreseen standard deviations by the factor `band`, beside a variance that grows by `band_growth_m2_s` from the last
    reading on; `forecast_errors_m` is `held_out_m` of predictions, which are kept within `travel_m` unless it is null.
    `covariance` is that of the parameters in their units, of fits whose standard errors cannot be computed
    from the rest: those left behind by the search, and those to free runs.
    """

    effects: tuple[FittedEffect, ...]
    spline_term: SplineTermRecord | None
    parameters: tuple[Finite, ...]
    process_noise_m2_s3: Positive
    deviance: Number
    criterion: Number
    abandoned: bool = False
    estimator: EstimatorName = "likelihood"
    held_out_m: tuple[Number, ...] = ()
    band: Positive = 1.0
    band_growth_m2_s: NotNegative = 0.0
    travel_m: tuple[Finite, Finite] | None = None
    forecast_errors_m: tuple[Number, ...] = ()
    covariance: CovarianceRows = ()

    @model_validator(mode="after")
    def _with_its_covariance(self) -> FitRecord:
        if self.covariance:
            check_square(self.covariance, len(self.parameters))
        return self


class SourcesRecord(RecordPart):
    """SHA-256 of every input file and versions of the software."""

    hashes: dict[str, str]
    versions: dict[str, str]


class InputsRecord(SourcesRecord):
    """Sources with the further recordings (`also`) and the seed of the random draws."""

    also: dict[str, str]
    seed: int


class ProblemRecord(RecordPart):
    """The inputs of every fit and decision."""

    inputs: SourcesRecord
    recordings: tuple[str, ...]
    readings: int = Field(ge=1)
    reading_variance_m2: Positive
    colour: ColourRecord = ColourRecord()
    roughness: Positive = 1.0
    noise_share: Positive = 1.0
    held_command: bool = False
    baseline: str
    rig: RigRecord
    declared: tuple[ActingRecord, ...]
    settings: dict[str, int | Finite]
    hash: str = ""


class LedgerRecord(RecordPart):
    """The search: every decision, the fits that were compared, their problem, and the name of the fit `found`."""

    ledger: tuple[LedgerLine, ...]
    fits: dict[str, FitRecord]
    problem: ProblemRecord
    found: str = ""
