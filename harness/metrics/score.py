"""Computes all metrics of one source on one horizon."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.motion import FloatArray
from harness.metrics.catalogue import Score
from harness.metrics.displacement import fit_percent, fraction_outside, max_error, rms_error
from harness.metrics.iso18571 import Rating, even_grid, rank, rate
from harness.metrics.lag import lag
from harness.metrics.pooling import rms_standard_error
from harness.metrics.run_comparison import RunComparison, trapezoid_weights
from harness.metrics.time_history import absolute_integral, sprague_geers
from harness.metrics.validation import fraction_within_uncertainty, rms_error_over_uncertainty

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
    displacements = [run.displacement for run in runs]
    deviation = np.concatenate([m - np.mean(m) for m, _ in displacements])
    agreement = sprague_geers(
        np.concatenate([m for m, _ in displacements]), np.concatenate([c for _, c in displacements]), weights
    )
    rating = _median_rating(runs)
    uncertainty = _uncertainty(runs)
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
        sprague_geers_magnitude=agreement.magnitude,
        sprague_geers_phase=agreement.phase,
        sprague_geers_combined=agreement.combined,
        lag_ms=1e3 * _median([lag(r.time[r.valid], r.measured[r.valid], r.time, r.model) for r in runs]),
        iso18571_rating=rating.overall,
        iso18571_corridor=rating.corridor,
        iso18571_phase=rating.phase,
        iso18571_magnitude=rating.magnitude,
        iso18571_slope=rating.slope,
        iso18571_rank=rank(rating.overall),
        tolerance_m=tolerance,
        fraction_outside_tube=fraction_outside(error, tolerance),
        rms_error_over_uncertainty=np.nan if uncertainty is None else rms_error_over_uncertainty(error, uncertainty),
        fraction_within_uncertainty=np.nan if uncertainty is None else fraction_within_uncertainty(error, uncertainty),
    )


def _median(values: Sequence[float]) -> float:
    known = [value for value in values if not np.isnan(value)]
    return float(np.median(known)) if known else np.nan


def _median_rating(runs: Sequence[RunComparison]) -> Rating:
    ratings = [rate(*even_grid(run.time[run.valid], *run.displacement)) for run in runs]
    return Rating(*(_median(column) for column in zip(*ratings, strict=True)))


def _uncertainty(runs: Sequence[RunComparison]) -> FloatArray | None:
    known = [run.uncertainty[run.valid] for run in runs if run.uncertainty is not None]
    return np.concatenate(known) if len(known) == len(runs) else None
