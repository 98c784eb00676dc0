"""Measures a user's scene by touch: where the ball rests on the track, on how many points, and how far the track goes.

Nothing is simulated. The ball is put at a place on the level beam, and the engine says what it touches there. What eq.
14 needs follows from that: the height of the ball's centre is h + r, and a contact whose normal rises by n_z has the
rolling radius r = R n_z.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from scipy.optimize import minimize_scalar

from analytic.geometry import FLAT_BELOW, GUARD_CLEARANCE, RAIL_REACH
from analytic.rig import Rig
from harness.engines.leapfrog import Vector
from harness.errors import InputError

_PRESS = 2e-6  # depth by which the ball is pressed into the track to see all of its contacts [m]
_SEARCH = 1.0  # above and below the axis, where the track is looked for [m]
_EXACT = 1e-9  # of the height at which the ball rests [m]
_SPAN = 0.1  # over which the slope of the track is measured, to either side [m]
_STEP = 0.15  # of the height of a rail, of the radius: more is a step or a gap


@dataclass(frozen=True)
class Touch:
    """One contact of the ball.

    Attributes:
        normal: unit vector from the other body to the ball, in the harness's frame.
        beam: whether that body is the beam.
        name: of that body, or of its geometry.
    """

    normal: Vector
    beam: bool
    name: str


@dataclass(frozen=True)
class BallFacts:
    """The ball as the scene has it: mass [kg], moment of inertia [kg m²], radius [m]; centre at the start, in the
    harness's frame [m]."""

    mass: float
    inertia: float
    radius: float
    start: Vector


class Touchable(Protocol):
    """A loaded scene with its beam level, in which the ball can be put anywhere."""

    place: str
    """File, for messages."""
    ball: BallFacts
    gravity: float

    def touches(self, centre: Vector) -> list[Touch]:
        """What the ball touches or penetrates with its centre there, in the harness's frame [m]."""
        ...


@dataclass(frozen=True)
class Measured:
    """What was measured in a scene.

    Attributes:
        mass, inertia, radius: of the ball [kg], [kg m²], [m].
        rolling_radius: r [m].
        eccentricity: h [m].
        gravity: g [m/s²].
        across: |y| of the ball's centre line, signed, in the harness's frame [m].
        slope: angle by which the track falls towards +s while the beam stands level [rad].
        contacts: fewest and most contacts that carry the ball along the track.
        track: from where to where it carries the ball [m].
        others: what else the ball touches where it rests.
        at: position at which all this was measured [m].
    """

    mass: float
    inertia: float
    radius: float
    rolling_radius: float
    eccentricity: float
    gravity: float
    across: float
    slope: float
    contacts: tuple[int, int]
    track: tuple[float, float]
    others: tuple[str, ...]
    at: float

    @property
    def height(self) -> float:
        """Of the ball's centre above the axis, h + r [m]."""
        return self.eccentricity + self.rolling_radius

    @property
    def guided(self) -> bool:
        """Whether the track is a groove, and not flat."""
        return self.rolling_radius < math.sqrt(1.0 - FLAT_BELOW**2) * self.radius

    @property
    def lateral_limit(self) -> float:
        """|y| beyond which the ball is leaving the track [m]."""
        half_gap = math.sqrt(max(self.radius**2 - self.rolling_radius**2, 0.0))
        return 0.5 * half_gap if self.guided else GUARD_CLEARANCE

    def rig(self, level_angle: float) -> Rig:
        """The rig that the scene is, on a base that is off level by `level_angle` [rad]."""
        return Rig(
            mass=self.mass,
            inertia=self.inertia,
            radius=self.radius,
            rolling_radius=min(self.rolling_radius, self.radius),
            eccentricity=self.eccentricity,
            gravity=self.gravity,
            level_angle=level_angle,
        )


def measure(scene: Touchable, at: float | None = None) -> Measured:
    """Measure a scene.

    Args:
        scene: loaded.
        at: position along the beam at which the ball is put, one where it rolls in the recordings [m]; `None` for
            where the scene itself has it.

    Raises:
        InputError: the beam does not carry the ball there.
    """
    radius, place = scene.ball.radius, scene.place
    s = scene.ball.start[0] if at is None else at

    def height(s: float, y: float, near: float | None = None) -> float | None:
        return _resting(scene, s, y, near)

    y, z = scene.ball.start[1], None
    z = height(s, y)
    if z is None:
        raise InputError(
            f"{place}: the beam does not carry the ball at s = {s:.3f} m (y = {y:.3f} m): lowered there from above, it "
            "touches no part of the beam. Check that ball and beam may collide (contype, conaffinity, pairs), that the "
            "track reaches there, and the direction of α, which says at which end s is positive."
        )
    y, z = _middle(height, s, y, z, radius)
    pressed = scene.touches((s, y, z - _PRESS))
    carrying = [one for one in pressed if one.beam]
    rise = [one.normal[2] for one in carrying]
    if min(rise) <= 0.0:
        raise InputError(f"{place}: at s = {s:.3f} m a contact pushes the ball down. Free the space above the track.")
    rolling = radius * float(np.mean(rise))
    ends = [(one, height(one, y, z)) for one in (s - _SPAN, s + _SPAN)]
    known = [(one, at_end) for one, at_end in [*ends, (s, z)] if at_end is not None]
    slope = (
        -math.atan(np.polyfit([place for place, _ in known], [level for _, level in known], 1)[0])
        if len(known) > 1
        else 0.0
    )
    (begin, end), counts = _track(scene, s, y, z, -math.tan(slope))
    return Measured(
        mass=scene.ball.mass,
        inertia=scene.ball.inertia,
        radius=radius,
        rolling_radius=rolling,
        eccentricity=z - rolling,
        gravity=scene.gravity,
        across=y,
        slope=slope,
        contacts=(min(len(carrying), *counts), max(len(carrying), *counts)),
        track=(begin, end),
        others=tuple(sorted({one.name for one in pressed if not one.beam})),
        at=s,
    )


def _resting(scene: Touchable, s: float, y: float, near: float | None) -> float | None:
    """Height [m] at which a ball that is lowered touches the beam; looked for within R of `near`, or everywhere."""
    radius = scene.ball.radius
    top, bottom = (_SEARCH, -_SEARCH) if near is None else (near + radius, near - radius)

    def touching(z: float) -> bool:
        return any(one.beam for one in scene.touches((s, y, z)))

    steps = np.arange(top, bottom, -0.5 * radius)
    if near is not None and touching(top):
        return None
    for high, low in pairwise(steps.tolist()):
        if touching(low):
            if touching(high):
                return None  # the search begins within the beam
            above, below = high, low
            while above - below > _EXACT:
                between = 0.5 * (above + below)
                above, below = (above, between) if touching(between) else (between, below)
            return above
    return None


def _middle(
    height: Callable[[float, float, float | None], float | None], s: float, y: float, z: float, radius: float
) -> tuple[float, float]:
    """y and height [m] of the ball in the groove near `y`; `y` itself on a flat track."""
    reach = 0.5 * radius

    def at(across: float) -> float:
        found = height(s, across, z)
        return z + radius if found is None else found

    if abs(at(y + 0.1 * radius) - z) < 10 * _EXACT and abs(at(y - 0.1 * radius) - z) < 10 * _EXACT:
        return y, z
    lowest = minimize_scalar(at, bounds=(y - reach, y + reach), method="bounded", options={"xatol": 1e-8})
    return float(lowest.x), at(float(lowest.x))


def _track(scene: Touchable, s: float, y: float, z: float, rise: float) -> tuple[tuple[float, float], list[int]]:
    """From where to where the track carries the ball [m], and the numbers of contacts on it."""
    radius = scene.ball.radius
    counts: list[int] = []

    def carried(at: float) -> bool:
        level = z + rise * (at - s)
        if any(one.beam for one in scene.touches((at, y, level + _STEP * radius))):
            return False
        found = sum(one.beam for one in scene.touches((at, y, level - _STEP * radius)))
        if not found:
            return False
        exact = [one for one in scene.touches((at, y, level - _PRESS)) if one.beam]
        if exact:
            counts.append(len(exact))
        return True

    ends = []
    for way in (-1.0, 1.0):
        inside = s
        while abs(inside) < RAIL_REACH and carried(inside + way * radius):
            inside += way * radius
        ends.append(inside)
    return (ends[0], ends[1]), counts
