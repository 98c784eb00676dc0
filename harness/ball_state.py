"""The ball's state from the measurement: position, velocity and the acceleration that no model explains.

The measurement is smoothed *relative to a free run of CAM*: what remains is a smooth signal whose second derivative is
the residual acceleration. So the velocity profits from the recorded angle without trusting the model: whatever the
model lacks is free to appear in the remainder.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from analytic.kernel import Grid, integrate
from analytic.models import CAM, coefficients
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.smoothing.wiener import Smoothed, smooth

# Readings further off than this many standard deviations are taken for spikes and lose weight (Huber's ψ, squared).
_SPIKE = 3.0
_ROUNDS = 6


@dataclass(frozen=True)
class BallEstimate:
    """What the measurement says of the ball.

    Attributes:
        time: stamps, shape (n,) [s].
        position, velocity: s [m] and ṡ [m/s], shape (n,).
        residual: acceleration beyond CAM's, shape (n,) [m/s²].
        covariance: of s, ṡ and the residual, shape (n, 3, 3).
        noise: standard deviation of a position reading [m].
        noise_estimated: whether that was estimated from the record.
        trusted: readings that were given and are no spikes, shape (n,) bool.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    residual: FloatArray
    covariance: FloatArray
    noise: float
    noise_estimated: bool
    trusted: np.ndarray

    def state(self, index: int) -> State:
        """The ball at stamp `index`."""
        return State(float(self.position[index]), float(self.velocity[index]))

    def spread(self, index: int) -> FloatArray:
        """Covariance of (s, ṡ) at stamp `index`, shape (2, 2) [m², m²/s, m²/s²]."""
        return self.covariance[index, :2, :2]


def estimate_ball(
    time: FloatArray,
    position: FloatArray,
    motion: BeamMotion,
    rig: Rig,
    *,
    noise: float | None = None,
    resolution: float | None = None,
) -> BallEstimate:
    """Estimate the ball's state at every stamp.

    Args:
        time: stamps, shape (n,), strictly increasing [s].
        position: readings, shape (n,), NaN where not known [m]; at least three are needed.
        motion: the beam.
        rig: what CAM is run with; where the rig is unknown a rough one does.
        noise: standard deviation of a reading [m]; `None` to estimate it.
        resolution: distance of two readings [m]; `None` for a continuous reading.

    Raises:
        ValueError: fewer than three positions are known.
    """
    known = np.isfinite(position)
    if known.sum() < 3:
        raise ValueError("fewer than three positions are known")
    begin = int(np.argmax(known))
    grid = Grid.over(time)
    table = grid.tabulate(motion)
    start = np.array([[position[begin], 0.0]])
    # A free run starts at rest from the first reading; before it (if anything is before) there is no run.
    run = integrate(grid, table, coefficients(CAM, rig), start, first=np.array([begin]))
    model, model_rate = run.position[0], run.velocity[0]
    model[:begin], model_rate[:begin] = position[begin], 0.0
    remainder = np.where(known, position - model, 0.0)

    rounding = (resolution or 0.0) ** 2 / 12.0
    given = noise is not None
    weight = np.where(known, 1.0, 0.0)
    variance = (noise if noise is not None else _rough_noise(time[known], remainder[known])) ** 2 + rounding
    density: float | None = None
    smoothed: Smoothed
    for _ in range(_ROUNDS):
        with np.errstate(divide="ignore"):
            each = np.where(weight > 0.0, variance / weight, np.inf)
        if given:
            smoothed = smooth(time, remainder, each)
        else:
            density, variance = _likeliest(time, remainder, each / variance, density, variance, rounding)
            smoothed = smooth(time, remainder, each * 0 + np.where(weight > 0, variance / weight.clip(1e-12), np.inf), density)
        off = np.abs(remainder - smoothed.mean[:, 0]) / math.sqrt(variance)
        new = np.where(known, np.minimum(1.0, (_SPIKE / off.clip(1e-12)) ** 2), 0.0)
        settled = np.max(np.abs(new - weight)) < 0.05
        weight = new
        if settled:
            break
    return BallEstimate(
        time=time,
        position=model + smoothed.mean[:, 0],
        velocity=model_rate + smoothed.mean[:, 1],
        residual=smoothed.mean[:, 2],
        covariance=smoothed.covariance,
        noise=math.sqrt(variance),
        noise_estimated=not given,
        trusted=known & (weight > 0.25),
    )


def _rough_noise(time: FloatArray, value: FloatArray) -> float:
    """Noise [m] from second differences, robustly: they hardly see the motion."""
    second = np.diff(value, 2)
    return max(1.4826 * float(np.median(np.abs(second))) / math.sqrt(6.0), 1e-6)


def _likeliest(
    time: FloatArray,
    value: FloatArray,
    scale: FloatArray,
    density: float | None,
    variance: float,
    rounding: float,
) -> tuple[float, float]:
    """Density and noise variance of greatest evidence, the variance of reading k being `scale[k]` times it."""
    if density is None:
        density = smooth(time, value, scale * variance).density

    def miss(x: FloatArray) -> float:
        return -smooth(time, value, scale * (math.exp(x[0]) + rounding), math.exp(x[1])).log_evidence

    start = (math.log(max(variance - rounding, 0.01 * variance)), math.log(density))
    found = minimize(miss, start, method="Nelder-Mead", options={"xatol": 0.05, "fatol": 0.05})
    return math.exp(found.x[1]), math.exp(found.x[0]) + rounding
