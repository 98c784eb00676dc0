"""Objective rating metric for non-ambiguous signals, ISO/TS 18571:2014.

Four ratings between 0 (bad) and 1 (good) and their weighted sum: the *corridor* rates the distance at equal times, the
*phase* the shift of highest correlation, *magnitude* and *slope* what remains after that shift: differences
of amplitude along a dynamic time warp, and of the smoothed derivative. Constants are the standard's.

The standard was written for crash signals of about 1,500 samples. It requires an even grid and counts in samples: it
smooths the derivative over nine of them. Measurement noise therefore lowers the slope rating of even a perfect model:
compare the ratings of models on one recording, not across recordings.

The published package objective-rating-metrics is the reference in the tests but not a dependency: it takes 0.3 s per
rating of 1,600 samples (here 0.01 s) and 5 s to import, fails below 11 samples, and rates constant measurements.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.motion import FloatArray

INNER_CORRIDOR, OUTER_CORRIDOR = 0.05, 0.5  # a₀, b₀: half widths over the largest measured |value|
CORRIDOR_EXPONENT = 2  # k_Z
MAX_SHIFT_DIVISOR = 5  # ε_P = 0.2 of the signal's length
WARP_DIVISOR = 10  # width of the warping band: less than 0.1 of the length
MAX_MAGNITUDE_ERROR = 0.5  # ε_M
MAX_SLOPE_ERROR = 2.0  # ε_S
SMOOTHING_SAMPLES = 9
WEIGHTS = {"corridor": 0.4, "phase": 0.2, "magnitude": 0.2, "slope": 0.2}
RANKS = ((0.94, "excellent"), (0.80, "good"), (0.58, "fair"))  # rating above -> rank; else poor

TIE = 1e-12  # correlations closer than this are equal up to rounding; the standard then takes the smaller shift


class Rating(NamedTuple):
    """The overall rating and its four parts, each from 0 (bad) to 1 (good); NaN if undefined."""

    overall: float
    corridor: float
    phase: float
    magnitude: float
    slope: float


UNDEFINED = Rating(np.nan, np.nan, np.nan, np.nan, np.nan)


def rank(rating: float) -> str:
    """The standard's name for an overall rating: excellent, good, fair or poor; "undefined" for NaN."""
    if np.isnan(rating):
        return "undefined"
    return next((name for above, name in RANKS if rating > above), "poor")


def even_grid(time: FloatArray, measured: FloatArray, model: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(measured, model) on an even grid of the median spacing, linearly interpolated, shape (k,) each.

    Args:
        time: strictly increasing, shape (n,) [s].
        measured, model: shape (n,) [m].
    """
    if len(time) < 2:
        return measured, model
    count = round(float((time[-1] - time[0]) / np.median(np.diff(time)))) + 1
    grid = np.linspace(time[0], time[-1], count)
    return np.interp(grid, time, measured), np.interp(grid, time, model)


def rate(measured: FloatArray, model: FloatArray) -> Rating:
    """Ratings of `model` against `measured` (clauses 6.2 and 6.3 of the standard).

    Ratings depend on the zero of the signals: pass displacements from the start.

    Args:
        measured: T, on an even grid, shape (n,) [m].
        model: C, on the same grid, shape (n,) [m].

    Returns:
        `UNDEFINED` if n < 11 (nine samples must overlap at the largest shift), the model is not finite or the
        measurement is constant. A constant model correlates at no shift and is rated as not shifted.
    """
    n = len(measured)
    if n - n // MAX_SHIFT_DIVISOR < SMOOTHING_SAMPLES or np.ptp(measured) == 0.0 or not np.all(np.isfinite(model)):
        return UNDEFINED
    shift = best_shift(measured, model)
    late, early = max(shift, 0), max(-shift, 0)
    measured_cut = measured[early : n - late]
    model_cut = model[late : n - early]
    parts = {
        "corridor": _corridor(measured, model),
        "phase": max(0.0, 1.0 - MAX_SHIFT_DIVISOR * abs(shift) / n),
        "magnitude": _magnitude(measured_cut, model_cut),
        "slope": _slope(measured_cut, model_cut),
    }
    return Rating(overall=sum(WEIGHTS[name] * value for name, value in parts.items()), **parts)


def best_shift(measured: FloatArray, model: FloatArray) -> int:
    """Shift of highest correlation over the overlap, in samples; positive: the model is late; 0 if there is none."""
    reach = len(measured) // MAX_SHIFT_DIVISOR
    shifts = np.zeros(2 * reach + 1, dtype=np.int64)  # 0, +1, −1, +2, −2 …: the first of equals is the smallest
    shifts[1::2] = np.arange(1, reach + 1)
    shifts[2::2] = -np.arange(1, reach + 1)
    correlations = _shifted_correlations(measured, model, shifts)
    if np.isnan(correlations).all():
        return 0
    return int(shifts[np.argmax(correlations >= np.nanmax(correlations) - TIE)])


def smoothed_slope(signal: FloatArray) -> FloatArray:
    """Derivative per sample by central differences, averaged over 9 samples; over 7, 5, 3, 1 towards the ends."""
    derivative = np.gradient(signal)
    index = np.arange(len(signal))
    half = np.minimum(np.minimum(index, index[::-1]), SMOOTHING_SAMPLES // 2)
    running = np.concatenate(([0.0], np.cumsum(derivative)))
    averaged: FloatArray = (running[index + half + 1] - running[index - half]) / (2 * half + 1)
    return averaged


def _corridor(measured: FloatArray, model: FloatArray) -> float:
    size = np.max(np.abs(measured))
    inner, outer = INNER_CORRIDOR * size, OUTER_CORRIDOR * size
    rating = np.clip((outer - np.abs(model - measured)) / (outer - inner), 0.0, 1.0)
    return float(np.mean(rating**CORRIDOR_EXPONENT))


def _magnitude(measured: FloatArray, model: FloatArray) -> float:
    width = -(-len(measured) // WARP_DIVISOR) - 1
    difference, size = _warped_difference(model, measured, width)
    return max(0.0, 1.0 - difference / (MAX_MAGNITUDE_ERROR * size)) if size > 0.0 else np.nan


def _slope(measured: FloatArray, model: FloatArray) -> float:
    wanted = smoothed_slope(measured)
    size = float(np.sum(np.abs(wanted)))
    difference = float(np.sum(np.abs(smoothed_slope(model) - wanted)))
    return max(0.0, 1.0 - difference / (MAX_SLOPE_ERROR * size)) if size > 0.0 else np.nan


@njit(cache=True)
def _shifted_correlations(measured: FloatArray, model: FloatArray, shifts: NDArray[np.int64]) -> FloatArray:
    """Pearson's correlation of measured[i] with model[i + shift]; NaN if one of them is constant."""
    n = measured.size
    rounding = (4.0 * np.finfo(np.float64).eps) ** 2
    result = np.full(shifts.size, np.nan)
    for k in range(shifts.size):
        shift = shifts[k]
        first, last = max(0, -shift), min(n, n - shift)
        count = last - first
        x_mean = measured[first:last].mean()
        y_mean = model[first + shift : last + shift].mean()
        xx = yy = xy = 0.0
        for i in range(first, last):
            dx, dy = measured[i] - x_mean, model[i + shift] - y_mean
            xx += dx * dx
            yy += dy * dy
            xy += dx * dy
        if xx > rounding * count * x_mean**2 and yy > rounding * count * y_mean**2:
            result[k] = xy / np.sqrt(xx * yy)
    return result


@njit(cache=True)
def _warped_difference(x: FloatArray, y: FloatArray, width: int) -> tuple[float, float]:
    """(Σ|x_i − y_j|, Σ|y_j|) along the warp of least Σ(x_i − y_j)² from (0, 0) to (n−1, n−1) with |i − j| <= width.

    Memory: two rows of costs, and one byte per cell for backtracking: 0 from (i−1, j), 1 from (i, j−1), 2 from
    (i−1, j−1). Of equal costs the first is taken.
    """
    n = x.size
    came_from = np.zeros((n, 2 * width + 1), dtype=np.int8)
    previous = np.full(n, np.inf)
    current = np.full(n, np.inf)
    for i in range(n):
        left = np.inf
        for j in range(max(0, i - width), min(n, i + width + 1)):
            best, step = previous[j], 0
            if left < best:
                best, step = left, 1
            if i > 0 and j > 0 and previous[j - 1] < best:
                best, step = previous[j - 1], 2
            if i == 0 and j == 0:
                best = 0.0
            left = best + (x[i] - y[j]) ** 2
            current[j] = left
            came_from[i, j - i + width] = step
        previous, current = current, previous
    i = j = n - 1
    difference, size = abs(x[i] - y[j]), abs(y[j])
    while i > 0 or j > 0:
        step = came_from[i, j - i + width]
        i -= step != 1
        j -= step != 0
        difference += abs(x[i] - y[j])
        size += abs(y[j])
    return difference, size
