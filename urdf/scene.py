"""The rig as URDF text, for any rig; every length comes from `analytic.geometry`.

The ball touches two square bars ("rails") that stand for the channel's inner top edges. Each bar turns a face to the
ball, so that the face is tangent to the ball on the edge: same contact point, same normal. URDF 1.0 has no capsule,
PyBullet makes a cylinder a 32-sided hull and adds 1 mm, and it rounds the edges of a box by a margin; the middle of a
face stays where it is. On a flat rail one plate carries the ball, between two guards. The channel itself, the bearing
and the base plate are drawn only.

`python -m urdf.scene` writes `ball_beam.urdf` and `ball.urdf` for the paper's rig.
"""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

from analytic.geometry import Channel, channel_of
from analytic.rig import Rig

BEAM_FILE = Path(__file__).with_name("ball_beam.urdf")
BALL_FILE = Path(__file__).with_name("ball.urdf")
PIVOT, CHORD_X, CHORD_Z = "pivot", "chord_x", "chord_z"  # names of the joints

RAIL_WIDTH = 0.002  # of the rails' square section [m]: as wide as the wall; the ball's path does not depend on it
BEAM_INERTIA = 1e6  # mass [kg] and inertia [kg m²]: the ball's reaction turns the beam by less than 1e-12 rad a step

# The drawn stand; nothing touches it [m].
PLATE_THICKNESS = 0.006
PLATE_GAP = 0.001
BRACKET_WIDTH = 0.03
AXLE_RADIUS = 0.005
BASE_DROP = 0.15  # the far end of the beam sinks by 0.07 m at 6°
BASE_THICKNESS = 0.01
BASE_WIDTH = 0.12

ALUMINIUM, STEEL, STAND, BASE = "0.78 0.80 0.83 1", "0.45 0.47 0.50 1", "0.25 0.32 0.42 1", "0.18 0.18 0.20 1"

Vector = tuple[float, float, float]


def rail_axis(rig: Rig, depth: float = 0.5 * RAIL_WIDTH) -> tuple[float, float]:
    """|y| and z of the rails' axes [m] in the beam frame, for rails whose surface lies `depth` [m] from the axis.

    With the axis at a distance R + depth from the ball's centre, along the contact normal of the sharp edge, a tube of
    that radius and a bar with that half width, one face across the normal, both touch the ball on the edge.
    """
    stretch = (rig.radius + depth) / rig.radius
    return rig.half_gap * stretch, rig.eccentricity + rig.rolling_radius * (1.0 - stretch)


def beam_urdf(rig: Rig, channel: Channel | None = None, *, driven: bool = False) -> str:
    """URDF of stand and beam.

    Args:
        rig: the rig.
        channel: its channel; `None` draws the paper's.
        driven: what `harness.engines.pybullet` steps: nothing drawn, and between base and pivot two sliding
            joints, `chord_x` and `chord_z`, which stay at zero and only lend the beam a surface velocity. A flat rail
            is then a plane, which PyBullet has and URDF has not: Bullet's search for the point where a ball touches a
            large box fails now and then, and the ball falls by g dt² in such a step.
    """
    channel = channel or channel_of(rig)
    robot = ElementTree.Element("robot", name="ball_beam")
    base = _link(robot, "base", mass=0.0, inertia=0.0)
    parent = "base"
    for name, axis in ((CHORD_X, "1 0 0"), (CHORD_Z, "0 0 1")) if driven else ():
        _link(robot, f"carriage_{name}", mass=BEAM_INERTIA, inertia=BEAM_INERTIA)
        slide = _joint(robot, name, "prismatic", parent, f"carriage_{name}", axis=axis)
        ElementTree.SubElement(slide, "limit", lower="-1", upper="1", effort="0", velocity="1")
        parent = f"carriage_{name}"
    beam = _link(robot, "beam", mass=BEAM_INERTIA, inertia=BEAM_INERTIA)
    _joint(robot, PIVOT, "continuous", parent, "beam", axis="0 1 0")
    if channel.flat and driven:
        plane = ElementTree.SubElement(beam, "collision")
        _origin(plane, (0.0, 0.0, channel.floor_top))
        ElementTree.SubElement(ElementTree.SubElement(plane, "geometry"), "plane", normal="0 0 1")
    elif channel.flat:
        plate = ElementTree.SubElement(beam, "collision")
        _origin(plate, (channel.centre, 0.0, channel.floor_top - 0.5 * channel.floor_thickness))
        _box(plate, (channel.length, 2 * channel.half_width, channel.floor_thickness))
    else:
        across, height = rail_axis(rig)
        for side in (1.0, -1.0):
            rail = ElementTree.SubElement(beam, "collision")
            _origin(rail, (channel.centre, side * across, height), turn=(side * rig.contact_angle, 0.0, 0.0))
            _box(rail, (channel.length, RAIL_WIDTH, RAIL_WIDTH))
    if not driven:
        _draw_channel(beam, channel)
        _draw_stand(base, channel)
    return _text(robot)


def ball_urdf(rig: Rig) -> str:
    """URDF of the ball: its declared mass and inertia, which need not be those of a homogeneous sphere."""
    robot = ElementTree.Element("robot", name="ball")
    ball = _link(robot, "ball", mass=rig.mass, inertia=rig.inertia)
    _shape(ElementTree.SubElement(ball, "collision"), "sphere", radius=channel_of(rig).ball_radius)
    visual = ElementTree.SubElement(ball, "visual")
    _shape(visual, "sphere", radius=rig.radius)
    _paint(visual, "steel", STEEL)
    return _text(robot)


def write(folder: Path, rig: Rig | None = None) -> tuple[Path, Path]:
    """Write both files for `rig` (`None` for the paper's) into `folder`; returns their paths."""
    rig = rig or Rig()
    beam, ball = folder / BEAM_FILE.name, folder / BALL_FILE.name
    beam.write_text(beam_urdf(rig), encoding="utf-8")
    ball.write_text(ball_urdf(rig), encoding="utf-8")
    return beam, ball


def _draw_channel(beam: ElementTree.Element, channel: Channel) -> None:
    """Walls, floor, brackets down to the axle, and the axle."""
    outer = channel.half_width + channel.wall_thickness
    floor, tall = channel.floor_top, channel.wall_top - channel.floor_top
    for side in (1.0, -1.0):
        wall = (channel.centre, side * (channel.half_width + 0.5 * channel.wall_thickness), floor + 0.5 * tall)
        size = (channel.length, channel.wall_thickness, tall)
        _draw_box(beam, size, wall, "aluminium", ALUMINIUM)
        if channel.flat:  # a guard
            guard = ElementTree.SubElement(beam, "collision")
            _origin(guard, wall)
            _box(guard, size)
        low, high = min(floor, -2 * AXLE_RADIUS), max(channel.edge_height - channel.wall_thickness, 2 * AXLE_RADIUS)
        bracket = (0.0, side * (outer + 0.5 * PLATE_THICKNESS), 0.5 * (low + high))
        _draw_box(beam, (BRACKET_WIDTH, PLATE_THICKNESS, high - low), bracket, "steel", STEEL)
    bottom = (channel.centre, 0.0, floor - 0.5 * channel.floor_thickness)
    _draw_box(beam, (channel.length, 2 * outer, channel.floor_thickness), bottom, "aluminium", ALUMINIUM)
    axle = ElementTree.SubElement(beam, "visual")
    _origin(axle, (0.0, 0.0, 0.0), turn=(math.pi / 2, 0.0, 0.0))
    _shape(axle, "cylinder", radius=AXLE_RADIUS, length=2 * (outer + 3 * PLATE_THICKNESS))
    _paint(axle, "steel", STEEL)


def _draw_stand(base: ElementTree.Element, channel: Channel) -> None:
    """The two cheeks that carry the axle, and the base plate."""
    cheek = channel.half_width + channel.wall_thickness + 1.5 * PLATE_THICKNESS + PLATE_GAP
    top = 3 * AXLE_RADIUS
    for side in (1.0, -1.0):
        size = (2 * BRACKET_WIDTH, PLATE_THICKNESS, BASE_DROP + top)
        _draw_box(base, size, (0.0, side * cheek, 0.5 * (top - BASE_DROP)), "stand", STAND)
    plate = (channel.centre, 0.0, -BASE_DROP - 0.5 * BASE_THICKNESS)
    _draw_box(base, (channel.length, BASE_WIDTH, BASE_THICKNESS), plate, "base", BASE)


def _link(robot: ElementTree.Element, name: str, *, mass: float, inertia: float) -> ElementTree.Element:
    link = ElementTree.SubElement(robot, "link", name=name)
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "mass", value=_number(mass))
    moments = dict.fromkeys(("ixx", "iyy", "izz"), _number(inertia)) | dict.fromkeys(("ixy", "ixz", "iyz"), "0")
    ElementTree.SubElement(inertial, "inertia", moments)
    return link


def _joint(
    robot: ElementTree.Element, name: str, kind: str, parent: str, child: str, *, axis: str
) -> ElementTree.Element:
    joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    ElementTree.SubElement(joint, "axis", xyz=axis)
    return joint


def _draw_box(link: ElementTree.Element, size: Vector, centre: Vector, material: str, colour: str) -> None:
    visual = ElementTree.SubElement(link, "visual")
    _origin(visual, centre)
    _box(visual, size)
    _paint(visual, material, colour)


def _box(element: ElementTree.Element, size: Vector) -> None:
    ElementTree.SubElement(ElementTree.SubElement(element, "geometry"), "box", size=_numbers(size))


def _shape(element: ElementTree.Element, kind: str, **lengths: float) -> None:
    geometry = ElementTree.SubElement(element, "geometry")
    ElementTree.SubElement(geometry, kind, {name: _number(length) for name, length in lengths.items()})


def _origin(element: ElementTree.Element, centre: Vector, turn: Vector = (0.0, 0.0, 0.0)) -> None:
    ElementTree.SubElement(element, "origin", xyz=_numbers(centre), rpy=_numbers(turn))


def _paint(visual: ElementTree.Element, name: str, colour: str) -> None:
    ElementTree.SubElement(ElementTree.SubElement(visual, "material", name=name), "color", rgba=colour)


def _number(value: float) -> str:
    return f"{value:.15g}"  # one digit less than a double has: 0.165 instead of 0.16499999999999998


def _numbers(values: Vector) -> str:
    return " ".join(map(_number, values))


def _text(robot: ElementTree.Element) -> str:
    ElementTree.indent(robot)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(robot, encoding="unicode") + "\n"


if __name__ == "__main__":
    for path in write(Path(__file__).parent):
        print(path)


def iterations_for(rig: Rig, fewest: int) -> int:
    """Iterations of Bullet's solver that leave exp(−6) of an error: each leaves cos² 2β for normals that enclose 2 β.

    Args:
        fewest: at least so many.
    """
    return fewest if channel_of(rig).flat else max(fewest, math.ceil(1.5 / rig.contact_angle**2))
