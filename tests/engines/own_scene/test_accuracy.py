"""Scenes of another style follow eq. 14: mesh rails, other names and frames, a flat track, a beam behind a crank."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from analytic.models import CAM
from analytic.motion import State
from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.health import Failure
from harness.errors import EngineFailure
from harness.scene import Scene
from tests.motions import Sines
from tests.own_scenes import (
    FLAT,
    crank_and_link,
    flat_track,
    grooved_urdf,
    plank_urdf,
    scene_in,
    write_mesh_rails,
    written,
)
from tests.reference import reference

MOTION, START = Sines(), State(0.36, 0.0)
TIME = np.linspace(0.0, 3.0, 301)
PAPER = Rig()


def plank(folder: Path) -> Scene:
    """A plank along the world's y axis."""
    return written(folder, flat_track(), beam_joint="bearing", ball="marble")


def plank_other_way(folder: Path) -> Scene:
    """The same plank, α counted the other way round, hence s too."""
    return written(folder, flat_track(), beam_joint="bearing", ball="marble", direction=-1)


def crank(folder: Path) -> Scene:
    """A groove behind a crank and a link."""
    return written(folder, crank_and_link(PAPER), beam_joint="beam_hinge", driven_joint="motor")


def plank_in_bullet(folder: Path) -> Scene:
    """A plane on a hinge that turns against α."""
    (folder / "plank.urdf").write_text(plank_urdf(FLAT), encoding="utf-8")
    return scene_in(folder, urdf="plank.urdf", beam_joint="bearing", direction=-1)


def bars_in_bullet(folder: Path) -> Scene:
    """Two square bars."""
    (folder / "bars.urdf").write_text(grooved_urdf(PAPER), encoding="utf-8")
    return scene_in(folder, urdf="bars.urdf", beam_joint="swing")


# Where the scene's ball rolls at r (1 + ε), K and the lever are off by at most ε: the height is measured to 1e-9 m, the
# normals with the ball pressed in by 2 µm (ε = 4e-5 in the groove, where the ball rests on leaning contacts, and 0 on a
# plank). The travel is 0.5 m in 3 s, so ε costs at most 20 µm in what is compared; the sinking of a soft contact under
# the changing load, 0.5 µm of r, costs as much again. Behind the crank the link yields by at most 4e-8 rad:
# ½ K g δ t² = 1 µm.
MUJOCO = 20e-6
# PyBullet without the chord is of first order: ½ ∫∫ s α̇² dt lacks, at most 0.9 m × (0.13 rad/s)² × 1 ms × 3 s / 2.
BULLET = 25e-6


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "make", "rig", "tolerance"),
    [
        ("mujoco", plank, FLAT, MUJOCO),
        ("mujoco", plank_other_way, FLAT, MUJOCO),
        ("mujoco", write_mesh_rails, PAPER, MUJOCO),
        ("mujoco", crank, PAPER, MUJOCO),
        ("pybullet", plank_in_bullet, FLAT, BULLET),
        ("pybullet", bars_in_bullet, PAPER, BULLET),
    ],
    ids=["plank", "plank, other way", "mesh rails", "crank and link", "plank, URDF", "bars, URDF"],
)
def test_ball_follows_eq_14(
    tmp_path: Path, engine: str, make: Callable[..., Scene], rig: Rig, tolerance: float
) -> None:
    """Drive the scene with the angle and meet the exact solution."""
    scene = make(tmp_path, rig) if make is write_mesh_rails else make(tmp_path)
    run = engine_of(engine, scene).run(rig, MOTION, START, TIME)
    exact = reference(CAM, rig, MOTION, START, TIME).position
    assert np.abs(run.trajectory.position - exact).max() < tolerance
    # Rolling: the spin belongs to the travel; the wrong r of 4e-5 and the slip of soft friction, 10 µm/s, over 0.5 m.
    assert np.abs(run.rolled_angle * rig.rolling_radius - (run.trajectory.position - START.position)).max() < 60e-6
    assert run.health.angle_error_max < 1e-7


def test_linkage_is_what_moves_the_beam(tmp_path: Path) -> None:
    """See the beam lag behind the recorded angle where the link's constraint is made soft."""
    soft = crank_and_link(PAPER).replace('solref="0.002 1" solimp="0.9999 0.9999 0.001"', 'solref="0.04 1"')
    scene = written(tmp_path, soft, beam_joint="beam_hinge", driven_joint="motor")
    health = engine_of("mujoco", scene).run(PAPER, MOTION, START, TIME[:51]).health
    assert health.angle_error_max > 1e-5
    assert any("linkage lets the beam depart" in warning for warning in health.warnings)


def test_level_angle_tilts_the_scene(tmp_path: Path) -> None:
    """Tilt the base under a level beam and let the ball roll as g sin α₀ asks."""
    time, level = np.linspace(0.0, 1.0, 11), 0.01
    run = engine_of("mujoco", plank(tmp_path)).run(
        FLAT.with_(level_angle=level), Sines(((0.0, 1.0, 0.0),)), START, time
    )
    expected = 0.5 * FLAT.rolling_ratio * FLAT.gravity * np.sin(level)
    # Soft friction yields by some µm/s: 1e-4 of the 33 mm/s at the end.
    assert run.trajectory.position[-1] - START.position == pytest.approx(expected, rel=3e-4)


def test_level_joint_angle_is_where_alpha_is_zero(tmp_path: Path) -> None:
    """Say at which joint angle a plank that is mounted askew is level, and follow eq. 14 as before."""
    askew = flat_track().replace('name="seesaw"', 'name="seesaw" euler="0.05 0 0"')
    scene = written(tmp_path, askew, beam_joint="bearing", ball="marble", level_joint_angle=-0.05)
    engine = engine_of("mujoco", scene)
    assert engine.measured(FLAT).slope == pytest.approx(0.0, abs=1e-7)  # type: ignore[attr-defined]
    run = engine.run(FLAT, MOTION, START, TIME[:101])
    exact = reference(CAM, FLAT, MOTION, START, TIME[:101]).position
    assert np.abs(run.trajectory.position - exact).max() < MUJOCO


def test_force_acts_on_the_ball(tmp_path: Path) -> None:
    """Push the ball along a level plank and see the acceleration K F/m."""
    time, push = np.linspace(0.0, 1.0, 11), 0.01
    still = Sines(((0.0, 1.0, 0.0),))
    for engine, make in (("mujoco", plank), ("pybullet", plank_in_bullet)):
        run = engine_of(engine, make(tmp_path)).run(FLAT, still, START, time, force=lambda s, v, a, t: push)
        expected = 0.5 * FLAT.rolling_ratio * push / FLAT.mass
        assert run.trajectory.position[-1] - START.position == pytest.approx(expected, rel=1e-3)


def test_altered_rig_is_a_force_in_a_scene(tmp_path: Path) -> None:
    """Let an effect change the rolling radius, which the scene keeps, and follow eq. 14 of the altered rig."""
    altered = PAPER.with_(rolling_radius=0.0110)
    scene = write_mesh_rails(tmp_path, PAPER)
    run = engine_of("mujoco", scene).run(altered, MOTION, START, TIME, base=PAPER)
    exact = reference(CAM, altered, MOTION, START, TIME).position
    plain = reference(CAM, PAPER, MOTION, START, TIME).position
    # The force meets velocities that are extrapolated by half a step, and adds to what `MUJOCO` allows.
    assert np.abs(run.trajectory.position - exact).max() < 2 * MUJOCO
    assert np.abs(plain - exact).max() > 20 * MUJOCO


def test_contact_parameters_are_set_in_the_scene(tmp_path: Path) -> None:
    """Take the grip away by --set and see the ball slide."""
    engine = engine_of("mujoco", plank(tmp_path))
    with pytest.raises(EngineFailure) as caught:
        engine.run(FLAT, MOTION, START, TIME, parameters=parameters_of(engine, {"friction": 0.002}))
    assert caught.value.failure is Failure.SLIPPED


def test_end_of_the_users_track_is_named(tmp_path: Path) -> None:
    """Run past the end of a track of 0.5 m."""
    short = flat_track().replace("0.03 2.0 0.005", "0.03 0.5 0.005")
    engine = engine_of("mujoco", written(tmp_path, short, beam_joint="bearing", ball="marble"))
    with pytest.raises(EngineFailure) as caught:
        engine.run(FLAT, MOTION, START, TIME)
    assert caught.value.failure is Failure.RAN_OFF
