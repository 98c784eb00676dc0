"""How sure it is that one prediction is better than another on the same windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap

from analytic.motion import FloatArray

_RESAMPLES = 9999


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


def rms_reduction(before: FloatArray, after: FloatArray, chance: float = 0.05) -> Margin:
    """By how much the RMS of `after` is less than that of `before`, errors of the same windows, shape (n,) [m] each.

    The interval is a paired percentile bootstrap over windows (Efron and Tibshirani, An Introduction to the Bootstrap,
    1993, chapter 13): windows differ much more among themselves than two predictions of one window do.

    Args:
        chance: two-sided share that the interval leaves out [1].
    """

    def reduction(one: FloatArray, other: FloatArray, axis: int = -1) -> FloatArray:
        return np.asarray(np.sqrt(np.mean(one**2, axis=axis)) - np.sqrt(np.mean(other**2, axis=axis)))

    found = bootstrap(
        (before, after),
        reduction,
        paired=True,
        vectorized=True,
        method="percentile",
        confidence_level=1.0 - chance,
        n_resamples=_RESAMPLES,
        rng=np.random.default_rng(0),
    ).confidence_interval
    return Margin(float(reduction(before, after)), float(found.low), float(found.high))
