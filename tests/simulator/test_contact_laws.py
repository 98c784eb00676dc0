"""The contact obeys its laws: holding, rolling out, sliding, flying, and the exact solution of both frictions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.motion import State
from analytic.rig import Rig
from harness.simulator import Plant, simulate
from harness.simulator.contact import Beam, friction, step
from harness.simulator.plant import compiled
from tests.simulator.motions import Fixed, Sines, parabola

RIG = Rig()
C = 0.004


@pytest.mark.parametrize(("tilt", "level"), [(0.999, 0.0), (-0.999, 0.0), (0.0, 0.999), (0.5, 0.499)])
def test_ball_stays_on_a_slope_below_the_friction_angle(tilt: float, level: float) -> None:
    """Hold the ball at rest, to the bit and for 10 s, below atan(c), whether the beam or its level is tilted."""
    slope = math.atan(C)
    plant = Plant(rig=Rig(level_angle=level * slope), rolling_resistance=C)
    run = simulate(plant, Fixed(tilt * slope), State(0.36, 0.0), 10.0)
    assert np.all(run.velocity == 0.0)
    assert np.all(run.position == 0.36)


def test_ball_rolls_on_a_slope_above_the_friction_angle() -> None:
    """Let the ball go just above atan(c), with the acceleration of the small excess."""
    tilt = 1.001 * math.atan(C)
    run = simulate(Plant(rolling_resistance=C), Fixed(tilt), State(0.36, 0.0), 10.0)
    expected = 0.5 * RIG.rolling_ratio * RIG.gravity * (math.sin(tilt) - C * math.cos(tilt)) * run.time**2
    # constant forces are integrated exactly; rounding: 1e5 steps of 1e-16 m in x and z, times 4 operations
    np.testing.assert_allclose(run.position - 0.36, expected, rtol=0.0, atol=4e-11)


def test_ball_at_rest_is_carried_by_a_moving_beam() -> None:
    """Keep s and ṡ exactly while the beam moves within the friction angle."""
    # |α| = 0.7 c, and (h + r + J/(m r)) α̈ = 0.053 · 0.7 c · 1.5² = 0.08 c m/s² is little beside c g
    motion = Sines(((0.7 * C, 1.5, 0.0),))
    run = simulate(Plant(rolling_resistance=C), motion, State(0.4, 0.0), 10.0)
    assert np.all(run.velocity == 0.0)
    assert np.all(run.position == 0.4)
    # the ball turns with the beam: no rolled angle beyond the trapezoid's error, (dt²/12) Σ jumps of α̈ < 1e-12 rad,
    # and 1e5 roundings of 1e-18
    np.testing.assert_allclose(run.rolled_angle, 0.0, atol=1e-11)


def test_ball_rolls_out_and_stays() -> None:
    """Stop the rolling ball after v₀²/(2 a), a = c g/(1 + J/(m r²)), and keep it there."""
    plant, v = Plant(rolling_resistance=C), 0.05
    braking = C * RIG.gravity * RIG.rolling_ratio
    run = simulate(plant, Fixed(), State(0.3, v), 3.0)
    assert np.all(run.velocity[run.time > v / braking + plant.step] == 0.0)
    assert np.all(run.velocity[run.time < v / braking - plant.step] > 0.0)
    # the last step stops the ball up to one step late: half a step's loss of velocity over one step
    assert run.position[-1] == pytest.approx(0.3 + v * v / (2 * braking), abs=0.5 * braking * plant.step**2)


def test_groove_carries_more_friction_than_a_plane() -> None:
    """Slide down a steep beam with μ R/r, the friction of two leaning contacts, and the spin it gives."""
    tilt, mu = 0.3, 0.05
    grip = mu * RIG.radius / RIG.rolling_radius
    assert math.tan(tilt) > grip * (1 + 1 / RIG.inertia_ratio)  # steeper than rolling can follow
    run = simulate(Plant(friction=mu), Fixed(tilt), State(0.3, 0.0), 0.5)
    sliding = RIG.gravity * (math.sin(tilt) - grip * math.cos(tilt))
    turning = grip * RIG.mass * RIG.gravity * math.cos(tilt) * RIG.rolling_radius / RIG.inertia
    # constant forces: exact but for 5e3 steps' rounding of 1e-16
    np.testing.assert_allclose(run.velocity, sliding * run.time, atol=1e-11)
    np.testing.assert_allclose(run.spin, turning * run.time, atol=1e-9)
    assert np.all(run.slip[1:] > 0.0)


def test_ball_rolls_without_slip_below_the_grip() -> None:
    """Keep the contact line at rest on the beam while friction suffices."""
    run = simulate(Plant(friction=0.05), Sines(), State(0.36, 0.1), 5.0)
    # one rounding of velocities of about 1 m/s
    assert np.max(np.abs(run.slip)) < 1e-15


def test_ball_flies_when_the_beam_drops_away_and_lands() -> None:
    """Let the ball fall freely while the beam drops faster than g, and land without bouncing."""
    # the plane under s = 0.4 m drops with 24 m/s²; within 0.03 s it falls 11 mm, the ball 4.4 mm
    run = simulate(Plant(), parabola(60.0, 0.03), State(0.4, 0.0), 0.2)
    up = RIG.eccentricity + RIG.rolling_radius + run.gap
    x = run.position * np.cos(run.angle) + up * np.sin(run.angle)
    z = up * np.cos(run.angle) - run.position * np.sin(run.angle)
    # the ball is released from rest; constant acceleration is integrated exactly
    flight = run.time <= 0.03
    np.testing.assert_allclose(x[flight], 0.4, atol=1e-14)
    np.testing.assert_allclose(z[flight], z[0] - 0.5 * RIG.gravity * run.time[flight] ** 2, atol=1e-14)
    assert run.gap[flight][-1] > 5e-3
    landed = np.flatnonzero(run.gap > 1e-15)[-1] + 1
    assert run.time[landed] < 0.06  # 11 mm of free fall take 47 ms
    assert np.all(run.normal_force[landed + 1 :] > 0.0)
    assert run.dissipated[-1] > 0.0


def test_landing_takes_the_energy_that_is_missing() -> None:
    """Account for the energy an inelastic landing on a standing beam takes."""
    run = simulate(Plant(), parabola(60.0, 0.03), State(0.4, 0.0), 0.2)
    # In the step of the impact the height is put back by up to v dt = 0.4 m/s · 1e-4 s: m g · 40 µm = 28 µJ.
    # At the start of the flight nothing is lost.
    assert run.energy[-1] - run.energy[0] - run.work[-1] + run.dissipated[-1] == pytest.approx(0.0, abs=2.8e-5)
    assert run.dissipated[-1] > 1e-3


@settings(max_examples=300, deadline=None)
@given(
    slip=st.floats(-1.0, 1.0),
    turning=st.floats(-50.0, 50.0),
    grip=st.floats(0.0, 0.05),
    plus=st.floats(0.0, 5e-4),
    minus=st.floats(0.0, 5e-4),
)
def test_friction_solves_the_set_valued_laws(
    slip: float, turning: float, grip: float, plus: float, minus: float
) -> None:
    """Satisfy both friction laws at once: within the bound only at rest, at the bound only against the motion."""
    m, J, r = RIG.mass, RIG.inertia, RIG.rolling_radius
    tangential, moment, at_rest = friction(slip, turning, 1 / m, r, 1 / J, grip, plus, minus)
    after_turning = turning + (moment - r * tangential) / J
    after_slip = slip + tangential / m - r * (moment - r * tangential) / J
    # impulses up to 0.05 N s and 1e-3 N m s act through r/J = 2.4e3: rounding of 100 m/s and 1e4 rad/s, 1e-16 each
    still_slip, still_turning = abs(after_slip) < 1e-12, abs(after_turning) < 1e-10
    assert abs(tangential) <= grip
    assert -plus <= moment <= minus
    assert still_slip or tangential == -math.copysign(grip, after_slip)
    assert still_turning or moment == (-plus if after_turning > 0.0 else minus)
    assert not at_rest or (still_slip and still_turning)


def test_step_ends_on_the_moving_plane() -> None:
    """End a step with the centre moving exactly as the plane below it, v · n = −α̇ s, and at its height."""
    plant, angle, rate, turning, dt = Plant(friction=0.35), 0.05, 0.5, 6.0, 1e-3
    next_rate = rate + turning * dt
    next_angle = angle + 0.5 * dt * (rate + next_rate)
    before, after = Beam(angle, rate), Beam(next_angle, next_rate)
    ball = plant.ball(State(0.5, 0.3), angle, rate)
    ball, impulse = step(ball, before, after, 0.0, dt, plant.constants, plant.laws, compiled(None))
    sin, cos = math.sin(next_angle), math.cos(next_angle)
    assert impulse > 0.0
    # a pass leaves (α̇ dt)² = 2.5e-7 of an error in the impulses: three leave rounding of 0.3 m/s
    assert ball.velocity_x * sin + ball.velocity_z * cos == pytest.approx(-next_rate * ball.along, abs=2e-16)
    assert ball.x * sin + ball.z * cos == pytest.approx(RIG.eccentricity + RIG.rolling_radius, abs=1e-16)
