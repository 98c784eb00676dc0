"""Rates with Wilson intervals, counts of outcomes, and coverage of a group of trials."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import binomtest

from benchmarks.calibration.rows import Interval, Outcome, Row

ALL = "all"


def rate(successes: int, trials: int) -> dict[str, float]:
    """Rate with its 95 % interval (Wilson, J. Amer. Statist. Assoc. 22, 1927); NaN without trials."""
    if not trials:
        return {"rate": math.nan, "low": math.nan, "high": math.nan}
    interval = binomtest(successes, trials).proportion_ci(method="wilson")
    return {"rate": successes / trials, "low": float(interval.low), "high": float(interval.high)}


def outcomes(rows: Sequence[Row]) -> dict[str, float]:
    """Number of rows and of each outcome; `rate`: right or partner."""
    counts = {str(outcome): sum(row.outcome is outcome for row in rows) for outcome in Outcome}
    recovered = counts[Outcome.RIGHT] + counts[Outcome.PARTNER]
    return {"cases": len(rows), **counts, **rate(recovered, len(rows))}


def covered(intervals: Sequence[Interval]) -> dict[str, float]:
    """How many intervals contain the truth; `z_rms`: RMS error in standard errors."""
    covered, z = sum(one.covers for one in intervals), np.array([one.z for one in intervals])
    finite = z[np.isfinite(z)]
    z_rms = float(np.sqrt(np.mean(finite**2))) if finite.size else math.nan
    return {"intervals": len(intervals), "covered": covered, **rate(covered, len(intervals)), "z_rms": z_rms}
