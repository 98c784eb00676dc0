from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic.geometry import RAIL_REACH
from analytic.models import CAM
from analytic.motion import BallForce, BeamMotion, FloatArray, State, beam_states
from analytic.rig import Rig
from harness.engines.health import Failure
from harness.engines.mujoco import MuJoCo
from harness.engines.mujoco_parameters import MuJoCoParameters
from harness.engines.protocol import EngineRun
from harness.errors import EngineFailure, InputError
from tests.motions import Fixed, Sines
from tests.reference import reference

PAPER = Rig()
STEEP = Rig(mass=0.033, inertia=1.32e-6, radius=0.01, rolling_radius=0.007, eccentricity=0.02)  # normals lean 45.6°
ABOVE = Rig(mass=0.033, inertia=1.32e-6, radius=0.01, rolling_radius=0.0099, eccentricity=-0.05)  # pivot over the edges
RIGS = pytest.mark.parametrize("rig", [PAPER, STEEP, ABOVE], ids=["paper", "steep groove", "pivot above"])

TWO_SINES = Sines(((0.03, 0.8 * math.pi, 0.0), (0.022, 0.3 * math.pi, 1.0)))  # ±3°
START = State(0.3, -0.05)
STAMPS = np.linspace(0.0, 10.0, 1001)


def run(
    *,
    rig: Rig = PAPER,
    motion: BeamMotion = TWO_SINES,
    start: State = START,
    time: FloatArray = STAMPS,
    force: BallForce | None = None,
    **settings: object,
) -> EngineRun:
    """A run with some settings changed."""
    return MuJoCo().run(rig, motion, start, time, parameters=MuJoCoParameters(**settings), force=force)  # type: ignore[arg-type]


def bound(rig: Rig) -> float:
    """Largest |s − s_CAM| that is understood at a step of 1 ms [m].

    Within a step the beam's surface leaves its tangent by (2 ṡ α̇ + s α̈) dt²/2, here 0.1 µm at most. The contact takes
    that off in the next step, so that the ball's height is wrong by up to half of it, δ = 0.05 µm, and the ball's
    acceleration by the share 2 (1 − K) δ/r. If δ kept its sign and its size, that would be as much of a path of 1.5 m;
    it does neither, and a quarter is allowed.
    """
    return 0.25 * 2.0 * (1.0 - rig.rolling_ratio) * 0.05e-6 / rig.rolling_radius * 1.5


def remainder(time_step: float) -> float:
    """What is left of first order in the step after 10 s [m].

    Friction leaves a slip of ½ s α̇² dt (2 − x)/x, with x = 1.8; a slip moves the ball by the share 1 − K.
    """
    position = reference(CAM, PAPER, TWO_SINES, START, STAMPS).position
    slip = 0.5 * float(np.mean(position * TWO_SINES.derivative(STAMPS) ** 2)) * time_step * (0.2 / 1.8)
    return (1.0 - PAPER.rolling_ratio) * slip * 10.0


def error(*, rig: Rig = PAPER, motion: BeamMotion = TWO_SINES, **settings: object) -> float:
    """max |s − s_CAM| over 10 s [m]."""
    cam = reference(CAM, rig, motion, START, STAMPS)
    return float(np.abs(run(rig=rig, motion=motion, **settings).trajectory.position - cam.position).max())


def failure(**settings: object) -> EngineFailure:
    """How a run fails."""
    with pytest.raises(EngineFailure) as caught:
        run(**settings)  # type: ignore[arg-type]
    assert caught.value.engine == "mujoco"
    assert isinstance(caught.value.failure, Failure)
    assert caught.value.failure.value in str(caught.value)
    return caught.value


# --- accuracy -----------------------------------------------------------------------------------------------------


@RIGS
def test_agrees_with_cam(rig: Rig) -> None:
    """Follow eq. 14 within a micrometre over 10 s at the default step of 1 ms, within two in the steep groove."""
    assert error(rig=rig) < bound(rig)


@pytest.mark.parametrize("time_step", [5e-4, 2e-4, 1e-4])
def test_error_falls_with_the_step(time_step: float) -> None:
    """Reach 0.1 µm with a step of 0.5 ms, 0.07 µm with 0.1 ms."""
    # K g α t²/12 for the drive, whose error of 3e-10 rad after 10 s grows with t².
    assert error(time_step=time_step) < bound(PAPER) * (time_step / 1e-3) ** 2 + remainder(time_step) + 0.016e-6


@pytest.mark.slow
def test_error_vanishes_with_the_step() -> None:
    """Reach 0.04 µm with steps of 10 µs: nothing but the step separates engine and equation."""
    # Of the terms above only the drive's is left, and rounding: a million steps of 1e-16 m in s at random, 1e-17/1e-5
    # in ṡ each: some 1e-9 m/s after 10 s, 0.01 µm.
    assert error(time_step=1e-5) < remainder(1e-5) + 0.016e-6 + 0.01e-6


def test_converges_with_second_order() -> None:
    """Lower the error with the square of the step, fitted over a factor of eight."""
    steps = np.array([4e-3, 2e-3, 1e-3, 5e-4])
    errors = [error(time_step=float(step)) for step in steps]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    # Two second-order terms of either sign and a small first-order one: the fit scatters by a third around 2.
    assert 1.7 < slope < 2.7


def test_level_error_acts_on_gravity() -> None:
    """See α + α₀ where gravity is concerned and α elsewhere."""
    assert error(rig=PAPER.with_(level_angle=-0.003)) < bound(PAPER)


def test_beam_meets_every_angle() -> None:
    """Keep the hinge on the angles asked for."""
    # m g s t²/(2 · 1e11) = 1e-10 rad in 10 s, more where the ball is further out.
    assert run().health.angle_error_max < 1e-9


def test_margin_keeps_the_ball_at_its_declared_height() -> None:
    """Leave the ball where r says, whatever the contact's softness; without the margin it sinks and rolls slower."""
    soft = {"solref_timeconst": 0.02, "solref_dampratio": 1.0, "solimp_dmin": 0.9, "solimp_dmax": 0.95}
    # The static sink by MuJoCo's own constants is about (1 − d)/d · g T² d² R/r = 0.3 mm. With the margin only its
    # change with the load is left, |N/N₀ − 1| < 10 % of it.
    assert run(**soft).health.height_error_max < 0.03e-3
    assert 0.2e-3 < run(**soft, margin=0.0).health.height_error_max < 0.4e-3


# --- rolling ------------------------------------------------------------------------------------------------------


@RIGS
def test_rolls_on_its_rolling_radius(rig: Rig) -> None:
    """Measure r as path over rolled angle, both from the engine."""
    outcome = run(rig=rig)
    path = outcome.trajectory.position - START.position
    far = np.abs(path) > 0.1
    # Height error 0.04 µm and slip of 1e-6 m/s over 10 s on a path of more than 0.1 m: 3e-6 + 1e-5 / 0.1 × 0.1.
    assert far.any()
    np.testing.assert_allclose(path[far] / outcome.rolled_angle[far], rig.rolling_radius, rtol=2e-5)


@RIGS
def test_health_of_a_sound_run(rig: Rig) -> None:
    """Report two contacts at every step, a load near the weight, and next to no slip."""
    health = run(rig=rig).health
    assert (health.contacts_min, health.contacts_max) == (2, 2)
    # N = m (g cos α − 2 ṡ α̇ − s α̈ − …): s α̈ up to 1 m × 0.2 rad/s², α up to 3°
    assert 0.9 * rig.mass * rig.gravity < health.normal_force_min < rig.mass * rig.gravity
    assert health.height_error_max < 0.05e-6  # δ of `bound`
    assert health.lateral_offset_max < 1e-8  # symmetric but for rounding and the solver's tolerance
    assert health.slip_max < 5e-6  # ½ s α̇² dt for s = 1 m, α̇ = 0.1 rad/s
    assert health.warnings == ()


@pytest.mark.parametrize("friction", [0.3, 0.1, 0.03])
def test_rolling_does_not_depend_on_friction_that_suffices(friction: float) -> None:
    """Roll alike for every coefficient that holds the ball."""
    # Rolling needs (1 − K) tan α r/R = 0.016 at 3°.
    assert error(friction=friction) < bound(PAPER)


def test_sliding_is_a_failure() -> None:
    """Refuse a run whose friction cannot hold the ball, and say so."""
    for friction in (1e-5, 0.01):
        slid = failure(friction=friction)
        assert slid.failure is Failure.SLIPPED
        assert "10" in str(slid)  # mm/s, the limit
        assert slid.time < 1.0


def test_sliding_may_be_studied() -> None:
    """Slide by Coulomb's law where the user lifts the limit: |F_t| = μ N R/r on a slope that μ does not hold."""
    tilt, mu, dt, lasting = 0.2, 0.01, 1e-4, 0.5
    slid = run(
        motion=Fixed(tilt),
        start=State(0.0, 0.0),
        time=np.linspace(0.0, lasting, 51),
        time_step=dt,
        friction=mu,
        friction_relaxation=0.002,  # MuJoCo lifts a sliding contact by μ times the slip removed in a step
        slip_limit=10.0,
    )
    load = PAPER.mass * PAPER.gravity * math.cos(tilt) * PAPER.radius / PAPER.rolling_radius
    sliding = PAPER.gravity * math.sin(tilt) - mu * load / PAPER.mass
    spin_up = mu * load * PAPER.rolling_radius / PAPER.inertia
    # A run starts rolling: half a step before t₀ its velocity and its spin are off by dt/2 times the difference of the
    # rolling and the sliding acceleration.
    rolling = PAPER.rolling_ratio * PAPER.gravity * math.sin(tilt)
    path, turned = 0.5 * sliding * lasting**2, 0.5 * spin_up * lasting**2
    slack = 0.5 * dt * lasting
    assert slid.trajectory.position[-1] == pytest.approx(path, abs=slack * abs(rolling - sliding) + 1e-4 * path)
    assert slid.rolled_angle[-1] == pytest.approx(turned, abs=slack * abs(rolling / PAPER.rolling_radius - spin_up))


def test_rolling_friction_brakes_as_documented() -> None:
    """Brake with a moment ΣN √(μ_r² cos²θ + μ_t² sin²θ) at condim 6."""
    dt, lasting = 1e-4, 1.0
    braked = run(
        motion=Fixed(),
        start=State(0.0, 0.3),
        time=np.linspace(0.0, lasting, 11),
        time_step=dt,
        condim=6,
        rolling_friction=2e-5,
        torsional_friction=1e-5,
        friction_relaxation=0.005,
    )
    lean = PAPER.contact_angle
    load = PAPER.mass * PAPER.gravity * PAPER.radius / PAPER.rolling_radius
    moment = load * math.hypot(2e-5 * math.cos(lean), 1e-5 * math.sin(lean))
    slowing = moment / PAPER.rolling_radius / PAPER.mass * PAPER.rolling_ratio
    # Half a step before t₀ the ball was not slowed yet: dt/2 times the slowing, over one second.
    short = 0.3 * lasting - braked.trajectory.position[-1]
    assert short == pytest.approx(0.5 * slowing * lasting**2, abs=0.5 * dt * slowing * lasting)


# --- force, stamps ------------------------------------------------------------------------------------------------


def test_force_acts_along_the_beam() -> None:
    """Follow eq. 14 with F = −c ṡ + k sin(s/l) + f α cos t."""
    rig = PAPER

    def force(s: float, v: float, angle: float, t: float) -> float:
        return -0.05 * v + 0.01 * math.sin(s / 0.05) + 0.2 * angle * math.cos(t)

    def slope(t: float, y: FloatArray) -> tuple[float, float]:
        angle, rate, turn = beam_states(TWO_SINES, np.array([t]))[0]
        drive = rig.gravity * math.sin(angle) + y[0] * rate**2 - rig.lever * turn
        return y[1], rig.rolling_ratio * (drive + force(y[0], y[1], angle, t) / rig.mass)

    start = (START.position, START.velocity)
    exact = solve_ivp(slope, (0.0, 10.0), start, method="DOP853", t_eval=STAMPS, rtol=1e-12, atol=1e-13).y[0]
    coarse, fine = (
        float(np.abs(run(force=force, time_step=dt).trajectory.position - exact).max()) for dt in (1e-3, 2.5e-4)
    )
    # Second order: ṡ at t_n is extrapolated, wrong by 3/8 dt² s⃛ ~ 2e-7 m/s; c/m = 0.7/s and 10 s make that 1 µm. The
    # spring of wavelength 0.3 m takes part in the error of s itself, for at most as much again per second.
    assert coarse < 5e-6
    assert fine < coarse / 8


def test_idle_force_changes_nothing() -> None:
    """Compute the same run bit by bit with a force of zero, and again without one."""
    plain, idle, again = run(), run(force=lambda s, v, angle, t: 0.0), run()
    np.testing.assert_array_equal(plain.trajectory.position, idle.trajectory.position)
    np.testing.assert_array_equal(plain.trajectory.position, again.trajectory.position)


def test_uneven_stamps_are_met_exactly() -> None:
    """Give the ball at any stamps, between steps too, without a bias of half a step."""
    stamps = np.concatenate([[2.0], 2.0 + np.sort(np.random.default_rng(1).uniform(0.0, 8.0, 300))])
    outcome = run(time=stamps)
    cam = reference(CAM, PAPER, TWO_SINES, START, stamps)
    np.testing.assert_array_equal(outcome.trajectory.time, stamps)
    # Hermite's remainder dt⁴/384 s⁗ is below 1e-14 m, that of its derivative below 1e-10 m/s.
    np.testing.assert_allclose(outcome.trajectory.position, cam.position, atol=bound(PAPER))
    # Half a step's bias would be 1.2e-4 m/s here; a centred difference is wrong by dt² s⃛/6 ~ 1e-7 m/s.
    np.testing.assert_allclose(outcome.trajectory.velocity, cam.velocity, atol=1e-6)
    assert outcome.rolled_angle[0] == 0.0


# --- failures -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Jump(Sines):
    """Two sines that jump by `height` [rad] at 4 s."""

    height: float = 0.02

    def evaluate(self, time: FloatArray) -> FloatArray:
        """α [rad]."""
        return super().evaluate(time) + np.where(time > 4.0, self.height, 0.0)


def test_jump_of_the_angle_throws_the_ball_out() -> None:
    """Notice that the ball left the groove, and when."""
    thrown = failure(motion=Jump())
    assert thrown.failure is Failure.LEFT_GROOVE
    assert thrown.time == pytest.approx(4.0, abs=0.01)


def test_small_jump_is_survived_and_told() -> None:
    """Survive a jump of 0.1 mrad, but tell that the ball flew."""
    health = run(motion=Jump(height=1e-4)).health
    assert health.contacts_min == 0
    assert health.normal_force_min == 0.0


def test_shaking_beam_loses_the_ball() -> None:
    """Notice a flight of more than 10 ms: s α̈ exceeds g by a tenth, eight times a second."""
    omega = 16.0 * math.pi
    shaken = failure(
        motion=Sines(((1.1 * 9.81 / 0.36 / omega**2, omega, 0.0),)), start=State(0.36, 0.0), time=np.linspace(0, 1, 101)
    )
    assert shaken.failure is Failure.LIFTED_OFF


def test_ball_runs_off_the_rails() -> None:
    """Notice the rails' end."""
    gone = failure(start=State(RAIL_REACH - 0.3, 0.5))
    assert gone.failure is Failure.RAN_OFF
    assert gone.time < 1.0


@pytest.mark.parametrize("push", [math.nan, 1e30])
def test_reset_is_noticed(push: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: object) -> None:
    """Notice that MuJoCo reset its state, without its log file and its prints."""
    monkeypatch.chdir(tmp_path)
    reset = failure(force=lambda s, v, angle, t: push if t > 5.0 else 0.0)
    assert reset.failure is Failure.RESET
    assert reset.time == pytest.approx(5.0, abs=0.002)
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")  # type: ignore[attr-defined]


def test_standstill_of_the_engine_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Notice an engine that answers without going on."""
    step, calls = mujoco.mj_step, iter(range(10**9))
    monkeypatch.setattr(mujoco, "mj_step", lambda model, data: step(model, data) if next(calls) < 700 else None)
    frozen = failure(force=lambda s, v, angle, t: 0.0)  # without a force MuJoCo loops by itself
    assert frozen.failure is Failure.FROZEN
    assert frozen.time == pytest.approx(0.7, abs=0.002)


def test_exploding_contact_is_a_failure() -> None:
    """Refuse what comes out of contacts that are too stiff for the step, where the user lifted MuJoCo's safeguard."""
    for shortest in (2e-4, 1e-5):
        assert failure(refsafe=False, solref_timeconst=shortest).failure in (Failure.LEFT_GROOVE, Failure.RESET)


def test_contact_that_cannot_carry_the_ball_is_a_failure() -> None:
    """Say so before the run if the contacts are too soft for the ball's weight."""
    sunk = failure(solref_timeconst=1.0, solimp_dmin=0.1, solimp_dmax=0.1)
    assert sunk.failure is Failure.LEFT_GROOVE
    assert "too soft" in str(sunk)


def test_angle_that_is_no_number_is_refused() -> None:
    """Name the place of a gap in the angle; MuJoCo would hold the beam's rate there without a word."""
    with pytest.raises(InputError, match=r"4\.001"):
        run(motion=Jump(height=math.nan))
