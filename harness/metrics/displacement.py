"""Elementary error metrics: maximum, RMS, normalised fit, share outside a tube.

All valid stamps have equal weight; `error` is model − measured.
"""

from __future__ import annotations

import numpy as np

from analytic.motion import FloatArray
from harness.numerics import rms


def max_error(error: FloatArray) -> float:
    """max |e|, in the unit of `error`, shape (n,); NaN if n = 0. The paper's "max displacement error" (Table 2)."""
    return float(np.max(np.abs(error))) if error.size else np.nan


def rms_error(error: FloatArray) -> float:
    """√(mean e²), in the unit of `error`, shape (n,); NaN if n = 0."""
    return rms(error) if error.size else np.nan


def fit_percent(error: FloatArray, deviation: FloatArray) -> float:
    """Normalised fit 100 (1 − ‖e‖/‖s − mean s‖) [%]: 100 is a perfect model, 0 no better than a constant.

    Source: L. Ljung, "System Identification: Theory for the User", 2nd ed., 1999 (`compare` of his toolbox).

    Args:
        error: e, shape (n,) [m].
        deviation: s − mean s of the measurement, shape (n,) [m].

    Returns:
        at most 100, unbounded below; NaN if the measurement is constant.
    """
    motion = float(np.linalg.norm(deviation))
    return 100.0 * (1.0 - float(np.linalg.norm(error)) / motion) if motion > 0.0 else np.nan


def fraction_outside(error: FloatArray, tolerance: float) -> float:
    """Share of stamps outside the tube |e| <= tolerance [1].

    Args:
        error: shape (n,) [m].
        tolerance: half width of the tube [m].
    """
    return float(np.mean(np.abs(error) > tolerance)) if error.size else np.nan
