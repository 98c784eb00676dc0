"""Standard error of an RMS pooled over windows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.motion import FloatArray

RESAMPLES = 2000  # the standard error is then itself known to 1/√(2·2000) = 1.6 %


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
    from scipy import stats  # imported here because it takes as long as all other imports together

    squares = np.array([np.sum(np.square(error)) for error in errors])
    counts = np.array([error.size for error in errors], dtype=np.float64)
    if len(errors) < 2 or not np.all(np.isfinite(squares)):
        return np.nan

    def pooled_rms(squares: FloatArray, counts: FloatArray, axis: int) -> FloatArray:
        pooled: FloatArray = np.sqrt(np.sum(squares, axis=axis) / np.sum(counts, axis=axis))
        return pooled

    result = stats.bootstrap(
        (squares, counts),
        pooled_rms,
        paired=True,
        vectorized=True,
        n_resamples=RESAMPLES,
        method="percentile",
        rng=np.random.default_rng(seed),
    )
    return float(result.standard_error)
