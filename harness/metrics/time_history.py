"""Integral time-history metrics: the paper's E_disp and E_vel, and those of Sprague and Geers."""

from typing import NamedTuple

import numpy as np

from analytic.motion import FloatArray


def absolute_integral(error: FloatArray, weights: FloatArray) -> float:
    """∫ |e| dt by the trapezoidal rule: E_disp [m s] of e_s [m], E_vel [m] of e_v [m/s] (the paper's Table 2).

    Args:
        error: shape (n,).
        weights: of the trapezoidal rule on the same stamps, shape (n,) [s] (`run_comparison.trapezoid_weights`).

    Returns:
        NaN if n = 0.
    """
    if not error.size:
        return np.nan
    # a single stamp has weight 0; skipping it avoids ∞ · 0
    return float(np.sum(np.abs(error[weights > 0.0]) * weights[weights > 0.0]))


class SpragueGeers(NamedTuple):
    """Magnitude, phase and combined error, all dimensionless; 0 is perfect."""

    magnitude: float
    phase: float
    combined: float


def sprague_geers(measured: FloatArray, model: FloatArray, weights: FloatArray) -> SpragueGeers:
    """Separate errors in magnitude and phase from integrals of the two histories.

    M = √(∫c²dt / ∫m²dt) − 1, P = arccos(∫c m dt / √(∫c²dt ∫m²dt)) / π, C = √(M² + P²), with m measured and c the
    model. M is 0.1 if the model's motion is 10 % too large, and independent of a delay; P is 0 for histories of equal
    shape, φ/π for sines with a phase difference φ, 1 for opposite ones, and independent of a gain.

    Both depend on the zero of the signals, since a large common offset hides any difference. Pass displacements from
    the *measured start* (`RunComparison.displacement`): an acceleration 10 % too large then gives M = 0.1,
    while relative to the mean it would be partly an offset and partly a phase error, and the result does not depend on
    the origin of the position. A constant offset of the model affects both.

    Source: M. A. Sprague, T. L. Geers, "A spectral-element method for modelling cavitation in transient
    fluid-structure interaction", Int. J. Numer. Meth. Eng. 60 (2004) 2467–2499, doi 10.1002/nme.1054.

    Args:
        measured: m, displacement from the measured start, shape (n,) [m].
        model: c, from the same zero, shape (n,) [m].
        weights: of the trapezoidal rule, shape (n,) [s].

    Returns:
        all NaN if the measured ball does not move; phase and combined NaN if the model's does not.
    """
    mm = float(np.sum(weights * measured**2))
    if mm == 0.0:
        return SpragueGeers(np.nan, np.nan, np.nan)
    if not np.all(np.isfinite(model)):
        return SpragueGeers(np.inf, np.nan, np.inf)
    cc = float(np.sum(weights * model**2))
    magnitude = np.sqrt(cc / mm) - 1.0
    if cc == 0.0:
        return SpragueGeers(magnitude, np.nan, np.nan)
    m_unit, c_unit = measured / np.sqrt(mm), model / np.sqrt(cc)
    # 2 asin(½‖ĉ − m̂‖) is the arccos of the inner product without its loss of half the digits near 1
    chord = float(np.sqrt(np.sum(weights * (c_unit - m_unit) ** 2)))
    phase = 2.0 * np.arcsin(min(0.5 * chord, 1.0)) / np.pi
    return SpragueGeers(float(magnitude), float(phase), float(np.hypot(magnitude, phase)))
