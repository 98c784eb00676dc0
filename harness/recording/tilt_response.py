"""How the ball answered the beam: the slope of its acceleration against g α, seen without differentiating noise.

For a smooth bump φ that vanishes with its derivatives at its ends, ∫ s̈ φ dt = ∫ s φ̈ dt (two integrations by parts).
So ∫ s φ̈ dt against ∫ g α φ dt has the slope of s̈ against g α, with *both* channels seen through the same window. The
paper's eq. 14 also has a term in α̈, whose lever is not always known: ∫ α φ̈ dt is regressed out of both. A rolling ball
has the slope K = 1/(1 + J/(m r²)), 0.4 to 0.8 for solid balls; units and signs gone wrong show as factors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.motion import FloatArray

MOST_SAMPLES = 4000  # longer records are averaged down to this many; both channels alike
FEWEST_HALF_WINDOW = 5  # samples, below which the bump is not resolved
WINDOW_GROWTH = 1.5
FEWEST_WINDOWS = 6  # half windows a record must hold, or regression sees one swing only


@dataclass(frozen=True)
class TiltResponse:
    """Partial regression of ∫ s φ̈ on ∫ g α φ, for the window that tells most.

    Attributes:
        slope: of s̈ against g α [1].
        correlation: partial, between the two, -1 … 1.
        evidence: Student's t of the correlation, with one degree of freedom per half window.
    """

    slope: float
    correlation: float
    evidence: float


def tilt_response(
    step: float, angle: FloatArray, position: FloatArray, *, gravity: float = 9.81
) -> TiltResponse | None:
    """Regresses the ball's acceleration on the tilt, an offset and α̈.

    Args:
        step: time between samples [s].
        angle: α on that even grid, shape (n,) [rad].
        position: s, shape (n,), free of NaN [m].
        gravity: g [m/s²].

    Returns:
        The response, or `None` when the record is too short or one channel does not move.
    """
    block = -(-len(angle) // MOST_SAMPLES)
    count = len(angle) // block
    tilt, path = (
        channel[: count * block].reshape(count, block).mean(axis=1) * scale
        for channel, scale in ((angle, gravity), (position, 1.0))
    )
    if np.ptp(tilt) == 0.0 or np.ptp(path) == 0.0:
        return None
    best: TiltResponse | None = None
    half = FEWEST_HALF_WINDOW
    while half * FEWEST_WINDOWS <= count:
        response = _regress(tilt, path, half, step * block)
        if best is None or response.evidence > best.evidence:
            best = response
        half = int(half * WINDOW_GROWTH) + 1
    return best


def _regress(tilt: FloatArray, path: FloatArray, half: int, step: float) -> TiltResponse:
    x = np.arange(-half, half + 1) / half
    u = 1.0 - x**2
    bump = u**4
    curvature = (48.0 * x**2 * u**2 - 8.0 * u**3) / (half * step) ** 2
    driven, shaken, answer = (
        seen - seen.mean()
        for seen in (
            np.convolve(tilt - tilt.mean(), bump, mode="valid"),
            np.convolve(tilt - tilt.mean(), curvature, mode="valid"),
            np.convolve(path - path.mean(), curvature, mode="valid"),
        )
    )
    driven, answer = _freed_of(shaken, driven), _freed_of(shaken, answer)
    power, reply, product = float(driven @ driven), float(answer @ answer), float(driven @ answer)
    if power == 0.0 or reply == 0.0:
        return TiltResponse(0.0, 0.0, 0.0)
    correlation = product / np.sqrt(power * reply)
    freedom = len(tilt) / half - 3.0
    evidence = abs(correlation) * np.sqrt(freedom / max(1.0 - correlation**2, 1e-12))
    return TiltResponse(product / power, float(correlation), float(evidence))


def _freed_of(known: FloatArray, signal: FloatArray) -> FloatArray:
    """`signal` without its part along `known`."""
    power = float(known @ known)
    return signal - known * (float(known @ signal) / power) if power else signal
