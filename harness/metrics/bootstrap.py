"""What the choice of windows does to an RMS error: its standard error, and how sure a reduction of it is."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from analytic.motion import FloatArray
from harness.numerics import rms

FEWEST = 4
"""Windows or blocks for an interval of a difference."""
RESAMPLES = 2000  # the standard error is then itself known to 1/√(2·2000) = 1.6 %
_MARGIN_RESAMPLES = 9999


def rms_standard_error(errors: Sequence[FloatArray], *, seed: int = 0) -> float:
    """Standard error of the RMS pooled over windows, by a bootstrap over whole windows (Efron).

    Errors within a window are correlated through the common start; windows are independent because the models restart
    in each. An error source that lasts longer than a window correlates windows too; the result is then too small.

    Args:
        errors: one non-empty array per window [m].
        seed: of the resampling.

    Returns:
        in the unit of `errors`; NaN for fewer than two windows or errors that are not finite.
    """
    squares = np.array([np.sum(np.square(error)) for error in errors])
    counts = np.array([error.size for error in errors], dtype=np.float64)
    if len(errors) < 2 or not np.all(np.isfinite(squares)):
        return np.nan

    def pooled_rms(squares: FloatArray, counts: FloatArray, axis: int) -> FloatArray:
        pooled: FloatArray = np.sqrt(np.sum(squares, axis=axis) / np.sum(counts, axis=axis))
        return pooled

    return float(_bootstrap((squares, counts), pooled_rms, RESAMPLES, seed).standard_error)


@dataclass(frozen=True)
class Margin:
    """Reduction of an RMS error with its confidence interval [m]."""

    value: float
    low: float
    high: float

    @property
    def sure(self) -> bool:
        """Whether the error is reduced beyond what the choice of windows may do."""
        return self.low > 0.0


def mean_reduction(before: FloatArray, after: FloatArray, chance: float = 0.05) -> Margin:
    """By how much the mean of `after` is less than that of `before`; otherwise as `rms_reduction`."""

    def reduction(one: FloatArray, other: FloatArray, axis: int = -1) -> FloatArray:
        return np.asarray(np.mean(one, axis) - np.mean(other, axis))

    return _margin(before, after, reduction, chance)


def rms_reduction(before: FloatArray, after: FloatArray, chance: float = 0.05) -> Margin:
    """By how much the RMS of `after` is less than that of `before`, errors of the same windows, shape (n,) [m] each.

    The interval is a paired percentile bootstrap over windows (Efron and Tibshirani, An Introduction to the Bootstrap,
    1993, chapter 13): windows differ much more among themselves than two predictions of one window do.

    Args:
        chance: two-sided share that the interval leaves out [1].
    """

    def reduction(one: FloatArray, other: FloatArray, axis: int = -1) -> FloatArray:
        return rms(one, axis) - rms(other, axis)

    return _margin(before, after, reduction, chance)


def _margin(before: FloatArray, after: FloatArray, reduction: Callable[..., FloatArray], chance: float) -> Margin:
    found = _bootstrap((before, after), reduction, _MARGIN_RESAMPLES, 0, 1.0 - chance).confidence_interval
    return Margin(float(reduction(before, after)), float(found.low), float(found.high))


def _bootstrap(
    samples: tuple[FloatArray, ...],
    statistic: Callable[..., FloatArray],
    resamples: int,
    seed: int,
    level: float = 0.95,
) -> Any:
    """Scipy's result of a percentile bootstrap of `statistic` over windows, the same of all `samples`."""
    from scipy import stats  # imported here because it takes as long as all other imports together

    return stats.bootstrap(
        samples,
        statistic,
        paired=True,
        vectorized=True,
        method="percentile",
        confidence_level=level,
        n_resamples=resamples,
        rng=np.random.default_rng(seed),
    )
