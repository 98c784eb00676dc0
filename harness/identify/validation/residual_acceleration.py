"""The trace of what is missing: the acceleration that the model leaves, and the one that the found effects give.

Both are taken along the measured path, so that they can be laid over each other: the measurement's side knows nothing
of the effects, and the law's side nothing of what is left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import njit
from analytic.effects import SensorLaw
from analytic.models import CAM
from analytic.motion import FloatArray
from analytic.step import advance
from harness.identify.estimate.fit import Fit
from harness.identify.filter.run import dynamics
from harness.identify.problem.hypothesis import NOTHING, Terms
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.signals.ball_state import BallEstimate


@dataclass(frozen=True)
class ResidualAcceleration:
    """What is missing in one recording; arrays of shape (n,) at its stamps.

    Attributes:
        time: stamps [s].
        position, velocity, angle: of the measured path, s [m], ṡ [m/s], α [rad].
        residual: acceleration beyond the model with the declared effects [m/s²].
        deviation: its standard deviation [m/s²].
        law: acceleration that the found effects add along the measured path [m/s²].
        trusted: readings that count, bool.
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
    """The trace of what `found` adds, in one recording.

    Args:
        recording: one of the problem's.
        ball: the measured state in it, whose residual is against CAM alone.
    """
    bare = replace(problem, declared=(), model=CAM)
    plain = _acceleration(bare, recording, ball)
    declared = _acceleration(problem, recording, ball)
    everything = _acceleration(problem, recording, ball, found.terms)
    return ResidualAcceleration(
        time=recording.time,
        position=ball.position,
        velocity=ball.velocity,
        angle=recording.drive.states[:, 0],
        residual=ball.residual - (declared - plain),
        deviation=np.sqrt(ball.covariance[:, 2, 2].clip(min=0.0)),
        law=everything - declared,
        trusted=ball.trusted,
    )


def _acceleration(
    problem: Problem, recording: PreparedRecording, ball: BallEstimate, added: Terms = NOTHING
) -> FloatArray:
    """What the sensor would see of the ball's acceleration when it follows the measured path, shape (n,) [m/s²]."""
    p, table = dynamics(problem, recording, added, added.phase_of(recording.name))
    gain, lag = problem.sensor(added.effects)
    out = np.empty(len(recording.time))
    _along(ball.position / gain, ball.velocity / gain, recording.grid.steps, recording.grid.marks, table, p, out)
    # Gain and lag are linear and constant in time: they do to the acceleration what they do to the position.
    if lag > 0.0:
        out = SensorLaw(lag=lag).recorded(recording.time, out)
    return gain * out


@njit(cache=True, nogil=True)
def _along(
    position: FloatArray,
    velocity: FloatArray,
    steps: FloatArray,
    marks: NDArray[np.int64],
    table: FloatArray,
    p: FloatArray,
    out: FloatArray,
) -> None:
    """Mean s̈ of a run from every stamp to the next, put back on the path at each; what effects remember runs on."""
    w = 0.0
    for n in range(len(position) - 1):
        s, v, span = position[n], velocity[n], 0.0
        for j in range(marks[n], marks[n + 1]):
            s, v, w = advance(s, v, w, steps[j], table, 2 * j, p)
            span += steps[j]
        out[n] = (v - velocity[n]) / span
    out[-1] = out[-2]
