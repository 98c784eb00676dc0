"""Time lag of the model, the shift of highest correlation with the measurement."""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray

MAX_LAG = 0.5  # longest lag searched for [s]; sensors and drives of such rigs lag by tens of milliseconds
MIN_EXPLAINED = 0.5  # share r² of the measured variance that the shifted model must explain
MIN_STAMPS = 20
MIN_MOTION = 1e-9  # range after detrending below which there is only rounding [m]
DRIFT_DEGREE = 2  # drift of a free run due to errors of its start state and a constant error of the angle


def lag(
    measured_time: FloatArray,
    measured: FloatArray,
    time: FloatArray,
    model: FloatArray,
    *,
    max_lag: float = MAX_LAG,
) -> float:
    """The lag τ at which measured(t) and model(t + τ) correlate best; τ > 0: the model is late.

    The model is shifted, by its cubic spline, because it is smooth and known at every stamp; the measurement is used at
    its valid stamps. Stamps within the search range of either end are excluded for all shifts alike, so that a constant
    overlap does not bias τ to 0. Both signals are detrended by a parabola: the ball is a double integrator, and the
    drift of a free run would be mistaken for a lag.

    The lag is undetermined (NaN) with fewer than 20 stamps, if the peak is at an end of the range ±min(max_lag, T/4),
    if the best shifted model explains less than half of the measured variance, or if the standard error of τ exceeds a
    tenth of the range. A ball at rest or with constant velocity or acceleration therefore gives NaN.

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
    y = _orthogonal_to(drift, y)
    spline = CubicSpline(time, model)

    def correlation(shift: float) -> float:
        c = _orthogonal_to(drift, spline(stamps + shift))
        size = float(np.linalg.norm(y) * np.linalg.norm(c))
        return float(y @ c) / size if size > 0.0 else 0.0

    if min(np.ptp(y), np.ptp(_orthogonal_to(drift, spline(stamps)))) <= MIN_MOTION:
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
    if -float(best.fun) < np.sqrt(MIN_EXPLAINED):
        return np.nan
    rate = spline(stamps + shift, 1)
    uncertainty = _standard_error(y, _orthogonal_to(drift, spline(stamps + shift)), _orthogonal_to(drift, rate))
    return shift if uncertainty <= 0.1 * reach else np.nan


def _orthogonal_to(basis: FloatArray, signal: FloatArray) -> FloatArray:
    """`signal` minus its projection on the orthonormal columns of `basis`."""
    return signal - basis @ (basis.T @ signal)


def _standard_error(y: FloatArray, c: FloatArray, c_dot: FloatArray) -> float:
    """Standard error of τ in y ≈ b c(t + τ) with free b, whose least-squares solution maximises the correlation [s].

    Residuals of a free run are strongly autocorrelated. The variance of Σ x e, with x the part of ċ orthogonal to c, is
    therefore estimated after Newey and West (Econometrica 55 (1987) 703–708) with lags up to a tenth of the run.
    """
    gain = float(y @ c) / float(c @ c)
    regressor = c_dot - c * (float(c_dot @ c) / float(c @ c))
    moment = regressor * (y - gain * c)
    lags = max(1, y.size // 10)
    taper = 1.0 - np.arange(1, lags + 1) / (lags + 1)
    covariances = np.array([moment[k:] @ moment[:-k] for k in range(1, lags + 1)])
    variance = max(float(moment @ moment + 2.0 * taper @ covariances), 0.0)
    return float(np.sqrt(variance) / (abs(gain) * (regressor @ regressor)))
