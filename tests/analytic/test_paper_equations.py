"""Every model is the paper's equation, typed here anew: in symbols, and integrated by scipy without shared code."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from analytic.models import MODELS
from analytic.motion import State, beam_states
from analytic.rig import Rig
from tests.analytic.symbols import J, R, alpha, alpha_0, angular, f_b, g, h, kernel_acceleration, m, r, rate, s, v, v_t
from tests.motions import Sines
from tests.reference import reference

a = sp.symbols("s̈", real=True)
weight = m * g * sp.sin(alpha + alpha_0)
normal_force = m * g * sp.cos(alpha)
eq_16 = (J / r**2 + m) * a - weight  # without F_f

# What the paper sets to zero, with gravity in the sense of eq. 14 (α > 0 drives the ball towards +s).
EQUATIONS = {
    "cum": (J / R**2 + m) * a - m * s * rate**2 - weight,
    "cum_linear": (J / R**2 + m) * a - m * g * (alpha + alpha_0),
    "cam": (J / r**2 + m) * a + (m * (h + r) + J / r) * angular - m * s * rate**2 - weight,
    "friction_printed": eq_16 + f_b * sp.tanh(v / v_t) * normal_force * v,
    "friction_printed_dissipative": eq_16 + f_b * sp.Abs(sp.tanh(v / v_t)) * normal_force * v,
    "friction_coulomb": eq_16 + f_b * normal_force * sp.tanh(v / v_t),
    "friction_viscous": eq_16 + f_b * v,
}


def test_every_model_has_an_equation() -> None:
    """Leave no member of the family out."""
    assert set(EQUATIONS) == set(MODELS)


@pytest.mark.parametrize("name", MODELS)
def test_kernel_is_the_printed_equation(name: str) -> None:
    """Satisfy the paper's equation identically, for every rig and state."""
    assert sp.simplify(EQUATIONS[name].subs(a, kernel_acceleration(MODELS[name]))) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_reference_solves_the_printed_equation(name: str) -> None:
    """Follow the paper's equation, integrated on its own, over 10 s of a moving beam."""
    rig, motion, start, time = Rig(level_angle=0.002), Sines(), State(0.36, 0.05), np.linspace(0.0, 10.0, 401)
    values = {m: 0.071, J: 4.948e-6, R: 0.0132, r: 0.0118, h: 0.035, g: 9.81, v_t: 0.008, f_b: 0.0362, alpha_0: 0.002}
    (solved,) = sp.solve(EQUATIONS[name], a)
    slope = sp.lambdify((s, v, alpha, rate, angular), solved.subs(values), "math")

    def derivative(now: float, state: np.ndarray) -> tuple[float, float]:
        return state[1], slope(*state, *beam_states(motion, np.array([now]))[0])

    solution = solve_ivp(derivative, (0.0, 10.0), (0.36, 0.05), "DOP853", time, rtol=1e-12, atol=1e-12, max_step=0.02)
    found = reference(MODELS[name], rig, motion, start, time)
    # the solvers differ in their steps only, so each is off by no more than looser tolerances move it; 1e-13 m is
    # the rounding of 500 steps on a position of up to 2 m
    loose = reference(MODELS[name], rig, motion, start, time, rtol=1e-10)
    tolerance = 1e-13 + np.max(np.abs(found.position - loose.position))
    assert tolerance < 1e-7
    np.testing.assert_allclose(found.position, solution.y[0], rtol=0.0, atol=tolerance)
    assert found.source == f"{name}_reference"
