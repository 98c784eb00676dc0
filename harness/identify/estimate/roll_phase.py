"""How the ball lies at the start of a recording, which nobody has measured."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit
from harness.identify.filter.ekf import negative_two_log_likelihood
from harness.identify.problem.problem import Problem, Record

_TURN = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)  # where φ₀ is looked for first


def phase_of(problem: Problem, found: Fit, record: Record, reading: FloatArray) -> float:
    """φ₀ of a recording [rad], at which `reading`, shape (n,) [m], is likeliest; the fitted one of a recording that
    `found` was fitted to, 0 where it does not matter."""
    if not found.hypothesis.turning:
        return 0.0
    names = [one.name for one in problem.records]
    if record.name in names:
        return float(found.best.phases[names.index(record.name)])
    use = np.isfinite(reading)
    use[np.argmax(use)] = False

    def deviance(phase: float) -> float:
        out = problem.filtered(record, found.best.effects, phase, found.density, found.best.shape, reading)
        return negative_two_log_likelihood(out.innovation[use], out.innovation_variance[use])

    near = min(_TURN, key=deviance)
    found_at = minimize_scalar(deviance, bounds=(near - _TURN[1], near + _TURN[1]), method="bounded")
    return float(found_at.x)
