"""Four defects of the printed equations: each is shown on the equation in print, then what the models do instead."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from analytic.kernel import simulate
from analytic.law import acceleration
from analytic.models import CUM, FRICTION, MODELS, Reading, coefficients
from analytic.motion import State
from analytic.rig import Rig
from tests.analytic.dimensions import FORCE, LENGTH, MASS, NUMBER, TIME, VELOCITY, Dimension, dimension_of
from tests.analytic.symbols import J, R, alpha, alpha_0, angular, f_b, g, h, kernel_acceleration, m, r, rate, s, v, v_t
from tests.motions import Fixed

a = sp.symbols("s̈", real=True)
PAPER = {m: 0.071, J: 4.948e-6, R: 0.0132, r: 0.0118, h: 0.035, g: 9.81}
RIG = Rig()
LEVEL = Fixed(0.0)
PRINTED_UNIT = "N s/m"

eq_3 = (J / R**2 + m) * a - m * s * rate**2 + m * g * sp.sin(alpha)
eq_14 = (J / r**2 + m) * a + (m * (h + r) + J / r) * angular - m * s * rate**2 - m * g * sp.sin(alpha)
eq_15 = f_b * sp.tanh(v / v_t) * m * g * sp.cos(alpha) * v


def solved(equation: sp.Expr) -> sp.Expr:
    """s̈ of an equation of motion."""
    return sp.solve(equation, a)[0]


def mirrored(expression: sp.Expr) -> sp.Expr:
    """The expression with the opposite sense of the beam angle."""
    return expression.subs({alpha: -alpha, rate: -rate, angular: -angular}, simultaneous=True)


# Sign


def test_printed_equations_accelerate_the_ball_in_opposite_senses() -> None:
    """Show that on a fixed slope eq. 3 as printed drives the ball up where eq. 14 drives it down."""
    on_slope = {**PAPER, s: 0.36, rate: 0.0, angular: 0.0, alpha: math.radians(3.0)}
    cum, cam = (float(solved(equation).subs(on_slope)) for equation in (eq_3, eq_14))
    assert cum < 0.0 < cam
    # they differ by the sign and, in the inertia, by the radius
    assert cum / cam == pytest.approx(-(1.0 + RIG.inertia_ratio) / (1.0 + RIG.inertia / (RIG.mass * RIG.radius**2)))


def test_no_single_sense_of_the_angle_suits_both_printed_equations() -> None:
    """Show that α → −α turns eq. 3 into the CUM used here, and reverses all of eq. 14 but s α̇²."""
    assert sp.simplify(mirrored(solved(eq_3)) - kernel_acceleration(CUM).subs(alpha_0, 0)) == 0
    kept = (mirrored(solved(eq_14)) + solved(eq_14)) / 2
    assert sp.simplify(kept - m * s * rate**2 / (J / r**2 + m)) == 0


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.name)
def test_positive_angle_drives_every_model_towards_plus_s(model) -> None:
    """Start a ball at rest towards the end that a positive angle lowers."""
    assert acceleration(0.36, 0.0, math.radians(3.0), 0.0, 0.0, coefficients(model, RIG)) > 0.0
    assert acceleration(0.36, 0.0, math.radians(-3.0), 0.0, 0.0, coefficients(model, RIG)) < 0.0


# Radius


def test_radii_of_eq_16_and_its_solution_differ_by_seven_per_cent() -> None:
    """Show 7 % between the inertia J/r² + m of eq. 16 and J/R² + m of eq. 17, with the paper's values."""
    ratio = float(((J / r**2 + m) / (J / R**2 + m)).subs(PAPER))
    assert ratio == pytest.approx(1.0718, abs=5e-5)


@pytest.mark.parametrize("model", FRICTION.values(), ids=lambda model: model.name)
def test_either_radius_can_be_chosen_by_name(model) -> None:
    """Take eq. 16 unless told otherwise, and eq. 17's inertia on demand, which changes nothing but s̈'s factor."""
    as_in_17 = model.variant(f"{model.name}_ball_radius", inertia_radius="R")
    assert model.inertia_radius == "r"
    assert as_in_17.name != model.name
    difference = (J / r**2 + m) * kernel_acceleration(model) - (J / R**2 + m) * kernel_acceleration(as_in_17)
    assert sp.simplify(difference) == 0


# Law


def test_printed_friction_feeds_energy_into_a_ball_that_rolls_back() -> None:
    """Show that eq. 15 is even in ṡ, so that it takes power at ṡ > 0 and gives it at ṡ < 0."""
    assert sp.simplify(eq_15.subs(v, -v) - eq_15) == 0
    at = {**PAPER, f_b: 0.0362, v_t: 0.008, alpha: 0.0}
    forward, backward = (float((-eq_15 * v).subs({**at, v: speed})) for speed in (0.1, -0.1))  # into the ball [W]
    assert forward < 0.0 < backward


@pytest.mark.parametrize("model", FRICTION.values(), ids=lambda model: model.name)
@given(speed=st.floats(-2.0, 2.0), angle=st.floats(-1.5, 1.5))
def test_readings_say_rightly_whether_they_dissipate(model, speed: float, angle: float) -> None:
    """Take energy from the ball at every speed and angle, except for the printed reading, which gives it at ṡ < 0."""
    with_friction, without = (
        acceleration(0.36, speed, angle, 0.0, 0.0, coefficients(model, rig))
        for rig in (RIG, RIG.with_(friction_coefficient=0.0))
    )
    power = (with_friction - without) * speed
    # a difference of two accelerations of at most g: rounding 2e-15 m/s², times the speed
    assert (power <= 4e-15) if model.reading.dissipates or speed >= 0.0 else (power >= -4e-15)


@pytest.mark.parametrize("start", [0.1, -0.1], ids=["forward", "backward"])
@pytest.mark.parametrize(
    ("reading", "speed_after"),
    [
        (Reading.PRINTED, lambda v0, t, rate: v0 * np.exp(-math.copysign(rate, v0) * t)),
        (Reading.VISCOUS, lambda v0, t, rate: v0 * np.exp(-rate * t)),
        (Reading.COULOMB, lambda v0, t, rate: 0.008 * np.arcsinh(np.sinh(v0 / 0.008) * np.exp(-rate / 0.008 * t))),
    ],
    ids=["printed", "viscous", "coulomb"],
)
def test_ball_on_a_level_beam_follows_the_closed_solution(reading, speed_after, start: float) -> None:
    """Slow down on a level beam by the law's closed solution; in print, speed up without bound when rolling back."""
    time = np.linspace(0.0, 0.4, 41)
    gain = RIG.rolling_ratio * 0.0362 * (1.0 / RIG.mass if reading is Reading.VISCOUS else RIG.gravity)
    (run,) = simulate([FRICTION[reading]], RIG, LEVEL, State(0.36, start), time)
    # Runge–Kutta's error on the fastest rate λ = gain/v_t = 30 1/s: (λ dt)⁴/120 of 0.1 m/s over λ t = 12 is 3e-7 at
    # the default step; in print 1 − tanh(|ṡ|/v_t) < 1e-8 while |ṡ| > 0.09 m/s, and times gain · t that is less
    np.testing.assert_allclose(run.velocity, speed_after(start, time, gain), rtol=0.0, atol=3e-7)
    assert (abs(run.velocity[-1]) < abs(start)) == (reading.dissipates or start > 0.0)


def test_mended_print_slows_the_ball_both_ways() -> None:
    """Lose the same speed forward and backward with |tanh| in place of tanh."""
    model, time = FRICTION[Reading.PRINTED_DISSIPATIVE], np.linspace(0.0, 5.0, 51)
    forward, backward = (simulate([model], RIG, LEVEL, State(0.36, v0), time)[0].velocity for v0 in (0.1, -0.1))
    np.testing.assert_array_equal(forward, -backward)
    assert np.all(np.diff(forward) < 0.0)


def test_coulomb_reading_creeps_where_a_ball_would_stick() -> None:
    """Roll on at v_t artanh(tan α / f_b) on a slope below f_b, because tanh lets no force act at rest."""
    tilt = 0.02
    (run,) = simulate([FRICTION[Reading.COULOMB]], RIG, Fixed(tilt), State(0.36, 0.0), np.linspace(0.0, 2.0, 21))
    # 2 s are 40 time constants v_t/(k f_b g sech²) = 0.05 s: e⁻⁴⁰; 800 steps round speeds of 5 mm/s by 1e-18 each
    assert run.velocity[-1] == pytest.approx(0.008 * math.atanh(math.tan(tilt) / 0.0362), rel=1e-13)


# Unit


def friction_force(reading: Reading, f_b: Dimension) -> Dimension:
    """Dimension of F_f in a reading; tanh and cos are numbers."""
    weight = MASS * (LENGTH / TIME / TIME)
    return {
        Reading.PRINTED: f_b * NUMBER * weight * NUMBER * VELOCITY,
        Reading.PRINTED_DISSIPATIVE: f_b * NUMBER * weight * NUMBER * VELOCITY,
        Reading.COULOMB: f_b * weight * NUMBER * NUMBER,
        Reading.VISCOUS: f_b * VELOCITY,
    }[reading]


def test_printed_product_with_the_printed_unit_is_newton_squared() -> None:
    """Show that eq. 15 with f_b in N s/m is no force but a force times a force."""
    assert friction_force(Reading.PRINTED, dimension_of(PRINTED_UNIT)) == FORCE * FORCE


@pytest.mark.parametrize("reading", FRICTION)
def test_each_reading_is_a_force_with_its_own_unit(reading: Reading) -> None:
    """State for each reading the unit of f_b that makes F_f a force, and whether that is the printed one."""
    assert friction_force(reading, dimension_of(reading.unit)) == FORCE
    assert (friction_force(reading, dimension_of(PRINTED_UNIT)) == FORCE) == reading.consistent_with_print
    assert reading.consistent_with_print == (reading is Reading.VISCOUS)
