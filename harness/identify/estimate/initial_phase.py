"""Estimate of the roll phase φ₀, the orientation of the ball at the start of a recording."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.filter.run import deviance_of
from harness.identify.problem.problem import PreparedRecording, Problem

_TURN = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)  # grid of the first search [rad]


def phase_of(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray) -> float:
    """φ₀ of a recording [rad]: as fitted, or of maximum likelihood for `reading`, shape (n,) [m], if it was not.

    0 if no law depends on the rolled angle.
    """
    if not found.hypothesis.turning:
        return 0.0
    if recording.name in found.terms.recordings:
        return found.terms.phase_of(recording.name)

    def deviance(phase: float) -> float:
        return deviance_of(problem, recording, found.terms, found.process_noise, phase=phase, reading=reading)

    start = min(_TURN, key=deviance)
    optimum = minimize_scalar(deviance, bounds=(start - _TURN[1], start + _TURN[1]), method="bounded")
    return float(optimum.x)
