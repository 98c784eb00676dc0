"""Linear filters B(q)/F(q) of signals, as banded triangular systems.

`scipy.signal.lfilter` is the same for equal coefficients throughout; but its package takes as long to import as a tenth
of a diagnosis of two short recordings.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dtbtrs

from analytic.motion import FloatArray


def recursion(F: FloatArray, signals: FloatArray) -> FloatArray:
    """1/F(q) of signals, shape (n, c), from rest.

    Args:
        F: coefficients of q⁰ (which is 1), q⁻¹, …, shape (order + 1, n): of lag k in column j, what sample j adds to
            sample j + k, with its sign changed. 0 where nothing passes on.
    """
    solved: FloatArray = dtbtrs(F, signals, uplo="L", diag="U")[0]
    return solved


def linear_filter(B: FloatArray, F: FloatArray, signals: FloatArray) -> FloatArray:
    """B(q)/F(q) of signals, shape (n, c), from rest.

    Args:
        B, F: coefficients of q⁰, q⁻¹, …; the first of F is 1.
    """
    moved = np.zeros_like(signals)
    for lag, coefficient in enumerate(B[: len(signals)]):
        moved[lag:] += coefficient * signals[: len(signals) - lag]
    return recursion(np.repeat(F[:, None], len(signals), axis=1), moved)
