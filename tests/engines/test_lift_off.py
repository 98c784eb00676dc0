"""Where the beam falls away faster than the ball, every source says so in the same words at the same instant."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.kernel import simulate
from analytic.lift_off import first_lift_off, normal_acceleration
from analytic.models import CAM
from analytic.motion import BeamMotion, FloatArray, State, beam_states
from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.health import Failure
from harness.engines.protocol import Engine
from harness.errors import EngineFailure
from harness.scene import Scene
from tests.engines.test_dart import needs_dart
from tests.motions import ClosedForm, Fixed, Sines
from tests.own_scenes import grooved_urdf, scene_in, write_mesh_rails

START = State(0.36, 0.0)
STEP = 1e-3  # of every engine [s]
TIME = np.linspace(0.0, 1.5, 151)
# A seesaw of 0.1 rad at 2 Hz: s α̈ reaches 0.36 m × 15.9 rad/s² and then, as the ball rolls outwards, g.
SEESAW = Sines(((0.1, 12.6, 0.0),))
SNAP = ClosedForm(
    lambda time: 0.02 * np.tanh((time - 0.5) / 0.02),
    lambda time: 1.0 / np.cosh((time - 0.5) / 0.02) ** 2,
    lambda time: -2.0 / np.cosh((time - 0.5) / 0.02) ** 2 * np.tanh((time - 0.5) / 0.02) / 0.02,
)


def own(name: str, folder: Path) -> Scene:
    """A user's scene of the paper's rig for an engine."""
    if name == "mujoco":
        return write_mesh_rails(folder, Rig())
    (folder / "bars.urdf").write_text(grooved_urdf(Rig()), encoding="utf-8")
    return scene_in(folder, urdf="bars.urdf", beam_joint="swing")


def engine_called(name: str, folder: Path) -> Engine:  # type: ignore[type-arg]
    """An engine, with a user's scene if its name says so."""
    kind, _, scene = name.partition(" ")
    return engine_of(kind, own(kind, folder) if scene else None)


def instant(motion: BeamMotion) -> float:
    """When the normal force on a ball that moves as CAM says falls below zero [s]."""
    time = np.arange(0.0, TIME[-1], 0.1 * STEP)
    path = simulate([CAM], Rig(), motion, START, time)[0]
    found = first_lift_off(path.position, path.velocity, beam_states(motion, time), Rig())
    assert found is not None
    return float(time[found])


@pytest.mark.parametrize("motion", [SEESAW, SNAP], ids=["seesaw", "snap"])
@pytest.mark.parametrize(
    "name", ["mujoco", "pybullet", pytest.param("dart", marks=needs_dart), "mujoco scene", "pybullet scene"]
)
def test_every_engine_says_that_the_ball_lifts_off(name: str, motion: BeamMotion, tmp_path: Path) -> None:
    """Lift the ball off and read the same words, within a step of the instant that eq. 14 gives."""
    engine = engine_called(name, tmp_path)
    # A URDF without <contact> has the friction 0.5 × 0.5 in Bullet, at which the ball slides before it lifts off.
    settings = {"lateral_friction_ball": 1.0} if name == "pybullet scene" else {}
    with pytest.raises(EngineFailure) as caught:
        engine.run(Rig(), motion, START, TIME, parameters=parameters_of(engine, settings))
    assert caught.value.failure is Failure.LIFTED_OFF
    assert str(caught.value).endswith(Failure.LIFTED_OFF.value)
    assert not any(word in str(caught.value) for word in ("stiff", "time step", "friction"))
    assert abs(caught.value.time - instant(motion)) <= STEP


def test_normal_force_on_a_beam_at_rest_is_the_weight() -> None:
    """Find m g cos(α + α₀) on a beam that stands still."""
    rig, time = Rig(level_angle=0.01), np.zeros(3)
    beam = beam_states(Fixed(0.05), time)
    at: FloatArray = np.array([-0.5, 0.0, 0.5])
    # Rounding only: eight operations at 1e-16.
    assert normal_acceleration(at, at, beam, rig) == pytest.approx(rig.gravity * np.cos(0.06), rel=1e-14)
    assert first_lift_off(at, at, beam, rig) is None
