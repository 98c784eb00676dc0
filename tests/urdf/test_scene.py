"""The URDF is the rig: contacts, mass and drawing as declared, files as made."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pybullet
import pytest

from analytic.geometry import to_beam, to_world
from analytic.rig import Rig
from urdf.scene import BALL_FILE, BEAM_FILE, ball_urdf, beam_urdf, rail_axis, write

SMALL = Rig(radius=0.01, rolling_radius=0.007, inertia=2.84e-6, eccentricity=-0.02)


@pytest.fixture
def client() -> Iterator[int]:
    """A physics server."""
    number = pybullet.connect(pybullet.DIRECT)
    yield number
    pybullet.disconnect(number)


def load(client: int, beam_file: Path, ball_file: Path, rig: Rig, angle: float) -> tuple[int, int]:
    """Beam at α [rad] and ball at s = 0.3 m."""
    beam = pybullet.loadURDF(str(beam_file), useFixedBase=True, physicsClientId=client)
    ball = pybullet.loadURDF(str(ball_file), flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
    pybullet.resetJointState(beam, 0, angle, physicsClientId=client)
    centre = to_world(0.3, 0.0, rig.eccentricity + rig.rolling_radius, angle)
    pybullet.resetBasePositionAndOrientation(ball, centre, (0, 0, 0, 1), physicsClientId=client)
    return beam, ball


def test_committed_files_are_those_of_the_papers_rig() -> None:
    """Compare the committed files with what is made for the paper's rig."""
    assert BEAM_FILE.read_text(encoding="utf-8") == beam_urdf(Rig())
    assert BALL_FILE.read_text(encoding="utf-8") == ball_urdf(Rig())


@pytest.mark.parametrize("rig", [Rig(), SMALL], ids=["paper", "small"])
@pytest.mark.parametrize("angle", [0.0, 0.06])
def test_ball_touches_the_two_edges(client: int, tmp_path: Path, rig: Rig, angle: float) -> None:
    """Find exactly two contacts, on the sharp edges, with the normals of the groove."""
    beam, ball = load(client, *write(tmp_path, rig), rig, angle)
    pybullet.performCollisionDetection(physicsClientId=client)
    contacts = pybullet.getContactPoints(ball, beam, physicsClientId=client)
    assert len(contacts) == 2
    for contact, side in zip(sorted(contacts, key=lambda point: point[6][1]), (-1.0, 1.0), strict=True):
        # The file carries 15 digits of lengths below 1 m: 1e-15 m, and a few roundings of the collision code.
        assert contact[8] == pytest.approx(0.0, abs=1e-13)
        edge = to_beam(*contact[6], angle)
        assert edge == pytest.approx((0.3, side * rig.half_gap, rig.eccentricity), abs=1e-13)
        normal = to_beam(*contact[7], angle)
        lean = (0.0, -side * math.sin(rig.contact_angle), math.cos(rig.contact_angle))
        assert normal == pytest.approx(lean, abs=1e-11)  # 1e-13 m over the distance R + ρ of 11 mm


def test_another_reader_puts_the_ball_on_a_flat_rail() -> None:
    """Read the beam of a flat rail in MuJoCo and find one contact, straight below the ball between the guards."""
    rig = Rig(rolling_radius=Rig.radius)
    spec = mujoco.MjSpec.from_string(beam_urdf(rig))
    ball = spec.worldbody.add_body(pos=(0.3, 0.0, rig.eccentricity + rig.rolling_radius), mass=rig.mass)
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(rig.radius, 0.0, 0.0), margin=1e-9)
    data = mujoco.MjData(model := spec.compile())
    mujoco.mj_forward(model, data)
    (contact,) = data.contact
    assert contact.dist == pytest.approx(0.0, abs=1e-13)
    assert contact.pos == pytest.approx((0.3, 0.0, rig.eccentricity), abs=1e-13)
    assert np.abs(contact.frame[:3]) == pytest.approx((0.0, 0.0, 1.0), abs=1e-12)


@pytest.mark.parametrize("angle", [0.0, 0.06])
def test_driven_flat_rail_is_a_plane(client: int, tmp_path: Path, angle: float) -> None:
    """Load what the engine steps and find one contact, the normal exactly that of the plane."""
    rig = Rig(rolling_radius=Rig.radius)
    beam_file, ball_file = tmp_path / "beam.urdf", tmp_path / "ball.urdf"
    beam_file.write_text(beam_urdf(rig, driven=True), encoding="utf-8")
    ball_file.write_text(ball_urdf(rig), encoding="utf-8")
    beam = pybullet.loadURDF(str(beam_file), useFixedBase=True, physicsClientId=client)
    ball = pybullet.loadURDF(str(ball_file), physicsClientId=client)
    pybullet.resetJointState(beam, 2, angle, physicsClientId=client)
    centre = to_world(0.3, 0.0, rig.eccentricity + rig.rolling_radius, angle)
    pybullet.resetBasePositionAndOrientation(ball, centre, (0, 0, 0, 1), physicsClientId=client)
    pybullet.performCollisionDetection(physicsClientId=client)
    (contact,) = pybullet.getContactPoints(ball, beam, physicsClientId=client)
    assert contact[8] == pytest.approx(0.0, abs=1e-15)
    assert to_beam(*contact[7], angle) == pytest.approx((0.0, 0.0, 1.0), abs=1e-15)


def test_another_reader_finds_the_same_contacts() -> None:
    """Read the committed beam in MuJoCo, put a ball on it, and find the same two contacts."""
    rig = Rig()
    spec = mujoco.MjSpec.from_file(str(BEAM_FILE))
    ball = spec.worldbody.add_body(pos=(0.3, 0.0, rig.eccentricity + rig.rolling_radius), mass=rig.mass)
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(rig.radius, 0.0, 0.0), margin=1e-9)
    data = mujoco.MjData(model := spec.compile())
    mujoco.mj_forward(model, data)
    assert data.ncon == 2
    for contact, side in zip(sorted(data.contact, key=lambda point: point.pos[1]), (-1.0, 1.0), strict=True):
        assert contact.dist == pytest.approx(0.0, abs=1e-13)  # 15 digits in the file, as above
        assert contact.pos == pytest.approx((0.3, side * rig.half_gap, rig.eccentricity), abs=1e-13)


def test_committed_files_roll_as_eq_14_says(client: int) -> None:
    """Let the ball roll for a second with what the README names set, and nothing else."""
    rig, angle, step = Rig(), math.radians(1.0), 1e-3
    beam, ball = load(client, BEAM_FILE, BALL_FILE, rig, angle)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=step, contactSlop=0.0, solverResidualThreshold=0.0, physicsClientId=client
    )
    pybullet.setGravity(0.0, 0.0, -rig.gravity, physicsClientId=client)
    for body in (beam, ball):
        pybullet.changeDynamics(body, -1, linearDamping=0.0, angularDamping=0.0, physicsClientId=client)
    along = rig.rolling_ratio * rig.gravity * math.sin(angle)
    early = -0.5 * step * along  # velocities are those of half a step earlier
    velocity = early * math.cos(angle), 0.0, -early * math.sin(angle)
    pybullet.resetBaseVelocity(ball, velocity, (0.0, early / rig.rolling_radius, 0.0), physicsClientId=client)
    for _ in range(1000):
        pybullet.resetJointState(beam, 0, angle, physicsClientId=client)
        pybullet.stepSimulation(client)
    s, y, z = to_beam(*pybullet.getBasePositionAndOrientation(ball, client)[0], angle)
    # At constant acceleration, staggered velocities are exact: what is left is rounding, 1e-16 m a step and 1000 steps.
    assert s - 0.3 == pytest.approx(0.5 * along, abs=1e-12)
    assert (y, z) == pytest.approx((0.0, rig.eccentricity + rig.rolling_radius), abs=1e-12)


def test_committed_files_load_as_the_rig(client: int) -> None:
    """Load the committed files as they are and find the joint, the mass and the inertia of Table 1."""
    rig = Rig()
    beam, ball = load(client, BEAM_FILE, BALL_FILE, rig, 0.0)
    assert pybullet.getNumJoints(beam, physicsClientId=client) == 1
    joint = pybullet.getJointInfo(beam, 0, physicsClientId=client)
    assert (joint[1], joint[13]) == (b"pivot", (0.0, 1.0, 0.0))
    dynamics = pybullet.getDynamicsInfo(ball, -1, physicsClientId=client)
    assert dynamics[0] == rig.mass
    assert dynamics[2] == (rig.inertia,) * 3


def test_drawing_shows_stand_beam_and_ball(client: int) -> None:
    """Render the committed files and find stand, beam and ball in the picture, the ball above the beam."""
    beam, ball = load(client, BEAM_FILE, BALL_FILE, Rig(), 0.0)
    view = pybullet.computeViewMatrix((0.3, -0.9, 0.05), (0.3, 0.0, -0.05), (0, 0, 1))
    lens = pybullet.computeProjectionMatrixFOV(45, 4 / 3, 0.01, 5)
    renderer, flags = pybullet.ER_TINY_RENDERER, pybullet.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX
    *_, mask = pybullet.getCameraImage(160, 120, view, lens, renderer=renderer, flags=flags, physicsClientId=client)
    seen = np.reshape(mask, (120, 160))

    def rows(body: int, link: int) -> np.ndarray:
        return np.nonzero(seen == body + ((link + 1) << 24))[0]

    stand, channel, sphere = rows(beam, -1), rows(beam, 0), rows(ball, -1)
    assert len(stand) > 100
    assert len(channel) > 100
    assert len(sphere) > 4
    assert sphere.min() < channel.min() < stand.max()  # rows count downwards


def test_rails_keep_the_contact_for_any_depth() -> None:
    """Find the rails' axes at R + depth from the ball's centre, in line with the edge, for every depth."""
    rig = Rig()
    for depth in (1e-4, 1e-3, 1e-2):
        y, z = rail_axis(rig, depth)
        drop = rig.eccentricity + rig.rolling_radius - z
        assert math.hypot(y, drop) == pytest.approx(rig.radius + depth, rel=1e-14)
        assert math.atan2(y, drop) == pytest.approx(rig.contact_angle, rel=1e-12)


def test_view_snippet_of_the_readme_runs() -> None:
    """Run the snippet of the README without a window and without waiting; in a process of its own, as it takes the
    first physics server for its own."""
    text = Path(BEAM_FILE.parent, "README.md").read_text(encoding="utf-8")
    (snippet,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    before = "import time, pybullet\ntime.sleep, pybullet.GUI = lambda _: None, pybullet.DIRECT\n"
    after = "\nprint(*pybullet.getBasePositionAndOrientation(ball)[0])\n"
    command = [sys.executable, "-c", before + snippet + after]
    done = subprocess.run(command, cwd=BEAM_FILE.parents[1], capture_output=True, text=True, check=True)
    x, _, z = map(float, done.stdout.split()[-3:])
    rig = Rig()
    assert math.hypot(x, z) == pytest.approx(math.hypot(0.36, rig.eccentricity + rig.rolling_radius), rel=1e-12)
