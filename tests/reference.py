"""An adaptive reference solution, against which kernel and engines are tested."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from analytic.law import acceleration
from analytic.models import Model, coefficients
from analytic.motion import BeamMotion, FloatArray, State, Trajectory, beam_states
from analytic.rig import Rig


def reference(
    model: Model, rig: Rig, motion: BeamMotion, start: State, time: FloatArray, *, rtol: float = 1e-12
) -> Trajectory:
    """Solve `model` with DOP853 (Hairer, Nørsett, Wanner 1993) at relative tolerance `rtol`.

    Args:
        time: stamps at which the ball is wanted, shape (n,) [s]; the run begins at the first.

    Raises:
        RuntimeError: the solver failed; with its own message.
    """
    p = coefficients(model, rig)

    def slope(t: float, y: FloatArray) -> tuple[float, float]:
        angle, rate, angular = beam_states(motion, np.array([t]))[0]
        return y[1], acceleration(y[0], y[1], angle, rate, angular, p)

    solution = solve_ivp(
        slope,
        (float(time[0]), float(time[-1])),
        (start.position, start.velocity),
        method="DOP853",
        t_eval=np.asarray(time, float),
        rtol=rtol,
        atol=rtol,
        max_step=0.05,  # longer steps could miss a short move of the beam
    )
    if not solution.success:
        raise RuntimeError(f"reference solution of {model.name}: {solution.message}")
    return Trajectory(f"{model.name}_reference", solution.t, solution.y[0], solution.y[1])
