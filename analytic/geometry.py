"""The rig's geometry, from which all engines' scenes are made.

World frame: origin on the pivot axis, x along the level beam towards +s, y across, z up. The beam turns about +y, so
that α > 0 lowers the +s end. Beam frame: the same at α = 0; e_s = (cos α, 0, −sin α), e_n = (sin α, 0, cos α).
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
RAIL_REACH = 20.0  # length of the rails in simulations: a wrong model may roll far, which is a result, not a failure


@dataclass(frozen=True)
class Channel:
    """A U-channel whose inner top edges carry the ball; lengths in metres, in the beam frame.

    Attributes:
        half_gap: w/2, |y| of the edges the ball rolls on.
        edge_height: z of these edges, the eccentricity h.
        ball_height: z of the ball's centre in rolling contact, h + r.
        x_from, x_to: extent along the beam.
        wall_thickness, wall_height, floor_thickness: of the profile.
    """

    half_gap: float
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


def channel_of(rig: Rig, *, x_from: float = BEAM_FROM, x_to: float = BEAM_TO) -> Channel:
    """The channel of `rig` between two positions along the beam [m]."""
    return Channel(
        half_gap=rig.half_gap,
        edge_height=rig.eccentricity,
        ball_height=rig.eccentricity + rig.rolling_radius,
        x_from=x_from,
        x_to=x_to,
    )


def to_world(along: float, across: float, normal: float, angle: float) -> tuple[float, float, float]:
    """World coordinates [m] of the beam-frame point (along, across, normal) [m] at beam angle α [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return along * cos + normal * sin, across, normal * cos - along * sin


def to_beam(x: float, y: float, z: float, angle: float) -> tuple[float, float, float]:
    """Beam-frame coordinates (along, across, normal) [m] of a world point [m] at beam angle α [rad]."""
    cos, sin = math.cos(angle), math.sin(angle)
    return x * cos - z * sin, y, z * cos + x * sin
