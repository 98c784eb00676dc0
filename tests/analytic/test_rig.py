"""A rig holds the paper's values, what follows from them, and refuses what cannot exist."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.rig import SOLID_SPHERE, Rig, RigError

RIG = Rig()


def test_defaults_are_the_papers_table() -> None:
    """Hold Table 1 of the paper, with the level angle left at zero for the user to set."""
    assert (RIG.mass, RIG.radius, RIG.rolling_radius, RIG.eccentricity) == (0.071, 0.0132, 0.0118, 0.035)
    assert (RIG.gravity, RIG.friction_coefficient, RIG.transition_velocity) == (9.81, 0.0362, 0.008)
    assert RIG.level_angle == 0.0
    # the paper prints four digits of 2/5 m R²
    assert RIG.inertia == pytest.approx(SOLID_SPHERE * RIG.mass * RIG.radius**2, rel=0.5e-9 / RIG.inertia)


def test_derived_quantities_have_the_values_of_the_paper_rig() -> None:
    """Give J/(m r²) = 0.5005, K = 0.6664 and the lever of α̈ 52.7 mm."""
    assert RIG.inertia_ratio == pytest.approx(0.5005, abs=5e-5)
    assert RIG.rolling_ratio == pytest.approx(0.6664, abs=5e-5)
    assert RIG.lever == pytest.approx(0.0527, abs=5e-5)


@given(ratio=st.floats(0.01, 1.0), scale=st.floats(1e-3, 10.0))
def test_gap_and_radii_are_a_right_triangle(ratio: float, scale: float) -> None:
    """Satisfy (w/2)² + r² = R² and r = R cos(contact angle) for every possible ball."""
    rig = Rig(radius=scale, rolling_radius=ratio * scale)
    assert rig.half_gap**2 + rig.rolling_radius**2 == pytest.approx(scale**2, rel=1e-14)
    # asin is ill-conditioned near 90°: an error of 1e-16 in the sine moves the cosine by 1e-16/cos
    assert scale * math.cos(rig.contact_angle) == pytest.approx(rig.rolling_radius, rel=1e-15 / ratio**2 + 1e-15)


def test_ball_on_a_flat_beam_has_no_gap() -> None:
    """Let r = R be the ball on a plane: no gap, contact from straight below, inertia ratio 2/5."""
    rig = Rig(rolling_radius=0.0132, inertia=SOLID_SPHERE * 0.071 * 0.0132**2)
    assert rig.half_gap == rig.contact_angle == 0.0
    assert rig.inertia_ratio == pytest.approx(0.4, rel=1e-14)


@pytest.mark.parametrize("name", ["mass", "inertia", "radius", "rolling_radius", "gravity", "transition_velocity"])
@pytest.mark.parametrize("value", [0.0, -1e-3])
def test_quantities_that_must_be_positive_are_refused_otherwise(name: str, value: float) -> None:
    """Refuse zero and negative values, naming the quantity."""
    with pytest.raises(RigError, match=f"^{name} is .* must be positive"):
        Rig(**{name: value})


@pytest.mark.parametrize("name", ["mass", "eccentricity", "level_angle", "friction_coefficient"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_quantities_that_are_no_numbers_are_refused(name: str, value: float) -> None:
    """Refuse NaN and infinity, naming the quantity."""
    with pytest.raises(RigError, match=f"^{name} is .* finite"):
        Rig(**{name: value})


def test_ball_cannot_roll_above_its_radius() -> None:
    """Refuse r > R and say why; allow r = R up to rounding."""
    with pytest.raises(RigError, match=r"rolling_radius 0\.014 m exceeds the ball's radius 0\.0132 m"):
        Rig(rolling_radius=0.014)
    assert Rig(rolling_radius=0.0132 * (1.0 + 1e-15)).half_gap == 0.0


def test_level_angle_in_degrees_is_taken_for_a_unit_error() -> None:
    """Refuse −1.6 "degrees" given as radians, accept −0.16° in radians."""
    with pytest.raises(RigError, match="unit error"):
        Rig(level_angle=-1.6)
    assert Rig(level_angle=math.radians(-0.16)).level_angle < 0.0


def test_pivot_may_lie_above_the_edges() -> None:
    """Accept a negative eccentricity and shorten the lever by it."""
    assert RIG.lever - Rig(eccentricity=-0.02).lever == pytest.approx(0.055, abs=1e-15)


def test_changed_rig_is_a_new_and_checked_one() -> None:
    """Change a copy, keep the original, and check the copy."""
    heavier = RIG.with_(mass=0.1)
    assert (heavier.mass, RIG.mass) == (0.1, 0.071)
    with pytest.raises(RigError, match="rolling_radius"):
        RIG.with_(radius=0.011)
