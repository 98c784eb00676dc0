"""How late the model is, by the shift that makes it most like the measurement."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray

MAX_LAG = 0.5  # longest lag searched for [s]; sensors and drives of such rigs are late by tens of milliseconds
MIN_SHARED = 0.5  # share r² of the measured variance that the shifted model must explain
MIN_STAMPS = 20
LEAST_MOTION = 1e-9  # less, once the drift is removed, is rounding [m]
DRIFT_DEGREE = 2  # what a free run gathers from its start state and from a constant error of the angle


def lag(
    measured_time: FloatArray,
    measured: FloatArray,
    time: FloatArray,
    model: FloatArray,
    *,
    max_lag: float = MAX_LAG,
) -> float:
    """The lag τ at which measured(t) and model(t + τ) correlate best; τ > 0: the model is late.

    The model is smooth and known at every stamp, so it is shifted, by its cubic spline; the measurement is taken as it
    is, on whatever stamps it is valid. Stamps within the search range of either end are left out for all shifts
    alike, so that the overlap stays the same and does not pull τ to 0. Parabolas are removed from both: the beam and
    ball is a double integrator, and the drift of a free run would else pass for a lag.

    NaN means "cannot tell": fewer than 20 stamps, the peak lies at the end of the range, ±min(max_lag, T/4), the model
    shifted best explains less than half of the measured variance, or the standard error of τ exceeds a tenth of the
    range. A ball that rests, rolls steadily or is steadily accelerated therefore gives NaN: start and slope explain its
    motion as well as any lag does.

    Args:
        measured_time: valid stamps, strictly increasing, shape (m,) [s].
        measured: position, shape (m,) [m].
        time: the model's stamps, strictly increasing, shape (n,) [s].
        model: position, shape (n,) [m].
        max_lag: longest lag searched for [s].

    Returns:
        τ [s], with |τ| <= max_lag, or NaN.
    """
    reach = min(max_lag, 0.25 * float(time[-1] - time[0]))
    inner = (measured_time >= time[0] + reach) & (measured_time <= time[-1] - reach)
    if np.count_nonzero(inner) < MIN_STAMPS or not np.all(np.isfinite(model)):
        return np.nan
    stamps, y = measured_time[inner], measured[inner]
    drift = np.linalg.qr(np.vander(stamps - np.mean(stamps), DRIFT_DEGREE + 1))[0]
    y = _without(drift, y)
    spline = CubicSpline(time, model)

    def correlation(shift: float) -> float:
        c = _without(drift, spline(stamps + shift))
        size = float(np.linalg.norm(y) * np.linalg.norm(c))
        return float(y @ c) / size if size > 0.0 else 0.0

    if min(np.ptp(y), np.ptp(_without(drift, spline(stamps)))) <= LEAST_MOTION:
        return np.nan
    step = min(float(np.median(np.diff(time))), 0.1 * reach)
    shifts = np.linspace(-reach, reach, 2 * int(np.ceil(reach / step)) + 1)
    peak = int(np.argmax([correlation(shift) for shift in shifts]))
    if peak in (0, len(shifts) - 1):
        return np.nan
    best = minimize_scalar(
        lambda shift: -correlation(shift),
        bounds=(shifts[peak - 1], shifts[peak + 1]),
        method="bounded",
        options={"xatol": 1e-6 * step},
    )
    shift = float(best.x)
    if -float(best.fun) < np.sqrt(MIN_SHARED):
        return np.nan
    rate = spline(stamps + shift, 1)
    uncertainty = _standard_error(y, _without(drift, spline(stamps + shift)), _without(drift, rate))
    return shift if uncertainty <= 0.1 * reach else np.nan


def _without(basis: FloatArray, signal: FloatArray) -> FloatArray:
    """`signal` less its projection on the orthonormal columns of `basis`."""
    return signal - basis @ (basis.T @ signal)


def _standard_error(y: FloatArray, c: FloatArray, c_dot: FloatArray) -> float:
    """Standard error of τ in y ≈ b c(t + τ), b free, whose least squares maximise the correlation [s].

    Residuals of a free run have a long memory. The variance of Σ x e, x the part of ċ that is no gain, is therefore
    Newey and West's (Econometrica 55 (1987) 703–708) with a memory of a tenth of the run.
    """
    gain = float(y @ c) / float(c @ c)
    telling = c_dot - c * (float(c_dot @ c) / float(c @ c))
    pull = telling * (y - gain * c)
    memory = max(1, y.size // 10)
    taper = 1.0 - np.arange(1, memory + 1) / (memory + 1)
    covariances = np.array([pull[k:] @ pull[:-k] for k in range(1, memory + 1)])
    variance = max(float(pull @ pull + 2.0 * taper @ covariances), 0.0)
    return float(np.sqrt(variance) / (abs(gain) * (telling @ telling)))
