"""The step a sensor counts in, inferred from the values it gave."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from analytic.motion import FloatArray

OFF_GRID = 0.15  # largest distance of a value from its level, in steps; printing with ≥ 4 digits a step stays below
CHANCE = 1e-6  # probability that values without a common step would lie as close to levels
LEVELS_PER_VALUE = 100  # with more levels than this for each distinct value, a step is not seen but imagined
SMALLEST_GAPS = 12


def inferred_resolution(values: ArrayLike) -> float | None:
    """The largest step of which all distinct values, up to one offset, are multiples.

    Levels that never occurred do no harm, nor does printing: a count of 0.0879° printed as 0.088 is found from
    many values, as steps are fitted to all of them. Values printed to decimals and noisier than these have that decimal
    as their step.

    Args:
        values: any shape, any unit; NaN is left out.

    Returns:
        The step in the unit of `values`; `None` when there is none or the values are too few to tell.
    """
    flat = np.asarray(values, dtype=np.float64).ravel()
    distinct = np.unique(flat[np.isfinite(flat)])
    if len(distinct) < 4:
        return None
    span = float(distinct[-1] - distinct[0])
    gaps = np.diff(distinct)
    gaps = gaps[gaps > 1e-9 * span]  # unit conversions leave differences of a few ulp
    quantiles = np.quantile(gaps, np.linspace(0.0, 0.5, SMALLEST_GAPS))
    candidates = {float(gap) / parts for gap in quantiles for parts in (1, 2, 3)}
    for step in sorted(candidates, reverse=True):
        fitted = _fitted_step(distinct, step)
        if fitted is not None and span / fitted <= LEVELS_PER_VALUE * len(distinct):
            return fitted
    return None


def _fitted_step(distinct: FloatArray, step: float) -> float | None:
    """`step` refined to all of the ascending values, or `None` if they do not lie on its multiples."""
    level = np.concatenate(([0.0], np.cumsum(np.round(np.diff(distinct) / step))))
    for _ in range(2):
        if level[-1] < 3:
            return None
        slope, offset = np.polyfit(level, distinct, 1)
        level = np.round((distinct - offset) / slope)
    off = float(np.max(np.abs((distinct - offset) / slope - level)))
    chance = math.pow(2 * max(off, 1e-3), len(np.unique(level)) - 2)  # slope and offset take up two values
    return float(slope) if off <= OFF_GRID and chance < CHANCE else None
