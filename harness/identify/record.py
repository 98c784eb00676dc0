"""diagnosis.json as one model: what `harness diagnose` writes, what `harness predict` and `harness replay` read.

Its JSON Schema is harness/data/diagnosis.schema.json (`make schema`). Everything is in SI units, intervals are 95 %
intervals, and what is not a finite number is null.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from analytic.rig import Rig
from analytic.slots import MOST_NODES
from harness.errors import InputError
from harness.failures import described
from harness.provenance import SEAL, seal_of
from harness.recording.findings import DataFinding

SCHEMA = 3
"""Version of the format."""
FILE = "diagnosis.json"
SCHEMA_FILE = Path(__file__).parents[1] / "data" / "diagnosis.schema.json"

DependsName = Literal["position", "velocity", "angle", "roll_angle", "time"]
EstimatorName = Literal["likelihood", "free_runs"]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]

AT_BOUND = 1e-6
"""Share of a parameter's range: fits end at a bound up to rounding."""
# Of a covariance, relative to its standard deviations: the inverse of an ill-conditioned matrix rounds by as much.
_ROUNDING = 1e-6
_LONGEST_SHOWN = 40  # characters of a wrong value in a message


def _null(value: Any) -> Any:
    return None if isinstance(value, float) and not abs(value) < float("inf") else value


Number = Annotated[Finite | None, BeforeValidator(_null)]
"""A number, or null if it is not finite."""


class Part(BaseModel):
    """A part of the record, read from JSON or from the attributes of a dataclass."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, from_attributes=True, populate_by_name=True, defer_build=True
    )


class ParameterRecord(Part):
    """A fitted parameter: value, 95 % interval, unit."""

    value: Finite
    low: Number
    high: Number
    unit: str

    @property
    def interval(self) -> tuple[float | None, float | None]:
        """Low and high end of the 95 % interval; `None` if the recordings do not bound it."""
        return self.low, self.high


class EffectRecord(Part):
    """An identified effect; `effect["coefficient"]` is its parameter of that name.

    `by_recording` has its value in each recording where these differ. `implausible` names the parameters whose value is
    outside the usual range.
    """

    name: str
    parameters: dict[str, ParameterRecord]
    indistinguishable_from: tuple[str, ...]
    by_recording: dict[str, ParameterRecord] = {}
    implausible: tuple[str, ...] = ()

    def __getitem__(self, parameter: str) -> ParameterRecord:
        return self.parameters[parameter]


class ShapeRecord(Part):
    """The nodes of a spline term: `values` [`unit`] at abscissae `at`, in the unit of its regressor."""

    at: tuple[Finite, ...]
    values: tuple[Finite, ...]
    unit: Literal["1", "m/s²"]
    friction: bool
    low: Finite
    step: Positive

    @model_validator(mode="after")
    def _of_one_length(self) -> ShapeRecord:
        if len(self.at) != len(self.values):
            raise ValueError(f"{len(self.values)} values at {len(self.at)} abscissae")
        return self


class UnlistedRecord(Part):
    """An unlisted effect: its regressors, strongest first, and its spline term."""

    depends_on: tuple[DependsName, ...]
    shape: ShapeRecord


class DependenceRecord(Part):
    """Test of innovations against one input: p value, largest correlation and its lag."""

    p: Finite
    correlation: Number
    lag_s: Number


class RmsRecord(Part):
    """RMS prediction errors by horizon [m]."""

    rms_m: dict[str, Number]


class ErrorsRecord(RmsRecord):
    """Prediction errors of the model, and tests of its innovations."""

    innovation_correlation: Number
    innovation_over_noise: Number
    innovation_on_beam: dict[str, DependenceRecord]


class BeforeAfterRecord(Part):
    """Errors without and with the identified terms."""

    before: ErrorsRecord
    after: ErrorsRecord


class EngineErrorsRecord(RmsRecord):
    """Errors of an engine's free runs; `failed` is its message if it failed."""

    failed: str | None = None


class EngineBeforeAfterRecord(Part):
    """Errors of an engine without and with the identified terms."""

    before: EngineErrorsRecord
    after: EngineErrorsRecord


class EngineRecord(EngineBeforeAfterRecord):
    """Errors of an engine on the recordings fitted to and on held-out ones; `recordings` names those that it ran."""

    heldout: EngineBeforeAfterRecord | None = None
    recordings: tuple[str, ...] = ()


class AlsoRecord(BeforeAfterRecord):
    """Errors on a further recording that nothing was fitted to."""

    engines: dict[str, EngineRecord]


class AllErrorsRecord(Part):
    """Errors before and after; `engines_enter` says in words how each term is injected into the engines."""

    identify: BeforeAfterRecord
    heldout: BeforeAfterRecord
    engines: dict[str, EngineRecord]
    engines_enter: dict[str, str]
    also: dict[str, AlsoRecord]


class MarginRecord(Part):
    """Reduction of the RMS error from a baseline to the model [m]; `sure` if its interval is above zero."""

    value: Finite
    low: Finite
    high: Finite
    sure: bool


class BaselinesRecord(Part):
    """Held-out blocks predicted by the model, `before` and `after`, and by the baselines.

    `errors_m` has the RMS error of every block by source, `rms_m` that over all blocks. Windows of `known_s` and then
    `ahead_s` that overlap are one block.
    """

    known_s: Finite
    ahead_s: Finite
    blocks: int
    rms_m: dict[str, Number]
    errors_m: dict[str, tuple[Number, ...]]
    blocks_won: dict[str, int]
    better_by_m: dict[str, MarginRecord | None]


class EvidenceRecord(Part):
    """Evidence of a decision (`harness.identify.selection.criterion.Evidence`), with fits by name."""

    winner: str | None = None
    holder: str | None = None
    without: tuple[str, ...] = ()
    before: tuple[Number, ...] = ()
    after: tuple[Number, ...] = ()
    tests: int = 1
    nested: bool = False


class LedgerLine(Part):
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


class SplineTermRecord(Part):
    """A spline term without the values of its nodes."""

    depends: DependsName
    friction: bool
    low: Finite
    step: Positive
    nodes: int = Field(ge=2, le=MOST_NODES)

    @model_validator(mode="after")
    def _possible(self) -> SplineTermRecord:
        if self.friction and self.depends in ("velocity", "angle"):
            raise ValueError(f"there is no friction term of the {self.depends}")
        return self


class FittedEffect(Part):
    """An effect of a fit, with its law."""

    name: str
    law: str


class FitRecord(Part):
    """A fit of the ledger: hypothesis, scaled parameters, process noise, deviance and criterion.

    `abandoned` if it was not continued to convergence, as it was behind the best candidate or none promised anything.
    `held_out_m` is the RMS error of every held-out block, where the fit was cross-validated; errors exceeded the
    foreseen standard deviations by the factor `band`. `covariance` is that of the parameters in their units, of fits
    whose standard errors cannot be computed from the rest: those left behind by the search, and those to free runs.
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
    covariance: tuple[tuple[Number, ...], ...] = ()

    @model_validator(mode="after")
    def _with_its_covariance(self) -> FitRecord:
        count = len(self.parameters)
        if self.covariance and [len(row) for row in self.covariance] != [count] * count:
            raise ValueError(f"covariance is not a table of {count} rows and columns, as there are {count} parameters")
        return self


class SourcesRecord(Part):
    """SHA-256 of every input file and versions of the software."""

    hashes: dict[str, str]
    versions: dict[str, str]


class InputsRecord(SourcesRecord):
    """Sources with the further recordings (`also`) and the seed of the random draws."""

    also: dict[str, str]
    seed: int


class RigRecord(Part):
    """A complete rig, as `analytic.rig.Rig`."""

    mass: Finite
    inertia: Finite
    radius: Finite
    rolling_radius: Finite
    eccentricity: Finite
    gravity: Finite
    level_angle: Finite
    friction_coefficient: Finite
    transition_velocity: Finite

    @model_validator(mode="after")
    def _possible(self) -> RigRecord:
        Rig(**self.model_dump())
        return self


class SensorsRecord(Part):
    """Known properties of the sensors, as `harness.recording.Sensors`."""

    angle_resolution: Positive | None = None
    angle_noise: NotNegative | None = None
    position_noise: NotNegative | None = None
    position_resolution: Positive | None = None


class ActingRecord(Part):
    """A known effect with its values."""

    name: str
    values: dict[str, Finite]


class ColourRecord(Part):
    """What of the reading noise is coloured: share of its variance [1], correlation time [s]."""

    share: float = Field(0.0, ge=0.0, le=1.0)
    time_s: float = Field(1.0, gt=0.0, allow_inf_nan=False)


class ProblemRecord(Part):
    """The inputs of every fit and decision."""

    inputs: SourcesRecord
    recordings: tuple[str, ...]
    readings: int = Field(ge=1)
    reading_variance_m2: Positive
    colour: ColourRecord = ColourRecord()
    baseline: str
    rig: RigRecord
    declared: tuple[ActingRecord, ...]
    settings: dict[str, int | Finite]
    hash: str = ""


class ModelRecord(Part):
    """The identified model: everything that a prediction needs.

    `parameters` are scaled, their `covariance` is in their units, with null where the fit did not give it.
    """

    rig: RigRecord
    sensors: SensorsRecord
    declared: tuple[ActingRecord, ...]
    effects: tuple[str, ...]
    spline_term: SplineTermRecord | None
    parameters: tuple[Finite, ...]
    phases: int = Field(ge=1)
    covariance: tuple[tuple[Number, ...], ...]
    process_noise_m2_s3: Positive
    estimator: EstimatorName = "likelihood"
    band: Positive = 1.0
    reading_variance_m2: Positive
    colour: ColourRecord = ColourRecord()

    @model_validator(mode="after")
    def _with_its_covariance(self) -> ModelRecord:
        count = len(self.parameters)
        if len(self.covariance) != count or any(len(row) != count for row in self.covariance):
            raise ValueError(f"covariance is not a table of {count} rows and columns, as there are {count} parameters")
        rows = [[np.nan if one is None else one for one in row] for row in self.covariance]
        fault = covariance_fault(np.array(rows, dtype=float).reshape(count, count))
        if fault:
            raise ValueError(f"covariance {fault}")
        return self


class LedgerRecord(Part):
    """The search: every decision, the fits that were compared, their problem, and the name of the fit `found`."""

    ledger: tuple[LedgerLine, ...]
    fits: dict[str, FitRecord]
    problem: ProblemRecord
    found: str = ""


class SeparationRecord(Part):
    """Separation of the identified model from a rival [σ]."""

    found: str
    rival: str
    at_hand: Number
    expected: Number
    needed: Number
    told: bool


class LimitsRecord(Part):
    """The operating envelope."""

    ball_position_m: tuple[Finite, Finite]
    beam_angle_rad: Finite
    beam_rate_rad_s: Finite
    beam_acceleration_rad_s2: Finite


class NextExperimentRecord(Part):
    """The proposed next experiment; its beam angle is in `file`."""

    profile: str
    does: str
    sentence: str
    file: str
    duration_s: Finite
    separations: tuple[SeparationRecord, ...]
    tried: dict[str, Number]
    open_loop_drift_m: Number
    limits: LimitsRecord


class FailureRecord(Part):
    """A part that failed and was left out, as `harness.failures.Failed`; the exit code is then 3."""

    part: Literal["engine", "candidate", "search", "validation", "baselines", "next_experiment", "prediction", "report"]
    name: str
    message: str
    where: str

    def __str__(self) -> str:
        return described(self.part, self.name, self.message, self.where)


class FindingRecord(Part):
    """A warning or note on the input, as `harness.recording.DataFinding`; `code` is its short, stable name."""

    severity: Literal["warning", "note"]
    where: str
    text: str
    code: str

    def finding(self) -> DataFinding:
        """The same as the recording layer has it."""
        return DataFinding(self.severity, self.where, self.text, self.code)


class DiagnosisRecord(Part):
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
        """Whether its content is what was sealed."""
        return self.sealed == self.seal

    def with_seal(self) -> DiagnosisRecord:
        """The same, sealed."""
        return self.model_copy(update={SEAL: self.seal})

    def text(self) -> str:
        """Content of the file, sealed."""
        return self.with_seal().model_dump_json(by_alias=True, indent=2)


def covariance_fault(matrix: NDArray[np.float64]) -> str:
    """Why a matrix, shape (k, k), NaN where unknown, is no covariance within rounding; empty if it is one."""
    known = np.isfinite(matrix).all(axis=0) & np.isfinite(matrix).all(axis=1)
    matrix = matrix[np.ix_(known, known)]
    variances = np.diag(matrix)
    if not len(matrix):
        return ""
    if (variances < 0.0).any():
        return f"has the negative variance {variances.min():g}"
    deviations = np.sqrt(variances)
    deviations[deviations == 0.0] = 1.0
    correlations = matrix / deviations / deviations[:, None]
    if np.abs(correlations - correlations.T).max() > _ROUNDING:
        return "is not symmetric"
    if np.linalg.eigvalsh(correlations)[0] < -_ROUNDING * len(matrix):
        return "is not positive semi-definite"
    return ""


def read_record(path: Path) -> DiagnosisRecord:
    """Read a diagnosis.json, or the one in a folder.

    Raises:
        InputError: it cannot be read, or is not what this version writes.
    """
    file = path / FILE if path.is_dir() else path
    try:
        raw = file.read_bytes()
        content = json.loads(raw)
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}); give the {FILE} of `diagnose`") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{file}: is no diagnosis ({error}); give the {FILE} that `diagnose` wrote") from error
    version = content.get("schema") if isinstance(content, dict) else None
    if version is None:
        raise InputError(f"{file}: is no diagnosis (it has no schema); give the {FILE} that `diagnose` wrote")
    if isinstance(version, bool) or version != SCHEMA:
        raise InputError(
            f"{file}: is no diagnosis that this version can use (schema {version}, not {SCHEMA}); diagnose anew"
        )
    try:
        return DiagnosisRecord.model_validate_json(raw, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise unusable(file, ".".join(map(str, first["loc"])), _fault(first)) from error


def unusable(file: Path | str, key: str, fault: str) -> InputError:
    """The error of a diagnosis.json in which a key holds what it cannot."""
    return InputError(f"{file}: is no diagnosis that this version can use ({key}: {fault}); diagnose anew")


def _fault(error: ErrorDetails) -> str:
    """What is wrong, and with which value if that is a short one."""
    text = error["msg"].removeprefix("Value error, ")
    given = error["input"]
    if isinstance(given, dict | list | tuple) or len(repr(given)) > _LONGEST_SHOWN:
        return text
    return f"{text}, not {json.dumps(given)}"


def schema_text() -> str:
    """JSON Schema of the format."""
    schema = DiagnosisRecord.model_json_schema(by_alias=True, mode="serialization")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return json.dumps(head | schema | {"title": FILE}, indent=2, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
