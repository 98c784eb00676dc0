"""Computes all metrics of one source on one horizon."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from harness.metrics.bootstrap import rms_standard_error
from harness.metrics.catalogue import Score
from harness.metrics.errors import (
    fit_percent,
    fraction_outside,
    fraction_within_uncertainty,
    max_error,
    rms_error,
    rms_error_over_uncertainty,
)
from harness.metrics.iso18571 import Rating, even_grid, rank, rate
from harness.metrics.lag import lag
from harness.metrics.run_comparison import RunComparison, trapezoid_weights
from harness.metrics.time_history import absolute_integral, sprague_geers

TOLERANCE = 0.010  # half width of the tube [m]: the paper's best model stays within 9 mm (Table 2)
WHOLE = "whole"


def horizon_name(seconds: float | None) -> str:
    """Name of a horizon, as in "whole" (None), "1 s", "0.5 s"."""
    return WHOLE if seconds is None else f"{seconds:g} s"


def score(
    source: str,
    windows: RunComparison | Sequence[RunComparison],
    *,
    horizon: str = WHOLE,
    tolerance: float = TOLERANCE,
) -> Score:
    """Score one source on one horizon.

    Pass one comparison per recording for the horizon "whole", else one per window, the model restarted in each.
    Pooling over windows: extremes are taken over all; RMS, fit, Sprague–Geers and shares use all stamps together (with
    mean and start of each window); E_disp and E_vel are summed, as over the whole run; lag and ISO ratings are medians
    over the windows where they are defined.

    Args:
        source: name of the model or engine (`cam`, `mujoco` …).
        windows: the runs.
        horizon: name of the horizon (`horizon_name`).
        tolerance: half width of the tube [m].

    Returns:
        all metrics; those of velocity are NaN without velocities, those of u_val unless every window has one.

    Raises:
        ValueError: there is no window.
    """
    runs = [windows] if isinstance(windows, RunComparison) else list(windows)
    if not runs:
        raise ValueError(f"no window to score {source} on")
    errors = [run.error for run in runs]
    error = np.concatenate(errors)
    ends = np.array([abs(e[-1]) for e in errors])
    weights = np.concatenate([trapezoid_weights(run.time[run.valid]) for run in runs])
    velocity_error = np.concatenate([run.velocity_error for run in runs])
    velocity_weights = np.concatenate([trapezoid_weights(run.time[run.velocity_valid]) for run in runs])
    measured, model = zip(*(run.displacement for run in runs), strict=True)
    deviation = np.concatenate([one - np.mean(one) for one in measured])
    agreement = sprague_geers(np.concatenate(measured), np.concatenate(model), weights)
    ratings = [rate(*even_grid(run.time[run.valid], *run.displacement)) for run in runs]
    rating = Rating(*(_median(column) for column in zip(*ratings, strict=True)))
    known = [run.uncertainty[run.valid] for run in runs if run.uncertainty is not None]
    uncertainty = np.concatenate(known) if len(known) == len(runs) else np.full(error.size, np.nan)
    return Score(
        source=source,
        horizon=horizon,
        windows=len(runs),
        samples=error.size,
        duration_s=float(np.sum(weights)),
        max_error_m=max_error(error),
        rms_error_mm=1e3 * rms_error(error),
        rms_error_standard_error_mm=1e3 * rms_standard_error(errors),
        e_disp_m_s=absolute_integral(error, weights),
        end_error_median_mm=1e3 * float(np.median(ends)),
        end_error_max_mm=1e3 * float(np.max(ends)),
        fit_percent=fit_percent(error, deviation),
        max_velocity_error_m_s=max_error(velocity_error),
        rms_velocity_error_m_s=rms_error(velocity_error),
        e_vel_m=absolute_integral(velocity_error, velocity_weights),
        **{f"sprague_geers_{name}": value for name, value in agreement._asdict().items()},
        lag_ms=1e3 * _median([lag(r.time[r.valid], r.measured[r.valid], r.time, r.model) for r in runs]),
        iso18571_rating=rating.overall,
        **{f"iso18571_{name}": value for name, value in rating._asdict().items() if name != "overall"},
        iso18571_rank=rank(rating.overall),
        tolerance_m=tolerance,
        fraction_outside_tube=fraction_outside(error, tolerance),
        rms_error_over_uncertainty=rms_error_over_uncertainty(error, uncertainty),
        fraction_within_uncertainty=fraction_within_uncertainty(error, uncertainty),
    )


def _median(values: Sequence[float]) -> float:
    known = [value for value in values if not np.isnan(value)]
    return float(np.median(known)) if known else np.nan
