"""Comparison error relative to the validation uncertainty u_val.

Source: ASME V&V 20-2009 (R2021), "Standard for Verification and Validation in Computational Fluid Dynamics and Heat
Transfer": E = S − D is judged against u_val = √(u_num² + u_input² + u_D²). |E| well above u_val is an error of the
model; |E| of about u_val is explained by the uncertainties of numerics, inputs (here start state and beam angle) and
data (position sensor).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from analytic.motion import FloatArray
from harness.metrics.displacement import fraction_outside, rms_error

COVERAGE = 2.0  # expanded uncertainty U = 2 u: 95 % of a normal distribution


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
