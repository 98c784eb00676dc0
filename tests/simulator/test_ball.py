"""What belongs to the ball: an imbalance, its rolling radius, its grip."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import State
from analytic.rig import Rig
from tests.simulator.acting import MOVED, RIG, G, K, M, rolled
from tests.simulator.motions import Fixed, Sines


def test_imbalance_pushes_towards_plus_where_the_sine_is_positive() -> None:
    """Start with K g e sin(φ₀)/r, towards +s for φ₀ = π/2 and towards −s for 3π/2."""
    offset = 1e-4
    for turned, sign in ((0.5 * math.pi, 1.0), (1.5 * math.pi, -1.0)):
        run = rolled({"ball_imbalance": {"offset": offset}}, State(0.3, 0.0), 0.01, turned_before=turned)
        # cos φ falls by (way/r)²/2 = (3.6 µm/11.8 mm)²/2 meanwhile
        assert run.velocity[-1] == pytest.approx(sign * K * G * offset / RIG.rolling_radius * 0.01, rel=1e-6)


def test_imbalance_keeps_its_energy() -> None:
    """Exchange ½ (m + J/r²) v² with m g e cos(φ + φ₀) over several turns."""
    offset = 1e-4
    run = rolled({"ball_imbalance": {"offset": offset}}, State(0.2, 0.1), 3.0, turned_before=0.7)
    total = 0.5 * MOVED * run.velocity**2 + M * G * offset * np.cos(run.rolled_angle + 0.7)
    assert np.ptp(run.rolled_angle) > 4 * math.pi
    assert np.ptp(0.5 * MOVED * run.velocity**2) > 1e-4
    # midpoint: (φ̇ dt)²/24 = 5e-8 of the potential m g e = 7e-5 J, twice
    np.testing.assert_allclose(total, total[0], rtol=0.0, atol=1e-11)


def test_a_ball_out_of_round_keeps_its_energy() -> None:
    """Exchange ½ (m + J/r²) v² with ½ T cos 2(φ + φ₀): two hills a turn."""
    torque = 5e-5
    run = rolled({"out_of_round": {"torque": torque}}, State(0.2, 0.1), 3.0, turned_before=0.7)
    total = 0.5 * MOVED * run.velocity**2 + 0.5 * torque * np.cos(2.0 * (run.rolled_angle + 0.7))
    assert np.ptp(run.rolled_angle) > 4 * math.pi
    assert np.ptp(0.5 * MOVED * run.velocity**2) > 4e-5
    # midpoint: (2 φ̇ dt)²/24 = 2e-7 of the potential T/2 = 2.5e-5 J, twice
    np.testing.assert_allclose(total, total[0], rtol=0.0, atol=1e-11)


def test_ball_of_another_rolling_radius_rolls_as_such() -> None:
    """Accelerate by g sin α/(1 + J/(m r²)) with the radius that acts, and turn by s/r."""
    radius, tilt = 0.0105, 0.03
    run = rolled({"rolling_radius": {"radius": radius}}, State(0.3, 0.0), 1.0, motion=Fixed(tilt))
    response = Rig(rolling_radius=radius).rolling_ratio
    np.testing.assert_allclose(run.velocity, response * G * math.sin(tilt) * run.time, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(run.rolled_angle, (run.position - 0.3) / radius, rtol=0.0, atol=1e-9)
    assert abs(response / K - 1) > 0.05


@pytest.mark.parametrize("tilt", [0.05, -0.05])
def test_slipping_ball_slides_down(tilt: float) -> None:
    """Slide with g (sin α − μ R/r cos α) and turn by what the friction leaves, towards either side."""
    mu = 0.01
    grip = mu * RIG.radius / RIG.rolling_radius
    run = rolled({"contact_slip": {"friction_coefficient": mu}}, State(0.3, 0.0), 0.5, motion=Fixed(tilt))
    sliding = math.copysign(G * (math.sin(abs(tilt)) - grip * math.cos(tilt)), tilt)
    turning = math.copysign(grip * M * G * math.cos(tilt) * RIG.rolling_radius / RIG.inertia, tilt)
    # constant forces, rounding of 5e3 steps
    np.testing.assert_allclose(run.velocity, sliding * run.time, atol=1e-11)
    np.testing.assert_allclose(run.spin, turning * run.time, atol=1e-9)
    assert np.all(tilt * run.slip[1:] > 0.0)


def test_grip_is_never_exceeded_and_sliding_takes_energy() -> None:
    """Slide on a swinging beam while more than μ N R/r is needed, roll in between, and account for the loss."""
    motion, mu = Sines(((0.05, 2.0, 0.0),)), 0.012
    run = rolled({"contact_slip": {"friction_coefficient": mu}}, State(0.3, 0.0), 4.0, motion=motion)
    slipping = np.abs(run.slip) > 1e-9
    assert 0.1 < slipping.mean() < 0.9
    # the tangential force turns the ball alone: J ω̇ = −F_t r
    tangential = np.abs(np.diff(run.spin)) / 1e-4 * RIG.inertia / RIG.rolling_radius
    bound = mu * run.normal_force[1:] * RIG.radius / RIG.rolling_radius
    # differences of spins of 50 rad/s over 1e-4 s round to 1e-10 rad/s², 4e-14 N
    assert np.all(tangential <= bound + 1e-12)
    inside = slipping[1:] & slipping[:-1]
    np.testing.assert_allclose(tangential[inside], bound[inside], rtol=1e-9)
    assert run.dissipated[-1] > 1e-5
    balance = run.energy - run.energy[0] - run.work + run.dissipated
    # second order, as in test_plant_accuracy: 1e-4 s against ω = 2/s
    assert np.max(np.abs(balance)) < 1e-7
