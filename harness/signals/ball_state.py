"""The ball's state from the measurement: position, velocity and residual acceleration.

The measurement is smoothed *relative to a run of CAM*: their difference is a smooth signal whose second derivative is
the residual acceleration. So the velocity profits from the recorded angle without trusting the model: what the model
lacks appears in the difference. Spikes are recognised, also where all are on one side (`harness.signals.outliers`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from analytic.kernel import Grid
from analytic.law import accelerations
from analytic.models import CAM, coefficients
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.signals.outliers import smooth_spiky
from harness.signals.prescribed import integrate_twice

# A correct model leaves no less [m²/s⁵]: the angle of an encoder of 40,000 counts is known to about 3e-5 rad, an
# acceleration of a = K g 3e-5 = 2e-4 m/s², correlated over τ = 0.5 s: a²/τ. With less, the error bars of a recording
# without residual would be smaller than the drive's own error.
_LEAST_DENSITY = 1e-7


@dataclass(frozen=True)
class BallEstimate:
    """The ball's state estimated from the measurement.

    Attributes:
        time: stamps, shape (n,) [s].
        position, velocity: s [m] and ṡ [m/s], shape (n,).
        residual: acceleration beyond CAM's, shape (n,) [m/s²].
        covariance: of s, ṡ and the residual, shape (n, 3, 3).
        noise: standard deviation of a position reading that is no spike, before rounding [m].
        noise_estimated: whether that is estimated from the record alone, because none was declared.
        trusted: readings that were taken and are no spikes, shape (n,) bool.
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

    def at(self, stamps: slice) -> BallEstimate:
        """The same at some of its stamps."""
        every = ("time", "position", "velocity", "residual", "covariance", "trusted")
        return replace(self, **{name: getattr(self, name)[stamps] for name in every})

    def state_covariance(self, index: int) -> FloatArray:
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
        rig: what CAM is run with; a rough one will do where the rig is unknown.
        noise: declared standard deviation of a reading [m], which a long record may correct; `None` if unknown.
        resolution: distance of two readings [m]; `None` for a continuous reading.

    Raises:
        ValueError: fewer than three positions are known.
    """
    known = np.isfinite(position)
    if known.sum() < 3:
        raise ValueError("fewer than three positions are known")
    reference, reference_rate = _guided_run(time, np.interp(time, time[known], position[known]), motion, rig)
    rounding = (resolution or 0.0) / math.sqrt(12.0)
    declared = None if noise is None else math.hypot(noise, rounding)
    found = smooth_spiky(time, position - reference, least=rounding, declared=declared, least_density=_LEAST_DENSITY)
    remainder = found.smoothed.mean
    spikes = found.noise.has_spikes
    variance = found.noise.core if spikes else found.noise.total
    return BallEstimate(
        time=time,
        position=reference + remainder[:, 0],
        velocity=reference_rate + remainder[:, 1],
        residual=remainder[:, 2],
        covariance=found.smoothed.covariance,
        noise=math.sqrt(max(variance - rounding**2, 0.0)),
        noise_estimated=noise is None,
        trusted=known & (found.core > 0.5) if spikes else known,
    )


def _guided_run(time: FloatArray, path: FloatArray, motion: BeamMotion, rig: Rig) -> tuple[FloatArray, FloatArray]:
    """CAM's s [m] and ṡ [m/s] from rest at `path[0]`, its s α̇² taken at the measured `path`; all of shape (n,).

    A free run ends far from the ball where the model lacks something, and its own s α̇² would then appear as a residual.
    An error of the start is a straight line, which appears in the difference.
    """
    grid = Grid.over(time)
    ball = np.interp(grid.edges, time, path)
    # CAM's acceleration does not depend on the velocity.
    prescribed = accelerations(ball, np.zeros_like(ball), grid.tabulate(motion), coefficients(CAM, rig))
    position, velocity = integrate_twice(grid, prescribed)
    return path[0] + position, velocity
