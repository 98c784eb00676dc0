"""Exported scenes in MuJoCo and PyBullet: they load, and what they carry moves the ball as injected effects do."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import mujoco
import numpy as np
import pybullet
import pytest

from analytic.effects import CATALOGUE, Acting, acting, rig_with
from analytic.motion import FloatArray, State
from analytic.quintic import QuinticMotion
from analytic.rig import Rig
from harness.engines.catalogue import engine_of
from harness.engines.injection import engine_settings, force_of
from harness.exports.beam import beam_range, beam_told
from harness.exports.carried import in_scene, scene_effects
from harness.exports.model import of_effects
from harness.exports.scenes import BALL_FILE, BEAM_FILE, LOADER_FILE, MJCF_FILE, mjcf_files, scene_rig, urdf_files
from mjcf.scene import BALL_START, TIME_STEP
from tests.exports.exported import effect

RIG = Rig()
LEVEL = acting("level_error", {"angle": 0.01})
STEEP = acting("level_error", {"angle": 0.06})
SETS = {
    "level": (LEVEL,),
    "level of two": (LEVEL, acting("level_error", {"angle": -0.004})),
    "radius": (LEVEL, effect("rolling_radius")),
    "slip": (STEEP, effect("contact_slip")),
    "mixed": (LEVEL, effect("viscous_damping"), effect("angle_lag")),
}
SECONDS = 0.8  # the ball stays on the track of 0.65 m


def injected(engine: str, effects: tuple[Acting, ...], start: float) -> FloatArray:
    """Positions at every step on a level beam in our own engine, with the effects injected [m]."""
    time = np.arange(0.0, SECONDS + 0.5 * TIME_STEP, TIME_STEP)
    still = QuinticMotion(time, np.zeros((len(time), 3)))
    rig, runner = rig_with(RIG, effects), engine_of(engine)
    settings = runner.parameters(time_step=TIME_STEP, **engine_settings(effects, engine))
    force = force_of(effects, rig, still, time, TIME_STEP)
    return runner.run(
        rig, still, State(start, 0.0), time, parameters=settings, force=force, base=RIG
    ).trajectory.position


def loaded_loader(files: dict[str, str], folder: Path) -> ModuleType:
    """The exported loader, beside its files in `folder`."""
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("exported_loader", folder / LOADER_FILE)
    assert spec is not None
    assert spec.loader is not None
    loader = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loader)
    return loader


def tolerance(moved: FloatArray) -> float:
    """By which a run from rest may differ.

    Both engines step velocity before position, s = a dt² n (n + 1)/2, which our own begins half a step earlier: the
    difference is a t dt/2 = s dt/t. 5 µm beside it is an engine's validated error.
    """
    return float(abs(moved[-1] - moved[0])) * TIME_STEP / SECONDS + 5e-6


@pytest.mark.parametrize("which", SETS)
def test_mjcf_moves_the_ball_as_the_injected_effects(which: str) -> None:
    """Load the scene as any user does, and compare a run on the level beam with our engine's."""
    model = of_effects(RIG, SETS[which])
    loaded = mujoco.MjModel.from_xml_string(mjcf_files(model)[MJCF_FILE])
    data, places = mujoco.MjData(loaded), []
    for _ in range(round(SECONDS / TIME_STEP) + 1):
        places.append(float(data.body("ball").xpos[0]) if places else BALL_START)
        mujoco.mj_step(loaded, data)
        mujoco.mj_kinematics(loaded, data)
    expected = injected("mujoco", scene_effects(model, slips=True), BALL_START)
    assert abs(expected[-1] - expected[0]) > 1e-2  # it has something to say
    np.testing.assert_allclose(places, expected, atol=tolerance(expected))


@pytest.mark.parametrize("which", ["level", "level of two", "radius", "mixed"])
def test_urdf_moves_the_ball_as_the_injected_effects(which: str, tmp_path: Path) -> None:
    """Load the files by the loader beside them, and compare a run on the level beam with our engine's."""
    model = of_effects(RIG, SETS[which])
    loader = loaded_loader(urdf_files(model), tmp_path)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        _, ball = loader.load(client, BALL_START)
        places = []
        for _ in range(round(SECONDS / TIME_STEP) + 1):
            places.append(pybullet.getBasePositionAndOrientation(ball, client)[0][0])
            pybullet.stepSimulation(client)
    finally:
        pybullet.disconnect(client)
    expected = injected("pybullet", scene_effects(model, slips=False), BALL_START)
    assert abs(expected[-1] - expected[0]) > 1e-2
    np.testing.assert_allclose(places, expected, atol=tolerance(expected))


def test_a_pivot_that_was_estimated_is_where_the_scene_has_it() -> None:
    """Place the beam's joint by the eccentricity found beside the effects, not by the one that the rig began with."""
    model = of_effects(RIG, [acting("eccentric_pivot", {"eccentricity": 0.012})])
    for slips in (True, False):
        assert scene_rig(model, slips=slips) == RIG.with_(eccentricity=0.012)


@pytest.mark.parametrize("name", CATALOGUE)
def test_no_effect_is_dropped_silently(name: str) -> None:
    """Change the scene for every effect that is said to be carried, and for no other; say why for the rest."""
    model, bare = of_effects(RIG, [effect(name)]), of_effects(RIG, [])
    for files, slips in ((mjcf_files, True), (urdf_files, False)):
        (told,) = in_scene(model, slips=slips)
        assert told.name == name
        assert len(told.how) > 10
        differs = files(model) != files(bare)
        # The mean of levels that differ between recordings is 0 until the user writes one in.
        assert differs == (told.carried and name != "level_per_recording")


@pytest.mark.parametrize(
    ("visited", "reach", "start"),
    [
        (None, (-0.65, 0.65), BALL_START),
        ((-0.38, 0.1), (-0.86, 0.58), -0.14),
        ((0.2, 0.45), (-0.05, 0.7), BALL_START),
        ((0.3, 0.3), (-0.05, 0.35), 0.3),
    ],
)
def test_beam_carries_the_ball_where_it_was_recorded(
    visited: tuple[float, float] | None, reach: tuple[float, float], start: float, tmp_path: Path
) -> None:
    """Let the ball lie at both ends of what was recorded, and begin on the beam, in MuJoCo and PyBullet."""
    model = replace(of_effects(RIG, []), visited=visited)
    assert beam_range(model) == pytest.approx(reach)
    assert f"from {reach[0]:.2f} to {reach[1]:.2f} m" in beam_told(model)
    loaded = mujoco.MjModel.from_xml_string(mjcf_files(model)[MJCF_FILE])
    client = pybullet.connect(pybullet.DIRECT)
    try:
        for at in (start, *(visited or reach)):
            at = min(max(at, reach[0] + 0.02), reach[1] - 0.02)
            data = mujoco.MjData(loaded)
            assert data.qpos[1] == start
            data.qpos[1] = at
            mujoco.mj_step(loaded, data, 100)
            assert data.qpos[3] == pytest.approx(RIG.eccentricity + RIG.rolling_radius, abs=1e-4)
            pybullet.resetSimulation(client)
            loader = loaded_loader(urdf_files(model), tmp_path)
            _, ball = loader.load(client, at)
            for _ in range(100):
                pybullet.stepSimulation(client)
            height = pybullet.getBasePositionAndOrientation(ball, client)[0][2]
            assert height == pytest.approx(RIG.eccentricity + RIG.rolling_radius, abs=1e-4)
            assert loader.load.__defaults__ == (start,)
    finally:
        pybullet.disconnect(client)


def test_level_is_in_the_gravity() -> None:
    """Add up the rig's own level and the effect's."""
    rig = scene_rig(of_effects(RIG.with_(level_angle=0.002), [LEVEL]), slips=True)
    assert rig.level_angle == pytest.approx(0.012, abs=1e-15)
    assert set(urdf_files(of_effects(RIG, []))) == {BEAM_FILE, BALL_FILE, LOADER_FILE}
