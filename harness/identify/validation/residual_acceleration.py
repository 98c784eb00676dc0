"""Residual acceleration: measured minus modelled acceleration along the measured path, and that of identified terms.

The two are computed independently of each other, so that agreement supports the identified law.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.borrowed import borrowed
from analytic.compiled import njit
from analytic.effects import SensorLaw
from analytic.models import CAM
from analytic.motion import FloatArray
from analytic.step import advance
from harness.identify.estimate.fit import Fit
from harness.identify.filter.dynamics import Dynamics
from harness.identify.problem.hypothesis import NOTHING, Terms
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.signals.ball_state import BallEstimate

_ABSURD = 1e6  # [m/s²]


@dataclass(frozen=True)
class ResidualAcceleration:
    """Residual acceleration of one recording; arrays of shape (n,) at its stamps.

    Attributes:
        time: stamps [s].
        position, velocity, angle: s [m], ṡ [m/s] and α [rad] of the measured path.
        residual: measured acceleration minus that of the model with the known effects [m/s²].
        deviation: its standard deviation [m/s²].
        law: acceleration that the identified terms add along the measured path, NaN where they give none [m/s²].
        trusted: False for outliers.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    angle: FloatArray
    residual: FloatArray
    deviation: FloatArray
    law: FloatArray
    trusted: NDArray[np.bool_]


def residual_acceleration(
    problem: Problem, found: Fit, recording: PreparedRecording, ball: BallEstimate
) -> ResidualAcceleration:
    """Residual acceleration of one of the problem's recordings, and that of the terms of `found`.

    Args:
        ball: the state estimated from the readings, whose residual is relative to CAM alone.
    """
    cam = _acceleration(replace(problem, declared=(), model=CAM), recording, ball)
    with_known = _acceleration(problem, recording, ball)
    with_terms = _acceleration(problem, recording, ball, found.terms)
    # A polynomial, as of a sensor's curve, has no meaning where a smoothed path left the readings far behind.
    law = np.where(np.abs(with_terms - with_known) < _ABSURD, with_terms - with_known, np.nan)
    return ResidualAcceleration(
        time=recording.time,
        position=ball.position,
        velocity=ball.velocity,
        angle=recording.drive.evaluate(recording.time),
        residual=ball.residual - (with_known - cam),
        deviation=np.sqrt(ball.covariance[:, 2, 2].clip(min=0.0)),
        law=law,
        trusted=ball.trusted & np.isfinite(law),
    )


def _acceleration(
    problem: Problem, recording: PreparedRecording, ball: BallEstimate, added: Terms = NOTHING
) -> FloatArray:
    """Modelled acceleration along the measured path, as recorded by the sensor, shape (n,) [m/s²]."""
    model = Dynamics(problem, added)
    p, table = model.of(recording)
    sensor = model.law
    position = sensor.position(ball.position)
    velocity = ball.velocity / sensor.slope(position)
    out = np.empty(len(recording.time))
    _along(position, velocity, recording.grid.steps, recording.grid.marks, table, p, out)
    # A lag is linear and time-invariant: it acts on the acceleration as on the position.
    if sensor.lag > 0.0:
        out = SensorLaw(lag=sensor.lag).recorded(recording.time, out)
    return sensor.slope(position) * out + sensor.bend(position) * velocity**2


@njit(cache=True)
def _along(
    position: FloatArray,
    velocity: FloatArray,
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    p: FloatArray,
    out: FloatArray,
) -> None:
    """Mean s̈ from each stamp to the next, restarted on the path at each stamp; internal states of effects continue."""
    table, p, w = borrowed(table), borrowed(p), 0.0
    for n in range(len(position) - 1):
        s, v, span = position[n], velocity[n], 0.0
        for j in range(marks[n], marks[n + 1]):
            s, v, w = advance(s, v, w, steps[j], table, 2 * j, p)
            span += steps[j]
        out[n] = (v - velocity[n]) / span
    out[-1] = out[-2]
