"""The identified model: everything that a prediction needs."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from analytic.rig import Rig
from analytic.slots import MOST_NODES
from harness.identify.record.answer import DependsName
from harness.identify.record.covariance import CovarianceRows, check_square, covariance_fault
from harness.identify.record.parts import Finite, NotNegative, Positive, RecordPart

EstimatorName = Literal["likelihood", "free_runs"]
AT_BOUND = 1e-6
"""Share of a parameter's range: fits end at a bound up to rounding."""


class SplineTermRecord(RecordPart):
    """A spline term without the values of its nodes."""

    depends: DependsName
    friction: bool
    low: Finite
    step: Positive
    nodes: int = Field(ge=2, le=MOST_NODES)
    harmonics: int = Field(0, ge=0, le=MOST_NODES // 3)
    sensor: bool = False

    @model_validator(mode="after")
    def _possible(self) -> SplineTermRecord:
        if self.harmonics and (self.friction or self.depends != "position"):
            raise ValueError("only a force of position is periodic")
        if self.sensor and (self.friction or self.harmonics or self.depends != "position"):
            raise ValueError("an error of the sensor is a function of the position alone")
        if self.friction and self.depends in ("velocity", "angle"):
            raise ValueError(f"there is no friction term of the {self.depends}")
        return self


class RigRecord(RecordPart):
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


class SensorsRecord(RecordPart):
    """Known properties of the sensors, as `harness.recording.Sensors`."""

    angle_resolution: Positive | None = None
    angle_noise: NotNegative | None = None
    position_noise: NotNegative | None = None
    position_resolution: Positive | None = None


class ActingRecord(RecordPart):
    """A known effect with its values."""

    name: str
    values: dict[str, Finite]


class ColourRecord(RecordPart):
    """What of the reading noise is coloured: share of its variance [1], correlation time [s]."""

    share: float = Field(0.0, ge=0.0, le=1.0)
    time_s: float = Field(1.0, gt=0.0, allow_inf_nan=False)


class ForecastRecord(RecordPart):
    """What predictions use in place of the same of the model: fitted to forecasts, and better at these.

    The effects are those of the model, or, where nothing was found and there were blocks enough, also those that are
    common on measured rigs.
    """

    effects: tuple[str, ...]
    parameters: tuple[Finite, ...]
    covariance: CovarianceRows
    process_noise_m2_s3: Positive
    band: Positive
    band_growth_m2_s: NotNegative = 0.0

    @model_validator(mode="after")
    def _with_its_covariance(self) -> ForecastRecord:
        _check_covariance(self.covariance, len(self.parameters))
        return self


class ModelRecord(RecordPart):
    """The identified model: everything that a prediction needs.

    `parameters` are scaled, their `covariance` is in their units, with null where the fit did not give it;
    `roughness` is the factor on the density of the beam's third derivative with which a drive is smoothed [1],
    `noise_share` what of the scatter of its readings is then an error [1], `held_command` whether the angle is a
    command, held from stamp to stamp and not smoothed; `readings_in_mean` is how many readings of a fast sensor
    make one that `reading_variance_m2` is of; the variance of a prediction is `band`² times what the filter and the
    covariance foresee and `band_growth_m2_s` times the time since the last reading; predictions are kept within
    `travel_m`, the positions recorded, where the model lacks physics, else null; `visited_m` is from where to where
    positions were recorded, without half a percent of the readings at either end, null if not known. `forecast` has
    what predictions use instead where parameters fitted to forecasts predict held-out blocks better, else null.
    """

    rig: RigRecord
    sensors: SensorsRecord
    declared: tuple[ActingRecord, ...]
    effects: tuple[str, ...]
    spline_term: SplineTermRecord | None
    parameters: tuple[Finite, ...]
    phases: int = Field(ge=1)
    covariance: CovarianceRows
    process_noise_m2_s3: Positive
    estimator: EstimatorName = "likelihood"
    band: Positive = 1.0
    band_growth_m2_s: NotNegative = 0.0
    travel_m: tuple[Finite, Finite] | None = None
    reading_variance_m2: Positive
    readings_in_mean: int = Field(default=1, ge=1)
    colour: ColourRecord = ColourRecord()
    roughness: Positive = 1.0
    noise_share: Positive = 1.0
    held_command: bool = False
    visited_m: tuple[Finite, Finite] | None = None
    forecast: ForecastRecord | None = None

    @model_validator(mode="after")
    def _with_its_covariance(self) -> ModelRecord:
        _check_covariance(self.covariance, len(self.parameters))
        for name in ("visited_m", "travel_m"):
            reach = getattr(self, name)
            if reach is not None and not reach[0] <= reach[1]:
                raise ValueError(f"{name} ends before it begins")
        return self


def _check_covariance(covariance: CovarianceRows, count: int) -> None:
    """Refuse a covariance that is not one of `count` parameters, null where a fit did not give it."""
    check_square(covariance, count)
    rows = [[np.nan if one is None else one for one in row] for row in covariance]
    fault = covariance_fault(np.array(rows, dtype=float).reshape(count, count))
    if fault:
        raise ValueError(f"covariance {fault}")
