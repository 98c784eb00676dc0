"""The answer: effects with intervals, an unlisted effect, errors before and after, baselines."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from harness.identify.record.parts import Finite, Number, Positive, RecordPart
from harness.identify.record.rivals import rival_sets

DependsName = Literal["position", "velocity", "angle", "roll_angle", "time"]


class ParameterRecord(RecordPart):
    """A fitted parameter: value, 95 % interval, unit."""

    value: Finite
    low: Number
    high: Number
    unit: str

    @property
    def interval(self) -> tuple[float | None, float | None]:
        """Low and high end of the 95 % interval; `None` if the recordings do not bound it."""
        return self.low, self.high


class EffectRecord(RecordPart):
    """An identified effect; `effect["coefficient"]` is its parameter of that name.

    `by_recording` has its value in each recording where these differ. `implausible` names the parameters whose value is
    outside the usual range. `together` has the sets of effects that are indistinguishable from it only together.
    """

    name: str
    parameters: dict[str, ParameterRecord]
    indistinguishable_from: tuple[str, ...]
    by_recording: dict[str, ParameterRecord] = Field(default={})
    implausible: tuple[str, ...] = ()
    together: tuple[tuple[str, ...], ...] = ()

    @property
    def rivals(self) -> tuple[tuple[str, ...], ...]:
        """What is indistinguishable from it: single effects, then sets of them."""
        return rival_sets(self.indistinguishable_from, self.together)

    def __getitem__(self, parameter: str) -> ParameterRecord:
        return self.parameters[parameter]


class ShapeRecord(RecordPart):
    """The nodes of a spline term: `values` [`unit`] at abscissae `at`, in the unit of its regressor.

    Those of a periodic one are of one period, after which they repeat themselves.
    """

    at: tuple[Finite, ...]
    values: tuple[Finite, ...]
    unit: Literal["1", "m/s²", "m"]
    friction: bool
    sensor: bool = False
    low: Finite
    step: Positive
    periodic: bool = False

    @model_validator(mode="after")
    def _of_one_length(self) -> ShapeRecord:
        if len(self.at) != len(self.values):
            raise ValueError(f"{len(self.values)} values at {len(self.at)} abscissae")
        return self


class UnlistedRecord(RecordPart):
    """An unlisted effect: its regressors, strongest first, and its spline term."""

    depends_on: tuple[DependsName, ...]
    shape: ShapeRecord


class DependenceRecord(RecordPart):
    """Test of innovations against one input: p value, largest correlation and its lag."""

    p: Finite
    correlation: Number
    lag_s: Number


class RmsRecord(RecordPart):
    """RMS prediction errors by horizon [m]."""

    rms_m: dict[str, Number]


class ErrorsRecord(RmsRecord):
    """Prediction errors of the model, and tests of its innovations."""

    innovation_correlation: Number
    innovation_over_noise: Number
    innovation_on_beam: dict[str, DependenceRecord]


class BeforeAfterRecord(RecordPart):
    """Errors without and with the identified terms."""

    before: ErrorsRecord
    after: ErrorsRecord


class EngineErrorsRecord(RmsRecord):
    """Errors of an engine's free runs; `failed` is its message if one failed, whose horizon has no error then."""

    failed: str | None = None


class EngineBeforeAfterRecord(RecordPart):
    """Errors of an engine without and with the identified terms."""

    before: EngineErrorsRecord
    after: EngineErrorsRecord


class EngineRecord(EngineBeforeAfterRecord):
    """Errors of an engine on the recordings fitted to and on held-out ones.

    `recordings` names those that it ran; `warnings` are those of the engine itself in any of these runs.
    """

    heldout: EngineBeforeAfterRecord | None = None
    recordings: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


class AlsoRecord(BeforeAfterRecord):
    """Errors on a further recording that nothing was fitted to."""

    engines: dict[str, EngineRecord]


class AllErrorsRecord(RecordPart):
    """Errors before and after; `engines_enter` says in words how each term is injected into the engines."""

    identify: BeforeAfterRecord
    heldout: BeforeAfterRecord
    engines: dict[str, EngineRecord]
    engines_enter: dict[str, str]
    also: dict[str, AlsoRecord]


class MarginRecord(RecordPart):
    """Reduction of the RMS error from a baseline to the model [m]; `sure` if its interval is above zero."""

    value: Finite
    low: Finite
    high: Finite
    sure: bool


class BaselinesRecord(RecordPart):
    """Held-out blocks predicted by the model, `before` and `after`, and by the baselines.

    `errors_m` has the RMS error of every block by source, `rms_m` that over all blocks. Windows of `known_s` and then
    `ahead_s` that overlap are one block. The source `fitted_to_forecasts` has parameters that are for predictions
    alone; with the source that `predicting` names predictions are made, and the baselines are compared.
    """

    known_s: Finite
    ahead_s: Finite
    blocks: int
    rms_m: dict[str, Number]
    errors_m: dict[str, tuple[Number, ...]]
    blocks_won: dict[str, int]
    better_by_m: dict[str, MarginRecord | None]
    predicting: Literal["after", "fitted_to_forecasts"] = "after"
