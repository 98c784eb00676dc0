"""The plant is accurate: energy, order of convergence, and agreement with eq. 14, integrated here on its own."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness.simulator as virtual_rig
from analytic.motion import BeamMotion, FloatArray, State
from analytic.rig import Rig
from harness.simulator import Plant, simulate
from harness.simulator.bundled import LEVEL_ANGLE, ROLLING_RESISTANCE, perform_all
from tests.simulator.motions import Fixed, Sines

RIG = Rig()
START = State(0.36, -0.1)


def cam_reference(rig: Rig, motion: BeamMotion, start: State, time: FloatArray) -> FloatArray:
    """s of eq. 14 with the level error of eq. 19, to a relative 1e-12; shape (n,) [m]."""
    m, J, r, h = rig.mass, rig.inertia, rig.rolling_radius, rig.eccentricity

    def slope(t: float, state: FloatArray) -> list[float]:
        s, v = state
        now = np.array(t)
        weight = m * rig.gravity * math.sin(motion.evaluate(now) + rig.level_angle)
        inertial = m * s * float(motion.derivative(now)) ** 2 - (m * (h + r) + J / r) * float(motion.derivative(now, 2))
        return [v, (weight + inertial) / (J / r**2 + m)]

    start_state = [start.position, start.velocity]
    solution = solve_ivp(slope, (time[0], time[-1]), start_state, "DOP853", time, rtol=1e-12, atol=1e-14)
    return np.asarray(solution.y[0])


@pytest.mark.parametrize(
    "rig",
    [RIG, Rig(level_angle=math.radians(-0.16)), Rig(eccentricity=-0.02, rolling_radius=0.0125)],
    ids=["paper", "level error", "pivot above the rails"],
)
def test_frictionless_plant_agrees_with_eq_14(rig: Rig) -> None:
    """Follow eq. 14 over 10 s to the error of the plant's own step, although the plant does not know it."""
    fine, coarse = (simulate(Plant(rig=rig, step=step), Sines(), START, 10.0) for step in (1e-3, 2e-3))
    expected = cam_reference(rig, Sines(), START, fine.time)
    # second order: error(dt) = (s(2 dt) − s(dt))/3, up to terms smaller by (ω dt)² = 1e-5 relative; 1 % allows for
    # them where the error passes through zero; 1e-11 m is the reference's own tolerance over 10 s
    own_error = np.max(np.abs(coarse.position - fine.position[::2])) / 3
    assert np.max(np.abs(fine.position - expected)) < 1.01 * own_error + 1e-11
    assert own_error < 3e-6  # 1 ms: a second-order step does not need more than a few µm


def test_default_step_is_good_to_nanometres() -> None:
    """Stay within 20 nm of eq. 14 at the default step: a hundredth of the 2 µm found at 1 ms."""
    run = simulate(Plant(), Sines(), START, 10.0)
    assert np.max(np.abs(run.position - cam_reference(RIG, Sines(), START, run.time))) < 2e-8


@pytest.mark.parametrize("resistance", [0.0, 0.003], ids=["frictionless", "with rolling resistance"])
def test_smooth_rolling_converges_with_second_order(resistance: float) -> None:
    """Show second order in the position as long as the ball does not turn round."""
    start, motion = State(0.1, 1.0), Sines(((0.03, 2.0, 0.3),))
    steps = np.array([4e-3, 2e-3, 1e-3, 5e-4])
    reference, *ends = (
        simulate(Plant(rolling_resistance=resistance, step=step), motion, start, 2.0).position[-1]
        for step in (1e-5, *steps)
    )
    order = np.polyfit(np.log(steps), np.log(np.abs(np.array(ends) - reference)), 1)[0]
    # the reference's own error is (1e-5/5e-4)² = 0.04 % of the smallest: it bends the slope by less than 1e-3
    assert order == pytest.approx(2.0, abs=0.02)


@pytest.mark.slow
def test_bundled_plant_is_converged_at_its_step() -> None:
    """Keep the bundled recordings' truth, with its stops and starts, within 0.1 µm of a four times finer step."""
    for run, _ in perform_all().values():
        plant = Plant(rig=Rig(level_angle=LEVEL_ANGLE), rolling_resistance=ROLLING_RESISTANCE, step=2.5e-5)
        fine = simulate(plant, run.beam_motion, State(float(run.position[0]), 0.0), float(run.time[-1]))
        # A turning point is found to dt/1024 = 0.1 µs; resistance of the wrong sign for so long changes ṡ by
        # 2 c g K · 0.1 µs = 4.5 nm/s. Rolling on for the rest of 14 s makes 60 nm; the next rest forgets it.
        assert np.max(np.abs(fine.position[::4] - run.position)) < 1e-7


def test_energy_is_conserved_on_a_fixed_beam() -> None:
    """Keep the energy of a frictionless ball on a fixed slope to rounding."""
    run = simulate(Plant(), Fixed(-0.03), State(0.2, 0.6), 4.0)
    # 4e4 steps, each rounding energies of at most 0.1 J to 1e-17 in some ten operations
    assert np.ptp(run.energy) < 4e-12
    assert np.ptp(run.position) > 0.5
    assert run.work[-1] == 0.0


@pytest.mark.parametrize("resistance", [0.0, 0.003], ids=["frictionless", "with rolling resistance"])
def test_drive_power_is_the_energy_change(resistance: float) -> None:
    """Balance energy against the beam's torque times its rate and the loss, with the error of second order."""
    steps = np.array([4e-3, 2e-3, 1e-3, 5e-4])
    errors = []
    for step in steps:
        run = simulate(Plant(rolling_resistance=resistance, step=step), Sines(), State(0.36, 0.3), 5.0)
        errors.append(np.max(np.abs(run.energy - run.energy[0] - run.work + run.dissipated)))
        assert np.ptp(run.work) > 0.05
    # turning points are resolved to dt/1024 and leave the order alone
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.02)
    if resistance:
        assert run.dissipated[-1] > 1e-3
    else:
        assert np.max(np.abs(run.dissipated)) < errors[-1]


def viscous(position: float, velocity: float, angle: float, rolled_angle: float, time: float) -> float:
    """A viscous force of 0.05 N s/m."""
    return -0.05 * velocity


def spring(position: float, velocity: float, angle: float, rolled_angle: float, time: float) -> float:
    """A spring of 1 N/m that unwinds with the rolled angle, r = 11.8 mm."""
    return -1.0 * 0.0118 * rolled_angle


def shaking(position: float, velocity: float, angle: float, rolled_angle: float, time: float) -> float:
    """A force of 10 mN that oscillates in time."""
    return 0.01 * math.cos(3.0 * time)


def tether(position: float, velocity: float, angle: float, rolled_angle: float, time: float) -> float:
    """A spring of 1 N/m that is slack at 0.3 m, and a pull that the tilt of 0.02 rad just cancels."""
    return -1.0 * (position - 0.3) - 0.071 * 9.81 * math.sin(angle)


MOVED = RIG.mass / RIG.rolling_ratio  # m + J/r²
SPRING = math.sqrt(1.0 / MOVED)


@pytest.mark.parametrize(
    ("force", "tilt", "expected"),
    [
        (viscous, 0.0, lambda t: 0.3 + 0.1 * MOVED / 0.05 * (1 - np.exp(-0.05 / MOVED * t))),
        (spring, 0.0, lambda t: 0.3 + 0.1 / SPRING * np.sin(SPRING * t)),
        (shaking, 0.0, lambda t: 0.3 + 0.1 * t + 0.01 / MOVED / 9.0 * (1 - np.cos(3.0 * t))),
        (tether, 0.02, lambda t: 0.3 + 0.1 / SPRING * np.sin(SPRING * t)),
    ],
    ids=["velocity", "rolled angle", "time", "position and angle"],
)
def test_applied_force_moves_the_ball(
    force: Callable[..., float], tilt: float, expected: Callable[[FloatArray], FloatArray]
) -> None:
    """Answer a force by the closed solution of (m + J/r²) s̈ = F, whatever the force depends on."""
    run = simulate(Plant(force=force), Fixed(tilt), State(0.3, 0.1), 4.0)
    # implicit midpoint: phase error (ω dt)²/12 per radian; ω <= 3.1 rad/s and 12 rad give 1e-7 of 0.1 m amplitude
    np.testing.assert_allclose(run.position, expected(run.time), rtol=0.0, atol=1e-8)
    balance = run.energy - run.energy[0] - run.work + run.dissipated
    # on a fixed beam the discrete energy balance is exact: rounding only, as above
    assert np.max(np.abs(balance)) < 4e-12


def test_plant_shares_no_model_with_the_ones_under_test() -> None:
    """Import from outside only what names and describes."""
    imported: dict[str, set[str]] = {}
    for source in Path(virtual_rig.__file__).parent.glob("*.py"):
        modules = imported.setdefault(source.stem, set())
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                modules.add(node.module)
            elif isinstance(node, ast.Import):
                modules.update(name.name for name in node.names)
    for name, modules in imported.items():
        ours = {module for module in modules if module.split(".")[0] in ("analytic", "harness", "mjcf", "urdf")}
        # analytic.compiled holds no equation: it is numba's decorator with a cache; the effects give names and bounds
        allowed = {"analytic.compiled", "analytic.motion", "analytic.naming", "analytic.rig", "harness.errors"}
        own = ("harness.simulator", "analytic.effects")
        assert {module for module in ours if not module.startswith(own)} <= allowed, name


@pytest.mark.parametrize("wrong", [{"rolling_resistance": -0.1}, {"friction": math.nan}, {"step": 0.0}])
def test_impossible_plant_is_refused(wrong: dict[str, float]) -> None:
    """Refuse a plant that cannot exist, naming the quantity."""
    with pytest.raises(ValueError, match=next(iter(wrong)).replace("_", " ")):
        Plant(**wrong)


def test_run_shorter_than_a_step_is_refused() -> None:
    """Refuse a run without a single step."""
    with pytest.raises(ValueError, match="shorter"):
        simulate(Plant(), Fixed(), START, 1e-6)


def test_servo_motion_drives_the_plant_like_any_motion() -> None:
    """Follow eq. 14 under the servo's motion to second order, because the jumps of its α̈ fall between steps."""
    run, _ = next(iter(perform_all().values()))
    start, duration = State(0.36, 0.0), 6.0
    coarse, fine = (simulate(Plant(step=step), run.beam_motion, start, duration) for step in (1e-4, 5e-5))
    own_error = 4 / 3 * np.max(np.abs(coarse.position - fine.position[::2]))  # of the coarser run
    # classical Runge–Kutta on the servo's own steps, in which α̈ is constant: error (ω dt)⁴ = 1e-13, so 1e-11 m for
    # rounding over 6e4 steps
    position, velocity = start.position, start.velocity
    half = 0.5 * (coarse.time[1] - coarse.time[0])
    places = np.arange(2 * coarse.time.size - 1) * half
    angle, rate = run.beam_motion.evaluate(places), run.beam_motion.derivative(places)
    acceleration = run.acceleration.repeat(2)
    lever = RIG.eccentricity + RIG.rolling_radius + RIG.inertia / (RIG.mass * RIG.rolling_radius)
    expected = [position]
    for i in range(0, places.size - 1, 2):

        def slope(s: float, at: int, now: int = i) -> float:
            push = s * rate[at] ** 2 + RIG.gravity * math.sin(angle[at]) - lever * acceleration[now]
            return float(push * RIG.rolling_ratio)

        k1 = slope(position, i)
        k2 = slope(position + half * velocity, i + 1)
        k3 = slope(position + half * (velocity + half * k1), i + 1)
        k4 = slope(position + 2 * half * (velocity + half * k2), i + 2)
        position += 2 * half * (velocity + half * (k1 + k2 + k3) / 3)
        velocity += half * (k1 + 2 * k2 + 2 * k3 + k4) / 3
        expected.append(position)
    assert np.max(np.abs(coarse.position - np.array(expected))) < 1.01 * own_error + 1e-11
