"""Elementary error metrics, and the validation uncertainty u_val that an error is compared with.

All valid stamps have equal weight; `error` is model − measured.

Source of u_val: ASME V&V 20-2009 (R2021), "Standard for Verification and Validation in Computational Fluid Dynamics and
Heat Transfer": E = S − D is judged against u_val = √(u_num² + u_input² + u_D²). |E| well above u_val is an error of the
model; |E| of about u_val is explained by the uncertainties of numerics, inputs (here start state and beam angle) and
data (position sensor).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from analytic.motion import FloatArray
from harness.numerics import rms

COVERAGE = 2.0  # expanded uncertainty U = 2 u: 95 % of a normal distribution


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
    """Share of stamps outside the tube |e| <= tolerance [1]; NaN if n = 0 or an error is.

    Args:
        error: shape (n,) [m].
        tolerance: half width of the tube [m].
    """
    return float(np.mean(np.abs(error) > tolerance)) if error.size and not np.isnan(error).any() else np.nan


def validation_uncertainty(*parts: ArrayLike) -> FloatArray:
    """u_val, the root sum of squares of independent standard uncertainties, broadcast together [m].

    Args:
        parts: e.g. sensor noise, a number [m], and the propagated uncertainty of angle and start at each stamp, shape
            (n,) [m].
    """
    return np.sqrt(sum(np.square(np.asarray(part, dtype=np.float64)) for part in parts))


def rms_error_over_uncertainty(error: FloatArray, uncertainty: FloatArray) -> float:
    """RMS of E/u_val [1]: near 1 for a perfect model at any horizon.

    Args:
        error: E, shape (n,) [m].
        uncertainty: u_val, shape (n,) [m].
    """
    return rms_error(error / uncertainty)


def fraction_within_uncertainty(error: FloatArray, uncertainty: FloatArray) -> float:
    """Share of stamps with |E| <= 2 u_val [1]; about 0.95 for a perfect model. Arguments as above."""
    return 1.0 - fraction_outside(error / uncertainty, COVERAGE)
