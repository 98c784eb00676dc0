"""What tilts the track, and forces that depend on position, angle and time, against closed solutions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import State
from tests.simulator.acting import MOVED, G, K, M, rolled
from tests.simulator.motions import Fixed


@pytest.mark.parametrize("angle", [0.004, -0.004])
def test_level_error_tilts_gravity(angle: float) -> None:
    """Roll towards +s on a level beam whose gravity sees a positive angle, with K g sin(angle)."""
    run = rolled({"level_error": {"angle": angle}}, State(0.3, 0.0), 2.0)
    # constant forces are integrated exactly; rounding as in test_contact_laws
    np.testing.assert_allclose(run.position, 0.3 + 0.5 * K * G * math.sin(angle) * run.time**2, atol=1e-11)


def test_ball_swings_in_a_bowl() -> None:
    """Swing about the centre with ω = √(K g κ) where κ > 0."""
    curvature, centre, swing = 0.06, 0.33, 0.02
    run = rolled({"track_curvature": {"curvature": curvature, "centre": centre}}, State(centre + swing, 0.0), 8.0)
    expected = centre + swing * np.cos(math.sqrt(K * G * curvature) * run.time)
    # the sine of a slope of up to 1.2e-3 lowers the frequency by (1.2e-3)²/16: after 5.0 rad 4.5e-7 of the swing
    np.testing.assert_allclose(run.position, expected, rtol=0.0, atol=4.6e-7 * swing)


def test_ball_runs_off_a_hill() -> None:
    """Run away from the centre as cosh(√(K g |κ|) t) where κ < 0."""
    run = rolled({"track_curvature": {"curvature": -0.06, "centre": 0.33}}, State(0.331, 0.0), 4.0)
    expected = 0.33 + 1e-3 * np.cosh(math.sqrt(K * G * 0.06) * run.time)
    assert expected[-1] - 0.33 > 4e-3
    # sin of a slope of 4e-4 at most: 3e-8 of the force, and of the way times √(K g |κ|) t = 2.5
    np.testing.assert_allclose(run.position, expected, rtol=0.0, atol=8e-8 * 6e-3)


@pytest.mark.parametrize("speed", [0.2, -0.2])
@pytest.mark.parametrize("height", [2e-4, -2e-4])
def test_bump_slows_the_ball_on_its_top(height: float, speed: float) -> None:
    """Trade m g H against ½ (m + J/r²) v² on top of the bump, and give it back behind it."""
    run = rolled({"track_bump": {"height": height, "centre": 0.3, "width": 0.02}}, State(0.3 - 0.6 * speed, speed), 1.3)
    top = np.interp(0.0, math.copysign(1.0, speed) * (run.position - 0.3), run.velocity)
    # the law takes the sine of a slope of at most 6e-3: its integral is H to (6e-3)²/6; 6 w away, 1e-8 of H is left
    assert top**2 == pytest.approx(speed**2 - 2 * K * G * height, rel=1e-5)
    assert run.velocity[-1] == pytest.approx(speed, rel=1e-6)


def test_compliant_beam_tilts_with_the_load() -> None:
    """Drive the ball off as s₀ cosh(√(K g c m g) t): the tilt is c m g s."""
    compliance = 0.1
    run = rolled({"beam_compliance": {"compliance": compliance}}, State(0.2, 0.0), 1.0)
    rate = math.sqrt(K * G * compliance * M * G)
    # sin of 0.02 rad: (0.02)²/6 of the force at most, K g 0.02 t²/2 · 7e-5 = 6 µm
    np.testing.assert_allclose(run.position, 0.2 * np.cosh(rate * run.time), rtol=0.0, atol=6e-6)


def test_gust_pushes_between_its_instants() -> None:
    """Give the ball F (t₂ − t₁)/(m + J/r²) and nothing before or after."""
    run = rolled({"gust": {"force": -0.01, "start": 0.5, "end": 1.5}}, State(0.3, 0.0), 2.0)
    expected = -0.01 / MOVED * np.clip(run.time - 0.5, 0.0, 1.0)
    # an instant is met to a step: F dt/(m + J/r²)
    np.testing.assert_allclose(run.velocity, expected, rtol=0.0, atol=0.01 / MOVED * 1e-4)


def test_level_drift_tilts_the_track_with_time() -> None:
    """Accelerate by K g sin(rate · t)."""
    run = rolled({"level_drift": {"rate": 0.004}}, State(0.3, 0.0), 3.0)
    # the sine of 0.012 rad is short of it by 0.012²/6 of K g 0.012 · 1.5 m/s, and K s rate² t is 3e-5 m/s
    np.testing.assert_allclose(run.velocity, K * G * 0.004 * run.time**2 / 2, rtol=0.0, atol=4e-5)


def test_settling_force_grows_to_its_end() -> None:
    """Accelerate by F (1 − exp(−t/τ))/(m + J/r²)."""
    run = rolled({"settling_force": {"force": 0.001, "time_constant": 0.5}}, State(0.3, 0.0), 3.0)
    expected = 0.001 / MOVED * (run.time + 0.5 * np.expm1(-run.time / 0.5))
    # midpoints of 0.1 ms: (dt/τ)²/24 of it
    np.testing.assert_allclose(run.velocity, expected, rtol=0.0, atol=1e-9)


def test_force_hill_gives_the_energy_under_it() -> None:
    """Give ½ F (s₂ − s₁) to a ball that crosses it, and push nowhere else."""
    run = rolled({"force_hill": {"force": 0.01, "start": 0.30, "end": 0.36}}, State(0.25, 0.3), 0.6)
    assert run.position[-1] > 0.37
    # the midpoint rule over 2,000 steps on a bell that ends with zero slope: 1e-6
    assert run.velocity[-1] ** 2 - 0.09 == pytest.approx(2 * 0.5 * 0.01 * 0.06 / MOVED, rel=1e-5)
    outside = (run.position < 0.2999) | (run.position > 0.3601)
    assert np.all(np.diff(run.velocity)[outside[1:] & outside[:-1]] == pytest.approx(0.0, abs=1e-15))


def test_ripple_force_gives_and_takes_the_same_energy() -> None:
    """Give F λ/π to a ball within half a wavelength, and take it again within the next half."""
    run = rolled({"ripple_force": {"force": 0.01, "wavelength": 0.06}}, State(0.24, 0.3), 0.4)
    half, whole = (int(np.argmin(abs(run.position - place))) for place in (0.27, 0.30))
    # the nearest of steps of 0.03 mm: the force there is 0.01 sin(0.003)/2 at most where it changes sign
    gained = run.velocity[[half, whole]] ** 2 - 0.09
    np.testing.assert_allclose(gained, [2 * 0.01 * 0.06 / np.pi / MOVED, 0.0], atol=1e-5)


def test_magnet_pulls_towards_its_place() -> None:
    """Pull towards the magnet from both sides, at most with F and that half its distance away."""
    for side in (-1.0, 1.0):
        place = 0.3 + side * 0.025
        run = rolled({"magnet": {"force": 0.01, "centre": 0.3, "distance": 0.05}}, State(place, 0.0), 0.01)
        # at its strongest the force is flat: a way of 6 µm changes it by (6e-6/0.05)²
        assert run.velocity[-1] == pytest.approx(-side * 0.01 / MOVED * 0.01, rel=1e-6)
        for near in (0.95, 1.05):
            other = rolled(
                {"magnet": {"force": 0.01, "centre": 0.3, "distance": 0.05}},
                State(0.3 + near * side * 0.025, 0.0),
                0.01,
            )
            assert abs(other.velocity[-1]) < abs(run.velocity[-1])


def test_cubic_spring_keeps_its_energy() -> None:
    """Exchange ½ (m + J/r²) v² with ¼ k x⁴."""
    run = rolled({"cubic_spring": {"stiffness": 20.0, "centre": 0.3}}, State(0.3, 0.1), 5.0)
    total = 0.5 * MOVED * run.velocity**2 + 0.25 * 20.0 * (run.position - 0.3) ** 4
    assert np.ptp(run.position) > 0.1
    # midpoint: (ω dt)²/12 with ω < 5/s
    np.testing.assert_allclose(total, total[0], rtol=1e-7)


@pytest.mark.parametrize("tilt", [0.01, -0.01, 0.04])
def test_cable_pulls_with_the_angle(tilt: float) -> None:
    """Add F sin(p α) to the weight's pull along the beam, other than any gain of the angle could."""
    run = rolled({"cable_pull": {"force": 0.008, "frequency": 60.0}}, State(0.3, 0.0), 1.0, motion=Fixed(tilt))
    pull = M * G * math.sin(tilt) + 0.008 * math.sin(60.0 * tilt)
    np.testing.assert_allclose(run.velocity, pull / MOVED * run.time, rtol=0.0, atol=1e-11)
