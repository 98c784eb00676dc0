"""Regression of the ball's acceleration on g α by modulating functions, without differentiating noisy data.

For a smooth test function φ that vanishes with its derivatives at its ends, ∫ s̈ φ dt = ∫ s φ̈ dt (integrated by parts
twice). Regressing ∫ s φ̈ dt on ∫ g α φ dt therefore gives the slope of s̈ against g α. The paper's eq. 14 also has a
term in α̈ with a possibly unknown lever: ∫ α φ̈ dt is partialled out of both. A rolling ball has the slope
K = 1/(1 + J/(m r²)), 0.4 to 0.8 for solid balls; wrong units and signs show as factors. A delay d of the position adds
−K g d α̇ to first order: with ∫ α φ̇ dt partialled out too the slope does not depend on it, but less of the motion is
left to tell it from.
"""

from dataclasses import dataclass, replace

import numpy as np

from analytic.motion import FloatArray

MAX_SAMPLES = 4000  # longer recordings are block-averaged to this many samples, both channels alike
MIN_HALF_WINDOW = 5  # samples, to resolve the test function
WINDOW_GROWTH = 1.5  # ratio of successive window lengths
MIN_WINDOWS = 6  # half windows per recording; with fewer the regression sees a single swing


@dataclass(frozen=True)
class TiltResponse:
    """Partial regression of ∫ s φ̈ on ∫ g α φ, for the window length with the largest t value.

    Attributes:
        slope: of s̈ against g α [1]; ±∞ where it is too large for a float.
        correlation: partial correlation, -1 … 1.
        t_value: Student's t of the correlation, with one degree of freedom per half window.
    """

    slope: float
    correlation: float
    t_value: float


def tilt_response(
    step: float, angle: FloatArray, position: FloatArray, *, gravity: float = 9.81, delayed: bool = False
) -> TiltResponse | None:
    """Regresses the ball's acceleration on the tilt, an offset and α̈.

    Args:
        step: time between samples [s].
        angle: α on that even grid, shape (n,) [rad].
        position: s, shape (n,), free of NaN [m].
        gravity: g [m/s²].
        delayed: whether the position may lag behind the angle: α̇ is a regressor too.

    Returns:
        The response; `None` if the recording is too short, or one channel is constant or too large for a float.
    """
    block = -(-len(angle) // MAX_SAMPLES)
    count = len(angle) // block
    with np.errstate(over="ignore", invalid="ignore"):
        tilt, path = (
            channel[: count * block].reshape(count, block).mean(axis=1) * scale
            for channel, scale in ((angle, gravity), (position, 1.0))
        )
        sizes = float(np.ptp(tilt)), float(np.ptp(path))
    if not all(0.0 < size < np.inf for size in sizes):
        return None
    # Powers of two, which round nothing: squares of sums of any other unit's numbers may be too large for a float.
    exponents = [int(np.frexp(size)[1]) for size in sizes]
    tilt, path = (np.ldexp(one, -exponent) for one, exponent in zip((tilt, path), exponents, strict=True))
    best: TiltResponse | None = None
    half = MIN_HALF_WINDOW
    while half * MIN_WINDOWS <= count:
        response = _regress(tilt, path, half, step * block, delayed=delayed)
        if best is None or response.t_value > best.t_value:
            best = response
        half = int(half * WINDOW_GROWTH) + 1
    if best is None:
        return None
    with np.errstate(over="ignore"):
        return replace(best, slope=float(np.ldexp(best.slope, exponents[1] - exponents[0])))


def modulating(half: int, step: float) -> tuple[FloatArray, FloatArray]:
    """A smooth test function φ that vanishes with its derivatives at its ends, [1], and φ̈ [1/s²]; (2 half + 1,) each.

    Args:
        half: samples to either side of the middle.
        step: time between samples [s].
    """
    x = np.arange(-half, half + 1) / half
    u = 1.0 - x**2
    return u**4, (48.0 * x**2 * u**2 - 8.0 * u**3) / (half * step) ** 2


def _regress(tilt: FloatArray, path: FloatArray, half: int, step: float, *, delayed: bool) -> TiltResponse:
    test, test_curvature = modulating(half, step)
    test_slope = np.gradient(test, step)
    input_, turning, rate, output = (
        integral - integral.mean()
        for integral in (
            np.convolve(tilt - tilt.mean(), test, mode="valid"),
            np.convolve(tilt - tilt.mean(), test_curvature, mode="valid"),
            np.convolve(tilt - tilt.mean(), test_slope, mode="valid"),
            np.convolve(path - path.mean(), test_curvature, mode="valid"),
        )
    )
    input_, output = _orthogonal_to(turning, input_), _orthogonal_to(turning, output)
    if delayed:
        rate = _orthogonal_to(turning, rate)
        input_, output = _orthogonal_to(rate, input_), _orthogonal_to(rate, output)
    xx, yy, xy = float(input_ @ input_), float(output @ output), float(input_ @ output)
    if xx == 0.0 or yy == 0.0:
        return TiltResponse(0.0, 0.0, 0.0)
    correlation = xy / np.sqrt(xx * yy)
    freedom = len(tilt) / half - (4.0 if delayed else 3.0)
    t_value = abs(correlation) * np.sqrt(freedom / max(1.0 - correlation**2, 1e-12))
    return TiltResponse(xy / xx, float(correlation), float(t_value))


def _orthogonal_to(known: FloatArray, signal: FloatArray) -> FloatArray:
    """`signal` minus its projection on `known`."""
    power = float(known @ known)
    return signal - known * (float(known @ signal) / power) if power else signal
