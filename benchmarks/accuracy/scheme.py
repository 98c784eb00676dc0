"""What the time grid alone costs: the equation of motion itself, integrated as engines integrate rigid bodies."""

from __future__ import annotations

import numpy as np

from analytic import slots
from analytic.models import CAM, coefficients
from analytic.motion import FloatArray
from analytic.rig import Rig
from benchmarks.accuracy.motions import Drawn


def leapfrog(drawn: Drawn, rig: Rig, time_step: float) -> FloatArray:
    """s of eq. 14 at the stamps of the motion, shape (n,) [m], by the leapfrog scheme on an engine's grid.

    It is given what a drive gives to an engine: angles on the grid. The beam's rate is the mean of a step, its square
    the mean of the steps before and after, its acceleration the second difference.
    """
    p = coefficients(CAM, rig)
    steps = round(float(drawn.time[-1]) / time_step)
    angle = drawn.motion.evaluate(np.maximum(time_step * np.arange(-1, steps + 2), 0.0))  # at rest before t₀
    rate = np.diff(angle) / time_step
    square = 0.5 * (rate[1:] ** 2 + rate[:-1] ** 2)
    push = p[slots.GRAVITY] * np.sin(angle[1:-1] + p[slots.LEVEL]) - p[slots.ECCENTRIC] * np.diff(rate) / time_step
    pull = p[slots.CENTRIFUGAL] * square
    s, v = drawn.start.position, drawn.start.velocity
    v -= 0.5 * time_step * float(push[0] + pull[0] * s)
    path = np.empty(steps + 1)
    path[0] = s
    for n, (a, b) in enumerate(zip(push[:-1].tolist(), pull[:-1].tolist(), strict=True)):
        v += time_step * (a + b * s)
        s += time_step * v
        path[n + 1] = s
    return path[np.round(drawn.time / time_step).astype(np.int64)]
