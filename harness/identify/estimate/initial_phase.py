"""How the ball lies at the start of a recording, which nobody has measured."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.filter.run import deviance_of
from harness.identify.problem.problem import PreparedRecording, Problem

_TURN = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)  # where φ₀ is looked for first


def phase_of(problem: Problem, found: Fit, recording: PreparedRecording, reading: FloatArray) -> float:
    """φ₀ of a recording [rad], at which `reading`, shape (n,) [m], is likeliest; the fitted one of a recording that
    `found` was fitted to, 0 where it does not matter."""
    if not found.hypothesis.turning:
        return 0.0
    if recording.name in found.terms.recordings:
        return found.terms.phase_of(recording.name)

    def deviance(phase: float) -> float:
        return deviance_of(problem, recording, found.terms, found.process_noise, phase=phase, reading=reading)

    near = min(_TURN, key=deviance)
    found_at = minimize_scalar(deviance, bounds=(near - _TURN[1], near + _TURN[1]), method="bounded")
    return float(found_at.x)
