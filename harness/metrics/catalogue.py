"""The `Score` and the catalogue of its metrics: each field is a column of metrics.csv and an entry of `METRICS`.

A field's name ends in its unit; dimensionless ones have none.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from types import MappingProxyType
from typing import Any

from analytic.naming import did_you_mean
from harness.errors import InputError


class Better(StrEnum):
    """Which values of a metric are better."""

    SMALLER = "smaller"
    LARGER = "larger"
    NEAR_ZERO = "nearer to zero"


@dataclass(frozen=True)
class Metric:
    """Description of one metric, and how a limit on it is checked.

    Attributes:
        name: field of `Score`, column of metrics.csv.
        description: one line, for reports and help texts.
        unit: as printed; "1" if dimensionless.
        better: which values are better.
        aliases: accepted short names.
    """

    name: str
    description: str
    unit: str
    better: Better
    aliases: tuple[str, ...] = ()

    def meets(self, value: float, limit: float) -> bool:
        """Whether `value` satisfies `limit`: at most, at least, or at most in magnitude; false for NaN."""
        match self.better:
            case Better.SMALLER:
                return value <= limit
            case Better.LARGER:
                return value >= limit
            case Better.NEAR_ZERO:
                return abs(value) <= limit


def _metric(description: str, unit: str, better: Better, *aliases: str) -> Any:
    return field(metadata={"description": description, "unit": unit, "better": better, "aliases": aliases})


@dataclass(frozen=True, kw_only=True)
class Score:
    """All metrics of one source on one horizon; NaN if a metric is undefined or its inputs are missing.

    Attributes:
        source: model or engine (`cam`, `mujoco` …).
        horizon: "whole" for the free run over the recording, else the window length, as in "2 s".
        windows: number of runs pooled; every run restarts from the estimated state.
        samples: number of valid stamps in all runs.
        duration_s: total duration of the runs [s].
        iso18571_rank: excellent, good, fair, poor or undefined.
        tolerance_m: half width of the tube of `fraction_outside_tube` [m].

    All other attributes are metrics, described in `METRICS`.
    """

    source: str
    horizon: str
    windows: int
    samples: int
    duration_s: float
    max_error_m: float = _metric("largest |e_s|, e_s = model − measured position", "m", Better.SMALLER, "max")
    rms_error_mm: float = _metric("RMS of e_s over all valid stamps", "mm", Better.SMALLER, "rms")
    rms_error_standard_error_mm: float = _metric(
        "standard error of the RMS, by bootstrap over windows", "mm", Better.SMALLER
    )
    e_disp_m_s: float = _metric(
        "E_disp = ∫ |e_s| dt, summed over windows (paper, Table 2)", "m s", Better.SMALLER, "E_disp"
    )
    end_error_median_mm: float = _metric("median over windows of |e_s| at the end", "mm", Better.SMALLER, "end")
    end_error_max_mm: float = _metric("largest |e_s| at the end of a window", "mm", Better.SMALLER, "max_end")
    fit_percent: float = _metric("100 (1 − ‖e_s‖/‖s − mean s‖), mean of each window", "%", Better.LARGER, "fit")
    max_velocity_error_m_s: float = _metric("largest |e_v|, e_v of velocity", "m/s", Better.SMALLER, "max_velocity")
    rms_velocity_error_m_s: float = _metric("RMS of e_v", "m/s", Better.SMALLER, "rms_velocity")
    e_vel_m: float = _metric("E_vel = ∫ |e_v| dt, summed over windows (paper, Table 2)", "m", Better.SMALLER, "E_vel")
    sprague_geers_magnitude: float = _metric(
        "M: relative error of the size of the motion", "1", Better.NEAR_ZERO, "M", "magnitude"
    )
    sprague_geers_phase: float = _metric("P: phase error; 1 is opposite phase", "1", Better.SMALLER, "P", "phase")
    sprague_geers_combined: float = _metric("C = √(M² + P²)", "1", Better.SMALLER, "C", "sprague_geers")
    lag_ms: float = _metric("shift of highest correlation; positive: the model is late", "ms", Better.NEAR_ZERO, "lag")
    iso18571_rating: float = _metric(
        "overall rating of ISO/TS 18571:2014", "1", Better.LARGER, "iso", "iso18571", "rating"
    )
    iso18571_corridor: float = _metric("corridor rating of ISO/TS 18571:2014", "1", Better.LARGER, "iso_corridor")
    iso18571_phase: float = _metric("phase rating of ISO/TS 18571:2014", "1", Better.LARGER, "iso_phase")
    iso18571_magnitude: float = _metric("magnitude rating of ISO/TS 18571:2014", "1", Better.LARGER, "iso_magnitude")
    iso18571_slope: float = _metric("slope rating of ISO/TS 18571:2014", "1", Better.LARGER, "iso_slope")
    iso18571_rank: str
    tolerance_m: float
    fraction_outside_tube: float = _metric(
        "share of stamps with |e_s| > tolerance", "1", Better.SMALLER, "tube", "outside"
    )
    rms_error_over_uncertainty: float = _metric(
        "RMS of e_s/u_val, about 1 for a perfect model (ASME V&V 20)", "1", Better.SMALLER, "over_uncertainty"
    )
    fraction_within_uncertainty: float = _metric(
        "share of stamps with |e_s| <= 2 u_val, about 0.95 for a perfect model",
        "1",
        Better.LARGER,
        "within_uncertainty",
    )


METRICS: Mapping[str, Metric] = MappingProxyType(
    {item.name: Metric(item.name, **item.metadata) for item in fields(Score) if item.metadata}
)
"""All metrics by name, in the order of the columns."""

_BY_ANY_NAME = {key.lower(): metric for metric in METRICS.values() for key in (metric.name, *metric.aliases)}


def find_metric(name: str) -> Metric:
    """The metric with this name or alias, ignoring case.

    Raises:
        InputError: there is none; the message suggests similar names.
    """
    key = name.strip().lower()
    if key in _BY_ANY_NAME:
        return _BY_ANY_NAME[key]
    hint = did_you_mean(key, _BY_ANY_NAME) or f" Known are {', '.join(METRICS)}."
    raise InputError(f"there is no metric {name!r}.{hint}")
