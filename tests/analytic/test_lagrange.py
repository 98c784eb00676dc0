"""CAM (eq. 14, 19) follows from Lagrange's equation with a prescribed beam angle, and the normal force with it."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from analytic.law import acceleration
from analytic.models import CAM, coefficients
from analytic.rig import Rig
from tests.analytic.symbols import J, alpha, alpha_0, angular, g, h, kernel_acceleration, m, r, rate, s, v

t = sp.symbols("t", real=True)
a = sp.symbols("s̈", real=True)
S, LIFT, ANGLE = (sp.Function(name)(t) for name in ("s", "n", "α"))


def along(angle: sp.Expr) -> sp.Matrix:
    """e_s in the world's (x, z): α > 0 lowers the +s end."""
    return sp.Matrix([sp.cos(angle), -sp.sin(angle)])


def normal(angle: sp.Expr) -> sp.Matrix:
    """e_n in the world's (x, z)."""
    return sp.Matrix([sp.sin(angle), sp.cos(angle)])


def instantaneous(expression: sp.Expr) -> sp.Expr:
    """The expression with the functions of time replaced by their values at an instant; the ball is in its groove."""
    values = [(S.diff(t, 2), a), (S.diff(t), v), (S, s), (ANGLE.diff(t, 2), angular), (ANGLE.diff(t), rate)]
    return in_sin_alpha(expression.subs(LIFT, 0).doit().subs(values).subs(ANGLE, alpha))


def in_sin_alpha(expression: sp.Expr) -> sp.Expr:
    """The expression expanded in sin α and cos α of first degree, so that equal ones look equal."""
    return sp.expand(sp.expand(sp.expand_trig(expression)).subs(sp.cos(alpha) ** 2, 1 - sp.sin(alpha) ** 2))


class Lagrange:
    """Equations of a ball that rolls at s e_s + (h + r + n) e_n, where n would lift it; gravity leans by α₀."""

    def __init__(self) -> None:
        centre = S * along(ANGLE) + (h + r + LIFT) * normal(ANGLE)
        spin = S.diff(t) / r + ANGLE.diff(t)
        kinetic = m * centre.diff(t).dot(centre.diff(t)) / 2 + J * spin**2 / 2
        up = sp.Matrix([-sp.sin(alpha_0), sp.cos(alpha_0)])
        self._difference = kinetic - m * g * up.dot(centre)
        self.motion_along = self._force_on(S)
        self.normal_force = self._force_on(LIFT)
        (self.acceleration,) = sp.solve(self.motion_along, a)

    def _force_on(self, coordinate: sp.Expr) -> sp.Expr:
        """d/dt ∂L/∂q̇ − ∂L/∂q, the generalised force that acts on the coordinate q; 0 along the beam."""
        momentum = self._difference.diff(coordinate.diff(t))
        return instantaneous(momentum.diff(t) - self._difference.diff(coordinate))


@pytest.fixture(scope="module")
def lagrange() -> Lagrange:
    """The equations, derived once."""
    return Lagrange()


def test_rolling_adds_the_beam_rate_to_the_spin() -> None:
    """Find φ̇ = ṡ/r + α̇ from equal velocities of ball and edge where they touch."""
    spin = sp.symbols("φ̇")

    def turned(vector: sp.Matrix) -> sp.Matrix:
        return sp.Matrix([vector[1], -vector[0]])  # ŷ × (x, z) = (z, −x)

    contact = S * along(ANGLE) + h * normal(ANGLE)
    centre_velocity = (contact + r * normal(ANGLE)).diff(t)
    slip = centre_velocity + spin * turned(-r * normal(ANGLE)) - ANGLE.diff(t) * turned(contact)
    (rolling,) = sp.solve(instantaneous(slip.dot(along(ANGLE))), spin)
    assert sp.expand(rolling - (v / r + rate)) == 0


@pytest.mark.parametrize(
    ("term", "printed"),
    [
        (a, J / r**2 + m),
        (angular, m * (h + r) + J / r),
        (rate**2, -m * s),
        (sp.sin(alpha), -m * g * sp.cos(alpha_0)),
        (sp.cos(alpha), -m * g * sp.sin(alpha_0)),
    ],
    ids=["ball acceleration", "beam acceleration", "beam rate squared", "sine", "cosine"],
)
def test_cam_has_the_printed_terms(lagrange: Lagrange, term: sp.Expr, printed: sp.Expr) -> None:
    """Obtain each term of eq. 14 with the paper's factor; sin(α + α₀) of eq. 19 is split into sin α and cos α."""
    assert sp.expand(lagrange.motion_along.coeff(term) - printed) == 0


def test_cam_has_no_other_terms(lagrange: Lagrange) -> None:
    """Leave nothing over when eq. 14 with the level error of eq. 19 is subtracted."""
    eq_14 = (J / r**2 + m) * a + (m * (h + r) + J / r) * angular - m * s * rate**2 - m * g * sp.sin(alpha + alpha_0)
    assert in_sin_alpha(lagrange.motion_along - eq_14) == 0


def test_kernel_computes_the_derived_acceleration(lagrange: Lagrange) -> None:
    """Agree with the kernel's code, executed on symbols, for every rig."""
    assert sp.simplify(lagrange.acceleration - in_sin_alpha(kernel_acceleration(CAM))) == 0


def test_compiled_kernel_computes_the_derived_acceleration(lagrange: Lagrange) -> None:
    """Agree with the compiled kernel in numbers, far beyond the angles and speeds of the rig."""
    rig = Rig(level_angle=0.01)
    values = {m: rig.mass, J: rig.inertia, r: rig.rolling_radius, h: rig.eccentricity, g: rig.gravity, alpha_0: 0.01}
    expected = sp.lambdify((s, v, alpha, rate, angular), lagrange.acceleration.subs(values))
    states = np.random.default_rng(14).uniform(-1.0, 1.0, (200, 5)) * [2.0, 3.0, 1.5, 5.0, 50.0]
    for state in states:
        # some ten operations on terms of at most g, s α̇² = 50 and L α̈ = 3 m/s²: 10 · 60 · 1.1e-16
        assert acceleration(*state, coefficients(CAM, rig)) == pytest.approx(expected(*state), rel=0.0, abs=7e-14)


def test_normal_force_is_the_one_that_keeps_the_ball_on_the_edges(lagrange: Lagrange) -> None:
    """Obtain N = m (g cos(α + α₀) − 2 ṡ α̇ − s α̈ − (h + r) α̇²) as the force on the coordinate that lifts the ball."""
    expected = m * (g * sp.cos(alpha + alpha_0) - 2 * v * rate - s * angular - (h + r) * rate**2)
    assert in_sin_alpha(lagrange.normal_force - expected) == 0


def test_normal_force_follows_from_newton_too() -> None:
    """Obtain the same N and the acceleration along the beam from the centre's acceleration in the world frame."""
    centre = S * along(ANGLE) + (h + r) * normal(ANGLE)
    lift, push = (instantaneous(centre.diff(t, 2).dot(axis(ANGLE))) for axis in (normal, along))
    assert sp.expand(lift - (-2 * v * rate - s * angular - (h + r) * rate**2)) == 0
    assert sp.expand(push - (a + (h + r) * angular - s * rate**2)) == 0
