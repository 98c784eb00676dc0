"""The channel carries the ball where the rig says, and the beam's frame turns with α > 0 lowering the +s end."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.geometry import (
    BEAM_FROM,
    BEAM_TO,
    FLAT_BELOW,
    GUARD_CLEARANCE,
    RAIL_REACH,
    channel_of,
    to_beam,
    to_world,
)
from analytic.rig import Rig

RIG = Rig()
POINT = st.tuples(*(st.floats(-2.0, 2.0) for _ in range(3)))
ANGLE = st.floats(-math.pi, math.pi)


def test_contact_geometry_has_the_papers_numbers() -> None:
    """Give w/2 = 5.916 mm and normals that lean 26.63° from the vertical."""
    assert channel_of(RIG).half_gap == pytest.approx(5.916e-3, abs=5e-7)
    assert math.degrees(RIG.contact_angle) == pytest.approx(26.63, abs=5e-3)
    assert math.sin(RIG.contact_angle) == pytest.approx(0.448, abs=5e-4)
    assert math.cos(RIG.contact_angle) == pytest.approx(0.894, abs=5e-4)


def test_edges_touch_the_ball() -> None:
    """Place the two edges exactly one ball radius from the ball's centre."""
    channel = channel_of(RIG)
    below = channel.ball_height - channel.edge_height
    assert below == pytest.approx(RIG.rolling_radius, abs=1e-17)
    assert math.hypot(channel.half_gap, below) == pytest.approx(RIG.radius, rel=1e-15)


def test_each_contact_carries_its_share() -> None:
    """Balance a normal force N by N R/(2 r) along each of the two leaning normals."""
    normals = np.array([[side * RIG.half_gap, RIG.rolling_radius] for side in (-1.0, 1.0)]) / RIG.radius
    carried = np.linalg.solve(normals.T, [0.0, 1.0])
    np.testing.assert_allclose(carried, RIG.radius / (2.0 * RIG.rolling_radius), rtol=1e-15)


@given(gap=st.floats(0.0, 0.3))
def test_a_shallow_groove_becomes_a_plane_that_carries_the_ball_alike(gap: float) -> None:
    """Keep the height, the lever and the grip of the ball whether edges or a plane carry it."""
    rig = RIG.with_(rolling_radius=RIG.radius * math.sqrt(1.0 - gap**2))
    channel = channel_of(rig)
    assert channel.contacts == (1 if channel.flat else 2)
    # √(1 − gap²) and back loses up to 1e-16/gap of a gap at the limit
    assert channel.flat == (gap < FLAT_BELOW) or gap == pytest.approx(FLAT_BELOW, abs=1e-14)
    reach = math.sqrt(channel.ball_radius**2 - (0.0 if channel.flat else channel.half_gap) ** 2)
    assert channel.ball_height == pytest.approx(channel.edge_height + reach, rel=1e-14)
    # Coulomb's limit over the weight: μ of each of the contacts, which carry N R/(2 r) each, or N
    carried = channel.grip * (1.0 if channel.flat else channel.ball_radius / reach)
    assert carried == pytest.approx(rig.radius / rig.rolling_radius, rel=1e-14)


def test_guards_stand_beside_the_ball_on_a_flat_rail() -> None:
    """Leave a millimetre on either side, and let the floor carry the ball."""
    channel = channel_of(RIG.with_(rolling_radius=RIG.radius))
    assert channel.floor_top == channel.edge_height == pytest.approx(channel.ball_height - RIG.radius)
    assert channel.half_width - RIG.radius == pytest.approx(GUARD_CLEARANCE)
    assert channel.wall_top > channel.floor_top


def test_channel_is_as_long_as_asked() -> None:
    """Draw the beam for the eye by default, and as far as a run may roll on demand."""
    drawn, driven = channel_of(RIG), channel_of(RIG, x_from=-RAIL_REACH, x_to=RAIL_REACH)
    assert drawn.length == pytest.approx(BEAM_TO - BEAM_FROM)
    assert drawn.centre == pytest.approx(0.5 * (BEAM_FROM + BEAM_TO))
    assert (driven.length, driven.centre) == (2.0 * RAIL_REACH, 0.0)
    assert drawn.half_gap == driven.half_gap


@given(point=POINT, angle=ANGLE)
def test_to_beam_undoes_to_world(point: tuple[float, float, float], angle: float) -> None:
    """Come back to every point, either way round."""
    # two products and a sum on numbers of at most 2·√2, twice
    assert to_beam(*to_world(*point, angle), angle) == pytest.approx(point, rel=0.0, abs=4e-15)
    assert to_world(*to_beam(*point, angle), angle) == pytest.approx(point, rel=0.0, abs=4e-15)


@given(point=POINT, angle=ANGLE)
def test_turning_keeps_lengths_and_the_axis(point: tuple[float, float, float], angle: float) -> None:
    """Leave distances from the pivot and the coordinate along its axis alone."""
    world = to_world(*point, angle)
    assert world[1] == point[1]
    assert math.hypot(*world) == pytest.approx(math.hypot(*point), rel=4e-16 * 4, abs=1e-300)


def test_positive_angle_lowers_the_far_end() -> None:
    """Send e_s to (cos α, 0, −sin α) and e_n to (sin α, 0, cos α)."""
    angle = 0.3
    assert to_world(1.0, 0.0, 0.0, angle) == pytest.approx((math.cos(angle), 0.0, -math.sin(angle)), rel=1e-15)
    assert to_world(0.0, 0.0, 1.0, angle) == pytest.approx((math.sin(angle), 0.0, math.cos(angle)), rel=1e-15)
    assert to_world(0.5, 0.0, 0.0, angle)[2] < 0.0 < to_world(-0.5, 0.0, 0.0, angle)[2]
