"""The rig's geometry, from which all engines' scenes are made.

World frame: origin on the pivot axis, x along the level beam towards +s, y across, z up. The beam turns about +y, so
that α > 0 lowers the +s end. Beam frame: the same at α = 0; e_s = (cos α, 0, −sin α), e_n = (sin α, 0, cos α).

A rail is flat where the gap is too narrow to guide the ball (`FLAT_BELOW`): the ball then rolls on a plane between two
guards that it does not touch. Its contact sphere has the radius r, so that the plane carries it at the height and with
the lever of the groove: no quantity of eq. 14 changes at the limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from analytic.rig import Rig

# Dimensions of the drawn U-channel [m]; no contact depends on them.
WALL_THICKNESS = 0.002
WALL_HEIGHT = 0.015
FLOOR_THICKNESS = 0.002
BEAM_FROM, BEAM_TO = -0.05, 0.65  # the drawn beam: the paper's ball travels between 0.1 and 0.6 m
GUARD_CLEARANCE = 0.001  # between a ball on a flat rail and each of the guards beside it
RAIL_REACH = 20.0  # length of the rails in simulations: a wrong model may roll far, which is a result, not a failure


# Of w/2 over R, the sine of the contact angle β; here r is 0.995 R. The normals of both contacts enclose 2 β, and a
# solver that goes through the contacts in turn (Gauss–Seidel, as in Bullet) leaves the share cos² 2β ≈ exp(−4 β²) of an
# error per pass: the shallower the groove, the more passes (`harness.engines.pybullet`), here 150 for exp(−6). With too
# few the ball rolls about in the groove and out of it. MuJoCo's and DART's solvers hold it down to some 0.002.
FLAT_BELOW = 0.1


@dataclass(frozen=True)
class Channel:
    """A U-channel whose inner top edges carry the ball, or a flat rail; lengths in metres, in the beam frame.

    Attributes:
        half_gap: w/2, |y| of the edges the ball rolls on.
        flat: whether a plane carries the ball instead of the edges.
        ball_radius: of the sphere that touches them: R on edges, r on the plane.
        grip: by which friction coefficients on the plane are multiplied, as leaning contacts carry N R/r together [1].
        edge_height: z of the edges or the plane, the eccentricity h.
        ball_height: z of the ball's centre in rolling contact, h + r.
        x_from, x_to: extent along the beam.
        wall_thickness, wall_height, floor_thickness: of the profile.
    """

    half_gap: float
    flat: bool
    ball_radius: float
    grip: float
    edge_height: float
    ball_height: float
    x_from: float
    x_to: float
    wall_thickness: float = WALL_THICKNESS
    wall_height: float = WALL_HEIGHT
    floor_thickness: float = FLOOR_THICKNESS

    @property
    def length(self) -> float:
        """Length along the beam [m]."""
        return self.x_to - self.x_from

    @property
    def centre(self) -> float:
        """x of the channel's middle [m]."""
        return 0.5 * (self.x_from + self.x_to)

    @property
    def contacts(self) -> int:
        """Number of contacts that carry the ball."""
        return 1 if self.flat else 2

    @property
    def half_width(self) -> float:
        """|y| of the walls' inner faces [m]: the edges, or guards beside the ball."""
        return self.ball_radius + GUARD_CLEARANCE if self.flat else self.half_gap

    @property
    def wall_top(self) -> float:
        """z of the walls' upper faces [m]: the edges, or as high as the ball's centre."""
        return self.ball_height if self.flat else self.edge_height

    @property
    def floor_top(self) -> float:
        """z of the floor's upper face [m]: what a ball on a flat rail rolls on."""
        return self.edge_height if self.flat else self.edge_height - self.wall_height

    @property
    def lateral_limit(self) -> float:
        """|y| of the ball's centre [m] beyond which it is leaving the edges, or meets a guard."""
        return GUARD_CLEARANCE if self.flat else 0.5 * self.half_gap


def channel_of(rig: Rig, *, x_from: float = BEAM_FROM, x_to: float = BEAM_TO) -> Channel:
    """The channel of `rig` between two positions along the beam [m]."""
    flat = rig.half_gap < FLAT_BELOW * rig.radius
    return Channel(
        half_gap=rig.half_gap,
        flat=flat,
        ball_radius=rig.rolling_radius if flat else rig.radius,
        grip=rig.radius / rig.rolling_radius if flat else 1.0,
        edge_height=rig.eccentricity,
        ball_height=rig.eccentricity + rig.rolling_radius,
        x_from=x_from,
        x_to=x_to,
    )


def rails_of(rig: Rig) -> Channel:
    """The channel of `rig` as long as a simulation needs it."""
    return channel_of(rig, x_from=-RAIL_REACH, x_to=RAIL_REACH)


def to_world(along: float, across: float, normal: float, angle: float) -> tuple[float, float, float]:
    """World coordinates [m] of the beam-frame point (along, across, normal) [m] at beam angle α [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return along * cos + normal * sin, across, normal * cos - along * sin


def to_beam(x: float, y: float, z: float, angle: float) -> tuple[float, float, float]:
    """Beam-frame coordinates (along, across, normal) [m] of a world point [m] at beam angle α [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return x * cos - z * sin, y, z * cos + x * sin
