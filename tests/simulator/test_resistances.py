"""What resists the ball, against closed solutions of (m + J/r²) s̈ = F."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.motion import State
from tests.simulator.acting import EACH, MOVED, RIG, G, K, M, rolled
from tests.simulator.motions import Fixed

# Implicit midpoint steps of 1e-4 s against rates of at most 10/s: (1e-3)²/12 = 1e-7 relative. All tolerances below that
# name no other reason are this figure, doubled.
MIDPOINT = 2e-7


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_viscous_ball_reaches_its_terminal_velocity(sign: float) -> None:
    """Roll down at m g sin α / c in the end, whichever end is down, on the exponential way there."""
    c, tilt = 0.3, sign * 0.02
    run = rolled({"viscous_damping": {"coefficient": c}}, State(0.3, 0.0), 10.0, motion=Fixed(tilt))
    end, rate = M * G * math.sin(tilt) / c, c / MOVED
    np.testing.assert_allclose(run.velocity, end * (1 - np.exp(-rate * run.time)), rtol=0.0, atol=MIDPOINT * abs(end))
    assert run.velocity[-1] == pytest.approx(end, rel=1e-8)  # exp(−10 · 2.8) = 6e-13


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_quadratic_drag_brakes_hyperbolically(speed: float) -> None:
    """Slow down as v₀/(1 + c |v₀| t/(m + J/r²)), towards either side."""
    c = 0.4
    run = rolled({"quadratic_drag": {"coefficient": c}}, State(0.3, speed), 3.0)
    expected = speed / (1 + c * abs(speed) / MOVED * run.time)
    np.testing.assert_allclose(run.velocity, expected, rtol=MIDPOINT)


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_cubic_drag_brakes_by_the_cube(speed: float) -> None:
    """Slow down as v₀/√(1 + 2 c v₀² t/(m + J/r²)), towards either side."""
    c = 0.8
    run = rolled({"cubic_drag": {"coefficient": c}}, State(0.3, speed), 3.0)
    expected = speed / np.sqrt(1 + 2 * c * speed**2 / MOVED * run.time)
    np.testing.assert_allclose(run.velocity, expected, rtol=MIDPOINT)


def stopping(coefficient: float, speed: float) -> float:
    """Way to the stop under c N, v²/(2 K c g) [m]."""
    return speed * abs(speed) / (2 * K * coefficient * G)


@pytest.mark.parametrize(("speed", "coefficient"), [(0.05, 0.002), (-0.05, 0.005)])
@pytest.mark.parametrize("name", ["rolling_resistance", "directional_resistance"])
def test_resistance_stops_the_ball_after_its_way(name: str, speed: float, coefficient: float) -> None:
    """Stop after v²/(2 K c g), with the coefficient of the direction it rolls in, and stay."""
    parameters = EACH[name] if name == "directional_resistance" else {"coefficient": coefficient}
    run = rolled({name: parameters}, State(0.3, speed), 4.0)
    # the stop comes up to a step late: half a step's loss of velocity over a step, K c g dt²/2 = 2e-10 m
    assert run.position[-1] == pytest.approx(0.3 + stopping(coefficient, speed), abs=3e-10)
    stopped = run.time > abs(speed) / (K * coefficient * G) + 1e-4
    assert stopped.any()
    assert np.all(run.velocity[stopped] == 0.0)


@pytest.mark.parametrize(
    ("name", "plus", "minus"), [("directional_resistance", 0.002, 0.005), ("stribeck_friction", 0.006, 0.006)]
)
def test_ball_breaks_away_at_the_static_angle(name: str, plus: float, minus: float) -> None:
    """Hold the ball to the bit below atan(c) of the direction it would roll in, and let it go above."""
    for tilt, moves in ((0.99 * plus, False), (1.01 * plus, True), (-0.99 * minus, False), (-1.01 * minus, True)):
        run = rolled({name: EACH[name]}, State(0.36, 0.0), 3.0, motion=Fixed(math.atan(tilt)))
        assert (run.position[-1] != 0.36) == moves
        assert not moves or math.copysign(1.0, run.position[-1] - 0.36) == math.copysign(1.0, tilt)


def test_stribeck_friction_falls_with_velocity() -> None:
    """Lose ½ (m + J/r²) v² to ∫ c(ṡ) N ds: so dv/dt = −K g c(v) at every velocity."""
    values = EACH["stribeck_friction"]
    run = rolled({"stribeck_friction": values}, State(0.3, 0.08), 1.5)
    middle = 0.5 * (run.velocity[1:] + run.velocity[:-1])
    braking = -np.diff(run.velocity) / np.diff(run.time)
    excess = values["static_coefficient"] - values["kinetic_coefficient"]
    expected = K * G * (values["kinetic_coefficient"] + excess * np.exp(-((middle / values["stribeck_velocity"]) ** 2)))
    assert middle[-1] > 0.0  # still rolling
    # c at the mean velocity of a step against the mean of c: c'' (Δv)²/24 ≈ 0.003/0.02² (5e-6 m/s)²/24 = 1e-11;
    # differences of velocities of 0.08 m/s over 1e-4 s round to 1e-13
    np.testing.assert_allclose(braking, expected, rtol=0.0, atol=1e-10)


def test_resistances_add() -> None:
    """Brake with the sum of coefficients of rolling resistance, Stribeck and the directional one."""
    effects = {name: EACH[name] for name in ("rolling_resistance", "directional_resistance", "stribeck_friction")}
    run = rolled(effects, State(0.2, 0.5), 0.5)
    # at 0.4 m/s and more the static excess is exp(−400)
    assert run.velocity[-1] == pytest.approx(0.5 - K * G * (0.004 + 0.002 + 0.003) * 0.5, abs=1e-12)


def test_presliding_is_a_spring_for_micro_displacements() -> None:
    """Swing on a slight slope about z = m g sin α/σ with ω = √(σ/(m + J/r²)) while z is far below c m g/σ."""
    c, stiffness, tilt = 0.5, 50.0, 1e-5
    run = rolled(
        {"presliding_hysteresis": {"coefficient": c, "stiffness": stiffness}}, State(0.3, 0.0), 1.0, motion=Fixed(tilt)
    )
    frequency, sag = math.sqrt(stiffness / MOVED), M * G * tilt / stiffness
    expected = 0.3 + sag * (1 - np.cos(frequency * run.time))
    # Dahl's own softening: z σ/(c N) <= 2 tilt/c = 4e-5 of the force, a phase of 25 rad: 1e-3 of the sag
    np.testing.assert_allclose(run.position, expected, rtol=0.0, atol=2e-3 * sag)


def test_presliding_becomes_rolling_resistance() -> None:
    """Brake with c N once the ball has rolled much further than c N/σ, in either direction."""
    c, stiffness = 0.004, 200.0
    for speed in (0.3, -0.3):
        run = rolled({"presliding_hysteresis": {"coefficient": c, "stiffness": stiffness}}, State(0.3, speed), 0.5)
        late = run.time > 0.1  # 30 mm; c N/σ = 14 µm
        braking = np.diff(run.velocity[late]) / 1e-4
        # rounding of 0.3 m/s over 1e-4 s; what is left of the start is exp(−2000)
        np.testing.assert_allclose(braking, -math.copysign(K * c * G, speed), atol=1e-10)


def test_presliding_loop_takes_energy() -> None:
    """Swing back, as Coulomb friction would not let the ball, but with less and less energy."""
    run = rolled({"presliding_hysteresis": {"coefficient": 0.004, "stiffness": 50.0}}, State(0.3, 0.01), 3.0)
    assert run.velocity.min() < 0.0
    turns = np.flatnonzero(np.diff(np.sign(run.velocity)) != 0)
    swings = np.abs(np.diff(run.position[turns]))
    assert len(swings) > 5
    assert np.all(np.diff(swings) < 0.0)


def test_fading_resistance_fades() -> None:
    """Brake by K g c exp(−t/τ), and let a ball go that it held at first."""
    values = {"coefficient": 0.006, "time_constant": 2.0}
    run = rolled({"fading_resistance": values}, State(0.2, 0.5), 3.0)
    lost = K * G * 0.006 * 2.0 * (1 - np.exp(-run.time / 2.0))
    np.testing.assert_allclose(run.velocity, 0.5 - lost, rtol=0.0, atol=1e-10)  # midpoint rule: (dt/τ)²/24 of 0.1 m/s
    held = rolled({"fading_resistance": values}, State(0.3, 0.0), 3.0, motion=Fixed(0.003))
    # c falls below tan α at τ ln(0.006/0.003)
    free = 2.0 * math.log(0.006 / math.tan(0.003))
    assert np.all(held.velocity[held.time < free - 1e-4] == 0.0)
    assert np.all(held.velocity[held.time > free + 2e-4] > 0.0)


def test_rough_patch_resists_only_on_it() -> None:
    """Take c m g times the length of the patch from the ball's energy, and nothing elsewhere."""
    run = rolled({"rough_patch": {"coefficient": 0.01, "start": 0.30, "end": 0.34}}, State(0.25, 0.3), 0.6)
    assert run.position[-1] > 0.36
    # each edge rises evenly over 2 mm; its two corners are met to a step, (0.3 m/s · 1e-4 s)²/(2 · 2 mm) = 0.23 µm
    assert run.dissipated[-1] == pytest.approx(0.01 * M * G * 0.04, abs=0.01 * M * G * 4 * 2.3e-7)
    outside = (run.position < 0.2989) | (run.position > 0.3411)
    np.testing.assert_allclose(np.diff(run.dissipated)[outside[1:] & outside[:-1]], 0.0, atol=1e-18)


def test_sticky_spot_comes_once_a_revolution() -> None:
    """Find the spots 2π r apart along the track, the first where the ball's mark comes down."""
    before = 2.0
    run = rolled({"sticky_spot": {"coefficient": 0.02, "width": 0.1}}, State(0.2, 0.5), 0.5, turned_before=before)
    taken = np.gradient(run.dissipated, run.position)
    peaks = np.flatnonzero((taken[1:-1] > taken[:-2]) & (taken[1:-1] >= taken[2:]) & (taken[1:-1] > 0.01 * M * G)) + 1
    circumference = 2 * math.pi * RIG.rolling_radius
    assert len(peaks) == 3
    # 0.5 m/s · 1e-4 s = 50 µm between instants
    np.testing.assert_allclose(np.diff(run.position[peaks]), circumference, atol=1e-4)
    assert run.position[peaks[0]] == pytest.approx(0.2 + (2 * math.pi - before) * RIG.rolling_radius, abs=1e-4)
    assert taken[peaks[0]] == pytest.approx(0.02 * M * G, rel=1e-3)  # the top of a bell 24 instants wide
