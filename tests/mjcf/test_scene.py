from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from analytic.geometry import RAIL_REACH, channel_of
from analytic.rig import Rig
from harness.engines.mujoco_parameters import MuJoCoParameters
from mjcf.scene import ACROSS, BALL_START, SCENE_FILE, default_option, default_pair, make_scene

PAPER = Rig()
FLAT = PAPER.with_(rolling_radius=PAPER.radius)
STEEP = Rig(mass=0.033, inertia=1.32e-6, radius=0.01, rolling_radius=0.007, eccentricity=0.02)  # normals lean 45.6°
RIGS = pytest.mark.parametrize("rig", [PAPER, STEEP], ids=["paper", "steep groove"])


def loaded(rig: Rig, *, driven: bool) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The scene of `rig` with the ball resting on the level beam."""
    model = mujoco.MjModel.from_xml_string(make_scene(rig, driven=driven))
    data = mujoco.MjData(model)
    # As deep as the soft contacts let it sink, give or take: at zero depth a contact may not exist.
    data.joint("ball").qpos[2] -= 1e-8
    mujoco.mj_forward(model, data)
    return model, data


def test_committed_scene_is_the_papers_rig() -> None:
    """Find in the committed file exactly what `python -m mjcf.scene` writes."""
    assert SCENE_FILE.read_text(encoding="utf-8") == make_scene(Rig())


@RIGS
@pytest.mark.parametrize("driven", [False, True])
def test_ball_rests_on_both_edges(rig: Rig, driven: bool) -> None:
    """Touch the ball at two points, under the contact normals that follow from R and r."""
    _, data = loaded(rig, driven=driven)
    assert data.ncon == 2
    normals = sorted(tuple(contact.frame[:3]) for contact in data.contact)
    # MuJoCo's normal points from geom1 (the ball) to geom2 (a rail): down and outwards. The ball was put 1e-8 m too
    # deep, which tilts the normal by 1e-8/R = 1e-6 rad.
    y, z = rig.half_gap / rig.radius, rig.rolling_radius / rig.radius
    np.testing.assert_allclose(normals, [(0.0, -y, -z), (0.0, y, -z)], atol=2e-6)
    if rig is PAPER:
        np.testing.assert_allclose(np.abs(normals[0]), (0.0, 0.448, 0.894), atol=5e-4)  # to the digits published


@RIGS
@pytest.mark.parametrize("angle", [0.0, 0.1])
def test_contacts_lie_on_the_edges_at_any_beam_angle(rig: Rig, angle: float) -> None:
    """Turn beam and ball together and find the contacts on the inner top edges, s and h from the pivot."""
    model, data = loaded(rig, driven=True)
    height = rig.eccentricity + rig.rolling_radius - 1e-8
    cos, sin = math.cos(angle), math.sin(angle)
    data.joint("pivot").qpos[0] = angle
    data.joint("ball").qpos[:3] = 0.2 * cos + height * sin, 0.0, height * cos - 0.2 * sin
    mujoco.mj_forward(model, data)
    assert data.ncon == 2
    for contact in data.contact:
        x, y, z = contact.pos
        # A contact's position is the middle of the overlap: half of 1e-8 m off the edge.
        assert x * cos - z * sin == pytest.approx(0.2, abs=1e-8)
        assert z * cos + x * sin == pytest.approx(rig.eccentricity, abs=1e-8)
        assert abs(y) == pytest.approx(rig.half_gap, abs=1e-8)


@pytest.mark.parametrize("angle", [-0.1, 0.0, 0.1])
def test_first_tangent_lies_across_the_beam(angle: float) -> None:
    """Let the first friction coefficient of the pair be the one across the beam, the second the one along."""
    model, data = loaded(PAPER, driven=True)
    height = PAPER.eccentricity + PAPER.rolling_radius - 1e-8
    data.joint("pivot").qpos[0] = angle
    data.joint("ball").qpos[:3] = height * math.sin(angle), 0.0, height * math.cos(angle)
    mujoco.mj_forward(model, data)
    along = (math.cos(angle), 0.0, -math.sin(angle))
    for contact in data.contact:
        # The axes come from products of unit vectors in double precision.
        assert contact.frame[3:6] @ along == pytest.approx(0.0, abs=1e-12)
        assert abs(contact.frame[6:9] @ along) == pytest.approx(1.0, abs=1e-12)
        assert contact.friction[0] == pytest.approx(ACROSS * 0.5)
        assert contact.friction[1] == pytest.approx(0.5)


def test_ball_has_its_declared_mass_and_inertia() -> None:
    """Take J from the rig, not from the sphere that is drawn."""
    hollow = PAPER.with_(inertia=2 / 3 * PAPER.mass * PAPER.radius**2)
    model, _ = loaded(hollow, driven=True)
    # Numbers are written with 15 digits.
    np.testing.assert_allclose(model.body("ball").inertia, hollow.inertia, rtol=1e-14)
    np.testing.assert_allclose(model.body("ball").mass, hollow.mass, rtol=1e-14)


def test_gravity_is_tilted_by_the_level_angle() -> None:
    """Let gravity act along the level beam as g sin α₀, towards +s for a positive α₀."""
    tilted = PAPER.with_(level_angle=0.01)
    model, _ = loaded(tilted, driven=True)
    expected = (9.81 * math.sin(0.01), 0.0, -9.81 * math.cos(0.01))
    np.testing.assert_allclose(model.opt.gravity, expected, rtol=1e-14)


def test_nothing_but_ball_and_rails_collides() -> None:
    """Keep the drawn parts out of the physics: pairs are explicit, and no geom collides of itself."""
    for driven, others in ((True, set()), (False, {"stop_near", "stop_far"})):
        model, _ = loaded(PAPER, driven=driven)
        assert not model.geom_contype.any()
        assert not model.geom_conaffinity.any()
        touched = {
            model.geom(int(g)).name for pair in zip(model.pair_geom1, model.pair_geom2, strict=True) for g in pair
        }
        assert touched == {"ball", "rail_left", "rail_right"} | others


def test_rails_of_a_driven_run_reach_far() -> None:
    """Give a driven run the channel it asks for: rails over the whole reach, and nothing to draw."""
    channel = channel_of(PAPER, x_from=-RAIL_REACH, x_to=RAIL_REACH)
    model = mujoco.MjModel.from_xml_string(make_scene(PAPER, channel=channel, driven=True))
    assert {model.geom(i).name for i in range(model.ngeom)} == {"ball", "rail_left", "rail_right"}
    assert model.geom("rail_left").size[0] == RAIL_REACH
    assert model.geom("rail_left").pos[0] == 0.0


@pytest.mark.parametrize("driven", [False, True])
@pytest.mark.parametrize("angle", [0.0, 0.1])
def test_ball_touches_a_flat_rail_once(driven: bool, angle: float) -> None:
    """Find one contact, straight below the ball, and no guard touched."""
    model, data = loaded(FLAT, driven=driven)
    height = FLAT.eccentricity + FLAT.rolling_radius - 1e-8
    cos, sin = math.cos(angle), math.sin(angle)
    data.joint("pivot").qpos[0] = angle
    data.joint("ball").qpos[:3] = 0.2 * cos + height * sin, 0.0, height * cos - 0.2 * sin
    mujoco.mj_forward(model, data)
    (contact,) = data.contact
    np.testing.assert_allclose(contact.frame[:3], (-sin, 0.0, -cos), atol=1e-12)
    x, y, z = contact.pos
    # the middle of an overlap of 1e-8 m
    assert (x * cos - z * sin, y, z * cos + x * sin) == pytest.approx((0.2, 0.0, FLAT.eccentricity), abs=1e-8)


def test_guards_of_a_flat_rail_have_no_friction() -> None:
    """Let the viewer's guards push the ball back and not brake it; a driven run has none."""
    model, _ = loaded(FLAT, driven=False)
    ball = model.geom("ball").id
    names = [
        model.geom(int(second if first == ball else first)).name
        for first, second in zip(model.pair_geom1, model.pair_geom2, strict=True)
    ]
    assert set(names) == {"floor", "rail_left", "rail_right", "stop_near", "stop_far"}
    assert {name for name, dim in zip(names, model.pair_dim, strict=True) if dim == 1} == {"rail_left", "rail_right"}
    driven, _ = loaded(FLAT, driven=True)
    assert {driven.geom(i).name for i in range(driven.ngeom)} == {"ball", "floor"}


@pytest.mark.parametrize("rig", [PAPER, STEEP, FLAT], ids=["paper", "steep groove", "flat"])
def test_scene_has_the_settings_of_the_engine(rig: Rig) -> None:
    """Show in the viewer what a run with default parameters computes, but for the margin it settles."""
    parameters = MuJoCoParameters()
    assert default_option(rig) == parameters.option(rig)
    assert default_pair(rig) == parameters.pair(rig)


def test_beam_holds_still_and_follows_its_servo() -> None:
    """Play with the committed file: at rest nothing moves; a commanded angle is reached, and the ball rolls down."""
    model = mujoco.MjModel.from_xml_path(str(SCENE_FILE))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=5000)
    # The ball's weight turns a beam of 1e11 kg m² under a servo of 6π rad/s by m g s/(1e11 ω²) = 7e-15 rad, on which
    # it would roll K g α t²/2 < 1e-12 m in 5 s.
    assert abs(data.joint("pivot").qpos[0]) < 1e-14
    assert data.joint("ball").qpos[0] == pytest.approx(BALL_START, abs=1e-12)
    data.ctrl[0] = 0.05
    mujoco.mj_step(model, data, nstep=1500)
    # A critically damped servo of 6π rad/s is off by (1 + ω t) e^{−ω t} = 1.6e-11 of its step after 1.5 s.
    assert data.joint("pivot").qpos[0] == pytest.approx(0.05, abs=1e-10)
    assert BALL_START < data.joint("ball").qpos[0] < channel_of(PAPER).x_to
    mujoco.mj_step(model, data, nstep=20_000)
    # The stop holds it: its centre one radius before the end, at rest but for what the stop's softness leaves.
    assert data.joint("ball").qpos[0] == pytest.approx(
        (channel_of(PAPER).x_to - PAPER.radius) * math.cos(0.05) + channel_of(PAPER).ball_height * math.sin(0.05),
        abs=1e-4,
    )
