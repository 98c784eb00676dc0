"""DART follows eq. 14 as a third, independent engine."""

from __future__ import annotations

import importlib
import math
import sys

import numpy as np
import pytest

from analytic.models import CAM
from analytic.motion import BallForce, BeamMotion, State
from analytic.rig import Rig
from harness.engines.dart import Dart, DartParameters
from harness.engines.health import Failure
from harness.engines.protocol import EngineRun
from harness.errors import EngineFailure, InputError
from tests.motions import ClosedForm, Fixed, Sines
from tests.reference import reference


def dart_loads() -> bool:
    """Whether dartpy is installed and finds the system's libraries; its wheel leaves out libGL."""
    try:
        importlib.import_module("dartpy")
    except ImportError:
        return False
    return True


needs_dart = pytest.mark.skipif(not dart_loads(), reason="dartpy is not installed or does not load")

PAPER = Rig()
SMALL = Rig(radius=0.01, rolling_radius=0.007, inertia=2.84e-6)
MOTION = Sines(((0.038, 2.2, 0.5 * math.pi), (0.014, 5.7, 0.7)))
START = State(0.36, 0.0)
STAMPS = np.linspace(0.0, 10.0, 1001)


def run(
    rig: Rig = PAPER, *, motion: BeamMotion = MOTION, force: BallForce | None = None, **settings: float
) -> EngineRun:
    """Drive the two-sine motion."""
    return Dart().run(rig, motion, START, STAMPS, parameters=DartParameters(**settings), force=force)


def error_of(result: EngineRun, rig: Rig = PAPER) -> float:
    """max |s − s of eq. 14| [m]."""
    exact = reference(CAM, rig, MOTION, START, STAMPS)
    return float(np.abs(result.trajectory.position - exact.position).max())


# Second order as in PyBullet (0.5 µm at 1 ms), and a contact that overlaps by 0.03 g dt² = 0.3 µm: were the whole
# overlap missing in r, s/φ would be off by 2.5e-5, 9 µm in 0.36 m. It is balanced to a tenth.
@pytest.mark.slow
@needs_dart
@pytest.mark.parametrize("rig", [PAPER, PAPER.with_(level_angle=-0.0028), SMALL], ids=["paper", "tilted", "small"])
def test_position_agrees_with_eq_14(rig: Rig) -> None:
    """Stay within micrometres of the reference solution over 10 s, also off level and on another rig."""
    result = run(rig)
    assert error_of(result, rig) < 1.5e-6
    assert np.polyfit(result.rolled_angle, result.trajectory.position, 1)[0] == pytest.approx(
        rig.rolling_radius, rel=2.5e-6
    )


@pytest.mark.slow
@needs_dart
def test_small_steps_reach_nanometres() -> None:
    """Step at 0.1 ms and be a hundred times as exact as at 1 ms."""
    assert error_of(run(time_step=1e-4)) < 0.02e-6


@pytest.mark.slow
@needs_dart
def test_error_is_of_second_order() -> None:
    """Fit the slope of log error over log dt."""
    steps = np.array([4e-3, 2e-3, 1e-3, 5e-4])
    slope = np.polyfit(np.log(steps), np.log([error_of(run(time_step=step)) for step in steps]), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.2)  # as in test_pybullet


@needs_dart
def test_two_contacts_in_every_step() -> None:
    """Look at every step: the overlap keeps both contacts closed, and the beam is where it was told to be."""
    health = run(health_interval=0.0).health
    assert (health.contacts_min, health.contacts_max) == (2, 2)
    assert health.height_error_max < 0.03 * PAPER.gravity * 1e-6  # the overlap itself
    assert health.angle_error_max < 1e-15  # a VELOCITY joint is exact but for rounding


@needs_dart
def test_ball_at_rest_wakes_up() -> None:
    """Keep the ball at rest for longer than DART's sleep timer, then tilt: it rolls as from the start."""
    late = ClosedForm(
        lambda time: 0.02 * np.maximum(time - 2.0, 0.0) ** 3,
        lambda time: 0.06 * np.maximum(time - 2.0, 0.0) ** 2,
        lambda time: 0.12 * np.maximum(time - 2.0, 0.0),
    )
    stamps = np.linspace(0.0, 3.0, 31)
    exact = reference(CAM, PAPER, late, START, stamps)
    result = Dart().run(PAPER, late, START, stamps)
    assert abs(exact.position[-1] - START.position) > 1e-3
    assert np.abs(result.trajectory.position - exact.position).max() < 1.5e-6


@needs_dart
def test_extra_force_brakes_as_in_eq_14() -> None:
    """Hold the ball against gravity with a force at its centre, then let viscous friction brake it to e^(−K c t/m)."""
    tilt, weight = 0.03, PAPER.mass * PAPER.gravity * math.sin(0.03)
    held = run(motion=Fixed(tilt), force=lambda s, v, a, t: -weight)
    assert np.abs(held.trajectory.position - START.position).max() < 1e-6
    rate = PAPER.rolling_ratio * 0.05 / PAPER.mass
    braked = Dart().run(PAPER, Fixed(), State(0.36, 0.1), STAMPS, force=lambda s, v, a, t: -0.05 * v)
    expected = 0.36 + 0.1 * (1 - np.exp(-rate * STAMPS)) / rate
    # ṡ at t_n is carried on: an error of 3/8 s⃛ dt² at most, 0.1 rate² × 3/8e-6 = 1e-8 m/s, decaying with the rate.
    assert np.abs(braked.trajectory.position - expected).max() < 1e-6


@needs_dart
def test_same_input_gives_the_same_bits() -> None:
    """Repeat a run and compare every bit."""
    assert np.array_equal(run().trajectory.position, run().trajectory.position)


@needs_dart
@pytest.mark.parametrize(
    ("motion", "settings", "force", "failure"),
    [
        (Sines(((0.1, 12.6, 0.0),)), {}, None, Failure.LIFTED_OFF),
        (Fixed(0.09), {}, None, Failure.RAN_OFF),
        (MOTION, {"friction": 0.005}, None, Failure.SLIPPED),
        (MOTION, {}, lambda s, v, a, t: math.nan, Failure.NOT_FINITE),
        (MOTION, {"time_step": 0.02}, None, Failure.EXTRA_CONTACT),
    ],
    ids=["thrown", "ran off", "slippery", "nan force", "stale contacts at 20 ms"],
)
def test_bad_run_fails_by_name(
    motion: BeamMotion, settings: dict[str, float], force: BallForce | None, failure: Failure
) -> None:
    """Provoke each failure and find it named."""
    with pytest.raises(EngineFailure) as caught:
        run(motion=motion, force=force, **settings)
    assert caught.value.failure is failure


def test_missing_package_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take dartpy away and read what to do."""
    monkeypatch.setitem(sys.modules, "dartpy", None)
    with pytest.raises(InputError, match=r"pip install '\.\[dart\]'"):
        run()
    with pytest.raises(InputError, match="not installed"):
        Dart().version()
