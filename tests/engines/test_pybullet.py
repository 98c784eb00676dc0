"""PyBullet follows eq. 14 on a driven beam, and never hands on a run that does not."""

from __future__ import annotations

import gc
import math
from collections.abc import Iterator

import numpy as np
import pybullet
import pytest
from pydantic import ValidationError
from scipy.integrate import solve_ivp

from analytic.models import CAM
from analytic.motion import BallForce, State, beam_states
from analytic.rig import Rig
from harness.engines.health import Failure
from harness.engines.protocol import EngineRun
from harness.engines.pybullet import PyBullet, PyBulletParameters
from harness.errors import EngineFailure, InputError
from tests.motions import ClosedForm, Fixed, Ramp, Sines
from tests.reference import reference

PAPER = Rig()
SMALL = Rig(radius=0.01, rolling_radius=0.007, inertia=2.84e-6)
MOTION = Sines(((0.038, 2.2, 0.5 * math.pi), (0.014, 5.7, 0.7)))  # 3° at most; the ball travels 0.36 to 0.7 m
START = State(0.36, 0.0)
STAMPS = np.linspace(0.0, 10.0, 1001)


def run(
    rig: Rig = PAPER, *, force: BallForce | None = None, stamps: np.ndarray = STAMPS, **settings: float
) -> EngineRun:
    """Drive the two-sine motion."""
    return PyBullet().run(rig, MOTION, START, stamps, parameters=PyBulletParameters(**settings), force=force)


def error_of(result: EngineRun, rig: Rig = PAPER) -> float:
    """max |s − s of eq. 14| [m]."""
    exact = reference(CAM, rig, MOTION, START, result.trajectory.time)
    return float(np.abs(result.trajectory.position - exact.position).max())


def failure_of(**arguments: object) -> EngineFailure:
    """The failure of a run that has to fail."""
    call: dict[str, object] = {"rig": PAPER, "motion": MOTION, "start": START, "time": STAMPS} | arguments
    with pytest.raises(EngineFailure) as caught:
        PyBullet().run(**call)  # type: ignore[arg-type]
    return caught.value


# The scheme is of second order: s shifts by some s⃛ dt³/12 a step. With |s⃛| <= K g |α̇| = 0.9 m/s³, one sign for
# a quarter of a period of 2.9 s and passed on as velocity for 10 s, that is 0.9/12 × 1e-6 × 0.7 × 10 = 0.5 µm at
# dt = 1 ms and a hundredth of it at 0.1 ms; twice that is allowed. 2.5 µm and 0.25 µm are what is demanded.
@pytest.mark.parametrize(("time_step", "bound"), [(1e-3, 1e-6), pytest.param(1e-4, 0.01e-6, marks=pytest.mark.slow)])
@pytest.mark.parametrize("rig", [PAPER, PAPER.with_(level_angle=-0.0028), SMALL], ids=["paper", "tilted", "small"])
def test_position_agrees_with_eq_14(rig: Rig, time_step: float, bound: float) -> None:
    """Stay within micrometres of the reference solution over 10 s, also off level and on another rig."""
    assert error_of(run(rig, time_step=time_step), rig) < bound


def test_error_is_of_second_order() -> None:
    """Fit the slope of log error over log dt: the drive and the stagger leave no first-order term."""
    steps = np.array([8e-3, 4e-3, 2e-3, 1e-3, 5e-4])
    errors = [error_of(run(time_step=step)) for step in steps]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    # Between two neighbours a term of third order, at most as large as the second at 8 ms, moves the slope by 0.2.
    assert slope == pytest.approx(2.0, abs=0.2)


def test_large_steps_keep_the_order() -> None:
    """Roll 10 mm a step and still follow: stale contact points are replaced."""
    # Second order from the bound at 1 ms: 1 µm × 20².
    assert error_of(run(time_step=0.02)) < 0.4e-3


def test_velocity_agrees_with_eq_14() -> None:
    """Report the velocity at the stamps, not half a step before them."""
    exact = reference(CAM, PAPER, MOTION, START, STAMPS)
    # Half a step late would be g K α dt/2 = 0.2 mm/s; a centred difference is off by s⃛ dt²/6 = 0.2 µm/s, and the path's
    # error of 1 µm adds as much within the period of 1 s.
    assert np.abs(run().trajectory.velocity - exact.velocity).max() < 2e-6


def test_output_stands_at_the_stamps_asked_for() -> None:
    """Ask uneven stamps that miss the engine's grid, and a first stamp that is not zero."""
    stamps = 3.0 + np.cumsum(np.random.default_rng(1).uniform(0.0005, 0.03, 300))
    result = run(stamps=stamps)
    assert np.array_equal(result.trajectory.time, stamps)
    assert result.trajectory.position[0] == pytest.approx(START.position, abs=1e-15)
    # Interpolation adds s⁗ dt⁴/384, nothing beside the bound at dt = 1 ms.
    exact = reference(CAM, PAPER, MOTION, START, stamps)
    assert np.abs(result.trajectory.position - exact.position).max() < 1e-6


def test_two_contacts_in_every_step() -> None:
    """Look at every step: two contacts that push, hardly any slip, the beam where it should be."""
    health = run(health_interval=0.0).health
    assert (health.contacts_min, health.contacts_max) == (2, 2)
    # N = m (g cos α − 2 ṡ α̇ − s α̈ − (h+r) α̇²) with |s α̈| < 0.4 m/s² and |2 ṡ α̇| < 0.1 m/s² stays within 6 % of m g.
    assert health.normal_force_min > 0.94 * PAPER.mass * PAPER.gravity
    # What the chord velocities leave is of third order in dt: α̈ ṡ dt³ = 1e-10 m a step, times 5 steps of contact_erp.
    assert health.height_error_max < 1e-9
    assert health.lateral_offset_max < 1e-8  # the solver's residual: 15 iterations
    assert health.slip_max < 1e-7
    assert health.angle_error_max < 1e-10  # beam inertia 1e6: the ball's torque of 0.5 N m turns it by 5e-13 rad a step


@pytest.mark.parametrize("rig", [PAPER, SMALL], ids=["paper", "small"])
def test_rolling_radius_is_the_declared_one(rig: Rig) -> None:
    """Measure s/φ from the engine's own spin."""
    result = run(rig)
    slope = np.polyfit(result.rolled_angle, result.trajectory.position, 1)[0]
    # The contact opens or closes by no more than 1e-9 m, of r = 7 mm and more.
    assert slope == pytest.approx(rig.rolling_radius, rel=1e-9 / 7e-3)


@pytest.mark.parametrize(
    "force",
    [lambda s, v, a, t: -0.05 * v, lambda s, v, a, t: 0.01 * math.sin(3 * t) - 0.02 * s + 0.05 * a],
    ids=["viscous", "time, place and angle"],
)
def test_extra_force_acts_along_the_beam(force: BallForce) -> None:
    """Apply a force at the ball's centre and follow eq. 14 with it on the right-hand side."""

    def slope(t: float, y: np.ndarray) -> tuple[float, float]:
        angle, rate, turn = beam_states(MOTION, np.array([t]))[0]
        push = PAPER.gravity * math.sin(angle) + y[0] * rate**2 - PAPER.lever * turn
        return y[1], PAPER.rolling_ratio * (push + force(y[0], y[1], angle, t) / PAPER.mass)

    exact = solve_ivp(slope, (0, 10), (0.36, 0.0), "DOP853", STAMPS, rtol=1e-12, atol=1e-12, max_step=0.05)
    # ṡ carried on by half a step is off by 3/8 s⃛ dt² = 0.3 µm/s; c/m K times that, over 10 s, moves the ball by
    # 0.05/0.094 × 0.3e-6 × 10²/2 = 8 µm were it all of one sign, but it swings with a period of 2.9 s: 1 µm.
    assert np.abs(run(force=force).trajectory.position - exact.y[0]).max() < 2e-6


def test_same_input_gives_the_same_bits() -> None:
    """Repeat a run and compare every bit."""
    first, second = run(), run()
    assert np.array_equal(first.trajectory.position, second.trajectory.position)
    assert np.array_equal(first.rolled_angle, second.rolled_angle)
    assert first.health == second.health


@pytest.fixture
def stranger() -> Iterator[int]:
    """Somebody else's physics server in the same process, with settings that Bullet keeps for the whole process."""
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(contactBreakingThreshold=1e-4, contactSlop=1e-3, physicsClientId=client)
    pybullet.setGravity(1.0, 2.0, 3.0, physicsClientId=client)
    yield client
    pybullet.disconnect(client)


def test_second_client_changes_nothing(request: pytest.FixtureRequest) -> None:
    """Run alone and beside another physics server with foreign settings: same bits, and it is left alone."""
    alone = run()
    client = request.getfixturevalue("stranger")
    assert np.array_equal(run().trajectory.position, alone.trajectory.position)
    assert pybullet.getConnectionInfo(client)["isConnected"]
    assert pybullet.getNumBodies(client) == 0


def test_an_engine_that_ran_before_runs_the_same() -> None:
    """Give the same bits after runs of another rig with other settings, and after a failure."""
    engine, stamps = PyBullet(), STAMPS[:200]
    alone = run(stamps=stamps)
    engine.run(SMALL, MOTION, START, stamps, parameters=PyBulletParameters(linear_damping=0.1, solver_iterations=30))
    with pytest.raises(EngineFailure):
        engine.run(PAPER, MOTION, State(25.0, 0.0), STAMPS)
    again = engine.run(PAPER, MOTION, START, stamps)
    assert np.array_equal(again.trajectory.position, alone.trajectory.position)
    assert np.array_equal(again.rolled_angle, alone.rolled_angle)
    assert again.health == alone.health


def test_an_engine_takes_its_client_with_it() -> None:
    """Leave no physics server behind, neither after a run nor after a failure."""
    gc.collect()
    first = pybullet.connect(pybullet.DIRECT)
    pybullet.disconnect(first)
    run(stamps=STAMPS[:20])
    failure_of(start=State(25.0, 0.0))
    gc.collect()  # the failure's traceback holds on to the engine
    again = pybullet.connect(pybullet.DIRECT)
    pybullet.disconnect(again)
    assert again == first


def test_bullets_default_damping_costs_millimetres() -> None:
    """Set both dampings to Bullet's own 0.04 and lose the accuracy: why they are zero here."""
    # v is damped by 4 % a second; with |ṡ| of 0.1 m/s over 10 s that is 0.04 × 0.1 × 10²/2 = 0.2 m, all of one sign.
    assert error_of(run(linear_damping=0.04, angular_damping=0.04)) > 1e-3


def test_ball_may_spin_faster_than_bullets_speed_limit() -> None:
    """Let the ball run to 2 m/s, 170 rad/s: Bullet's own limit of 100 rad/s is lifted."""
    stamps = np.linspace(0.0, 4.0, 41)
    result = PyBullet().run(PAPER, Fixed(0.07), START, stamps)
    uniform = START.position + 0.5 * PAPER.rolling_ratio * PAPER.gravity * math.sin(0.07) * stamps**2
    assert result.trajectory.velocity[-1] / PAPER.rolling_radius > 150
    # Leapfrog is exact under a constant acceleration; the rest is the solver's residual.
    assert np.abs(result.trajectory.position - uniform).max() < 1e-7


def test_ball_at_rest_stays() -> None:
    """Leave the ball on a level beam."""
    result = PyBullet().run(PAPER, Fixed(), START, STAMPS)
    assert np.abs(result.trajectory.position - START.position).max() < 1e-9


def test_friction_is_the_product_of_both() -> None:
    """Slide when the product is too small, roll when it is not, whoever of the two is slippery."""
    # Rolling needs F_t = J/(m r²) K m g sin α; the edges give μ N R/r: at 0.05 rad μ > 0.0124.
    stamps, tilt = np.linspace(0.0, 1.0, 11), Fixed(0.05)
    for ball, rail in ((0.1, 0.05), (0.05, 0.1)):
        call = {"motion": tilt, "time": stamps, "parameters": PyBulletParameters(
            lateral_friction_ball=ball, lateral_friction_rail=rail)}  # fmt: skip
        assert failure_of(**call).failure is Failure.SLIPPED
    rolling = PyBulletParameters(lateral_friction_ball=0.2, lateral_friction_rail=0.1)
    assert PyBullet().run(PAPER, tilt, START, stamps, parameters=rolling).health.slip_max < 1e-4


def test_light_slip_is_a_figure_of_health() -> None:
    """Let the ball slide on purpose with a raised limit, and find the slip of Coulomb's law."""
    tilt, friction, stamps = 0.05, 0.01, np.linspace(0.0, 0.5, 51)
    slippery = PyBulletParameters(lateral_friction_ball=1.0, lateral_friction_rail=friction, slip_limit=1.0)
    result = PyBullet().run(PAPER, Fixed(tilt), START, stamps, parameters=slippery)
    assert 1e-3 < result.health.slip_max < 1.0
    # F_t = μ N R/r brakes the ball and turns it: s̈ = g sin α − F_t/m, φ̈ = F_t r/J.
    # Friction across the groove needs none of the cone, for the ball turns about y only; 1 % for the first landing.
    along = friction * PAPER.gravity * math.cos(tilt) * PAPER.radius / PAPER.rolling_radius
    expected = START.position + 0.5 * (PAPER.gravity * math.sin(tilt) - along) * stamps[-1] ** 2
    assert result.trajectory.position[-1] == pytest.approx(expected, rel=0.01)
    spin = 0.5 * along * PAPER.mass * PAPER.rolling_radius / PAPER.inertia * stamps[-1] ** 2
    assert result.rolled_angle[-1] == pytest.approx(spin, rel=0.01)


def test_ball_on_a_fast_seesaw_leaves_the_groove() -> None:
    """Throw the ball off with a beam that accelerates away faster than g."""
    failure = failure_of(motion=Sines(((0.1, 12.6, 0.0),)), time=np.linspace(0.0, 3.0, 31))
    assert failure.failure is Failure.LIFTED_OFF
    assert 0.0 < failure.time < 3.0


# A beam that snaps by 2.3° within about 40 ms at t = 0.5 s, so hard that the ball flies for a moment.
SNAP = ClosedForm(
    lambda time: 0.02 * np.tanh((time - 0.5) / 0.02),
    lambda time: 1.0 / np.cosh((time - 0.5) / 0.02) ** 2,
    lambda time: -2.0 / np.cosh((time - 0.5) / 0.02) ** 2 * np.tanh((time - 0.5) / 0.02) / 0.02,
)


def test_short_flight_is_told() -> None:
    """Notice a ball that lifts off for a moment and lands in the groove again."""
    # N < 0 where s α̈ > g: 0.36 m × 0.77 × 50 rad/s² = 14 m/s², from about 0.02 s before the middle of the snap on.
    failure = failure_of(motion=SNAP, time=np.linspace(0.0, 1.0, 11))
    assert failure.failure is Failure.LIFTED_OFF
    assert 0.45 < failure.time < 0.55


def test_ball_past_the_rails_ran_off() -> None:
    """Let a ball run off the end, and let one start beyond it."""
    assert failure_of(motion=Fixed(0.09)).failure is Failure.RAN_OFF
    assert failure_of(start=State(25.0, 0.0)).failure is Failure.RAN_OFF


def test_nan_force_is_named() -> None:
    """Stop at a force that is not a number, at its time."""
    failure = failure_of(force=lambda s, v, a, t: math.nan if t > 1.0 else 0.0)
    assert failure.failure is Failure.NOT_FINITE
    assert failure.time == pytest.approx(1.0, abs=2e-3)


def test_exploding_state_is_named(capfd: pytest.CaptureFixture[str]) -> None:
    """Stop when the state overflows, and keep Bullet from writing into the standard output."""
    failure = failure_of(force=lambda s, v, a, t: 1e307 if t > 1.0 else 0.0)
    assert failure.failure in (Failure.NOT_FINITE, Failure.RAN_OFF)
    assert capfd.readouterr().out == ""


def test_frozen_engine_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Notice an engine that stops stepping while the beam turns."""
    step, calls = pybullet.stepSimulation, iter(range(10**6))
    monkeypatch.setattr(pybullet, "stepSimulation", lambda client: step(client) if next(calls) < 100 else None)
    failure = failure_of()
    assert failure.failure is Failure.FROZEN
    assert failure.time == pytest.approx(0.1, abs=0.011)  # looked at every 10 ms


def test_small_breaking_threshold_is_an_extra_contact() -> None:
    """Notice the stale contact points that a small threshold leaves behind; they would cost millimetres in silence."""
    failure = failure_of(parameters=PyBulletParameters(contact_breaking_threshold=1e-3))
    assert failure.failure is Failure.EXTRA_CONTACT


def test_soft_contact_lets_the_ball_sink() -> None:
    """Let the ball sink by m g/(2 k cos² θ) into soft contacts, and refuse where it hangs a tenth of r too low."""
    stiffness = 2e4
    soft = PyBulletParameters(contact_stiffness=stiffness, contact_damping=20.0)
    health = PyBullet().run(PAPER, Fixed(), START, STAMPS[:200], parameters=soft).health
    lean = math.cos(PAPER.contact_angle)
    # Landing from h + r overshoots: between once and twice the sag at rest.
    assert 1.0 < health.height_error_max / (PAPER.mass * PAPER.gravity / (2 * stiffness * lean**2)) < 2.0
    mush = PyBulletParameters(contact_stiffness=50.0, contact_damping=1.0)
    assert failure_of(parameters=mush).failure is Failure.LEFT_GROOVE


def test_slow_drive_leaves_the_ball_on_eq_14() -> None:
    """Turn the beam at a constant rate, far enough to see s α̇² at work."""
    motion, stamps = Ramp(0.05), np.linspace(0.0, 5.0, 51)
    exact = reference(CAM, PAPER, motion, State(0.2, -0.1), stamps)
    result = PyBullet().run(PAPER, motion, State(0.2, -0.1), stamps)
    # 6 m of travel at up to 3 m/s. α̇ is constant, so s⃛ <= K g α̇ = 0.4 m/s³ lasts for all 5 s:
    # 0.4/12 × 1e-6 × 5²/2 = 0.4 µm, and twice that is allowed.
    assert np.abs(result.trajectory.position - exact.position).max() < 0.8e-6


def test_bad_input_is_refused() -> None:
    """Refuse stamps that do not increase, a motion that is not finite, and half a soft contact."""
    with pytest.raises(InputError, match="strictly increasing"):
        run(stamps=np.array([0.0, 1.0, 1.0]))
    with pytest.raises(InputError, match=r"not finite at t = 0\.000 s"):
        PyBullet().run(PAPER, Fixed(math.nan), START, STAMPS)
    with pytest.raises(ValidationError, match="together"):
        PyBulletParameters(contact_stiffness=1e4)


def test_every_setting_says_its_unit_and_bounds() -> None:
    """Describe every setting with a unit in brackets."""
    for name, field in PyBulletParameters.model_fields.items():
        assert "[" in (field.description or ""), name
        assert field.metadata, f"{name} has no bounds"
