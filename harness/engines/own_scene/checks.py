"""What a user's scene must have in order to be driven and compared: each fact measured, judged, with what to do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from analytic.rig import Rig
from harness.engines.own_scene.measuring import Measured
from harness.scene import Scene


class Status(StrEnum):
    """How a check came out."""

    OK = "ok"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class Check:
    """One check of a scene.

    Attributes:
        name: what was checked.
        status: an error makes the scene unfit to be compared with the recordings; a warning says what differs.
        text: what was found, and what to do about it.
    """

    name: str
    status: Status
    text: str


@dataclass(frozen=True)
class Use:
    """What the recordings ask of a scene; `None` where nothing is known.

    Attributes:
        positions: from where to where the ball rolls [m].
        angles: smallest and largest beam angle [rad].
    """

    positions: tuple[float, float] | None = None
    angles: tuple[float, float] | None = None


@dataclass(frozen=True)
class _Quantity:
    """A quantity of the rig, its unit, and the relative differences from which on it is a warning, and an error."""

    name: str
    unit: str
    warning: float
    error: float


# K and g enter the acceleration in proportion: 0.2 % of 0.3 m/s² for 2 s are 1 mm, which a good sensor sees. Mass,
# inertia and radius act through K alone.
_QUANTITIES = (
    _Quantity("mass", "kg", 0.01, math.inf),
    _Quantity("inertia", "kg m²", 0.01, math.inf),
    _Quantity("radius", "m", 0.01, math.inf),
    _Quantity("rolling_radius", "m", 0.005, 0.05),
    _Quantity("rolling_ratio", "", 0.002, 0.01),
    _Quantity("gravity", "m/s²", 0.001, 0.01),
)
_ECCENTRICITY = (5e-4, 5e-3)  # [m]: times a peak of 3 rad/s² and K, 1 and 10 mm/s² for the time of a turn
_SLOPE = (1e-4, 2e-3)  # [rad]: 0.65 and 13 mm/s², all the time
_ANGLE_ROOM = 1e-6  # [rad]


def judged(scene: Scene, seen: Measured, rig: Rig | None, use: Use) -> Iterator[Check]:
    """Checks of what was measured in a scene.

    Args:
        scene: its names.
        seen: what was measured.
        rig: what `rig.toml` says; `None` if there is nothing to compare with.
        use: what the recordings ask for.
    """
    count = (
        f"{seen.contacts[0]}" if seen.contacts[0] == seen.contacts[1] else f"{seen.contacts[0]} to {seen.contacts[1]}"
    )
    yield Check("contact of ball and beam", Status.OK, f"{count} contacts the ball at s = {seen.at:.3f} m")
    if seen.others:
        yield Check(
            "other contacts",
            Status.ERROR,
            f"the ball also touches {', '.join(seen.others)} where it rests on the beam. Move that away, or let it be "
            "seen only (contype and conaffinity 0).",
        )
    yield _slope(scene, seen)
    yield from _reach(seen, use)
    if rig is not None:
        yield from _against(seen, rig)


def _slope(scene: Scene, seen: Measured) -> Check:
    size = abs(seen.slope)
    text = f"the track falls by {seen.slope:.2g} rad towards +s where α is 0"
    if size < _SLOPE[0]:
        return Check("level", Status.OK, text)
    level = scene.level_joint_angle - scene.direction * seen.slope
    return Check(
        "level",
        Status.WARNING if size < _SLOPE[1] else Status.ERROR,
        f"{text}. Write level_joint_angle_rad = {level:.6g} in [scene], or level the beam in the file.",
    )


def _reach(seen: Measured, use: Use) -> Iterator[Check]:
    begin, end = seen.track
    text = f"the track carries the ball from s = {begin:.3f} to {end:.3f} m"
    if use.positions is None:
        yield Check("track", Status.OK, text)
        return
    low, high = use.positions
    if begin <= low and high <= end:
        yield Check("track", Status.OK, f"{text}; the recordings need {low:.3f} to {high:.3f} m")
        return
    other_way = begin <= -high and -low <= end
    hint = (
        "At the other end it would: set direction = -1, or +1 if it is −1." if other_way else "Make the track longer."
    )
    yield Check("track", Status.ERROR, f"{text}, and the recordings need {low:.3f} to {high:.3f} m. {hint}")


# Of a groove that is right in the file.
_GEOMETRY = (
    " If both seem right: an engine takes a mesh for its convex hull, so that a groove takes a mesh for each side, and "
    "PyBullet rounds the edges of boxes and hulls by a margin."
)


def _against(seen: Measured, rig: Rig) -> Iterator[Check]:
    own = seen.rig(rig.level_angle)
    for one in _QUANTITIES:
        there, here = getattr(own, one.name), getattr(rig, one.name)
        off = abs(there / here - 1.0)
        status = Status.ERROR if off > one.error else Status.WARNING if off > one.warning else Status.OK
        hint = _GEOMETRY if one.name == "rolling_radius" else ""
        yield _compared(one.name, there, here, one.unit, f"{100.0 * off:.2g} %", status, hint)
    off = abs(own.eccentricity - rig.eccentricity)
    status = Status.ERROR if off > _ECCENTRICITY[1] else Status.WARNING if off > _ECCENTRICITY[0] else Status.OK
    yield _compared("eccentricity", own.eccentricity, rig.eccentricity, "m", f"{1e3 * off:.2g} mm", status)


def _compared(name: str, there: float, here: float, unit: str, off: str, status: Status, hint: str = "") -> Check:
    words = name.replace("_", " ")
    text = f"{there:.5g} {unit}".rstrip() + f" in the scene, {here:.5g} {unit}".rstrip() + " in rig.toml"
    if status is not Status.OK:
        text += f", {off} apart. Correct whichever is wrong; the scene runs with its own.{hint}"
    return Check(words, status, text)


def joint_limits(low: float, high: float, use: Use) -> Check | None:
    """Whether the beam's joint may turn as far as the recordings do; limits are those of α [rad]."""
    if use.angles is None or (low - _ANGLE_ROOM <= use.angles[0] and use.angles[1] <= high + _ANGLE_ROOM):
        return None
    least, most = (math.degrees(one) for one in use.angles)
    return Check(
        "joint limits",
        Status.WARNING,
        f"the joint is limited to α from {math.degrees(low):.2f}° to {math.degrees(high):.2f}°, and the recordings "
        f"turn it from {least:.2f}° to {most:.2f}°. The drive ignores the limits; widen "
        "them, or check the angle's unit.",
    )
