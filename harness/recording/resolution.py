"""Infers a sensor's resolution (quantisation step) from its readings."""

import math

import numpy as np
from numpy.typing import ArrayLike

from analytic.motion import FloatArray

OFF_GRID = 0.15  # largest deviation of a value from its level, in steps; covers rounding to ≥ 4 digits per step
CHANCE = 1e-6  # accepted probability that unquantised values lie as close to levels by chance
LEVELS_PER_VALUE = 100  # most levels per distinct value; beyond, a step cannot be inferred
SMALLEST_GAPS = 12  # candidate steps are quantiles of the smaller half of the gaps between values


def inferred_resolution(values: ArrayLike) -> float | None:
    """The largest step of which all distinct values, up to one offset, are multiples.

    Unused levels and rounding in print are allowed: a count of 0.0879° printed as 0.088 is recovered because the step
    is fitted to all values. For unquantised noisy values printed with few decimals, the last decimal is the step.

    Args:
        values: any shape, any unit; NaN is ignored.

    Returns:
        The step in the unit of `values`; `None` if there is none or there are too few values.
    """
    flat = np.asarray(values, dtype=np.float64).ravel()
    distinct = np.unique(flat[np.isfinite(flat)])
    if len(distinct) < 4:
        return None
    span = float(distinct[-1] - distinct[0])
    gaps = np.diff(distinct)
    gaps = gaps[gaps > 1e-9 * span]  # unit conversion makes equal values differ by a few ulp
    quantiles = np.quantile(gaps, np.linspace(0.0, 0.5, SMALLEST_GAPS))
    candidates = {float(gap) / parts for gap in quantiles for parts in (1, 2, 3)}
    for step in sorted(candidates, reverse=True):
        fitted = _fitted_step(distinct, step)
        if fitted is not None and span / fitted <= LEVELS_PER_VALUE * len(distinct):
            return fitted
    return None


def _fitted_step(distinct: FloatArray, step: float) -> float | None:
    """`step` refined by a fit to all ascending values; `None` if they are not multiples of it."""
    level = np.concatenate(([0.0], np.cumsum(np.round(np.diff(distinct) / step))))
    for _ in range(2):
        if level[-1] < 3:
            return None
        slope, offset = np.polyfit(level, distinct, 1)
        level = np.round((distinct - offset) / slope)
    off = float(np.max(np.abs((distinct - offset) / slope - level)))
    chance = math.pow(2 * max(off, 1e-3), len(np.unique(level)) - 2)  # two degrees of freedom for slope and offset
    return float(slope) if off <= OFF_GRID and chance < CHANCE else None
