"""Generates the MJCF scene of any rig; all lengths come from `analytic.geometry`.

The ball touches the inner top edges of two boxes, the walls of the channel, or the top of one box where the rail is
flat. MuJoCo computes sphere–box contacts in closed form; a U-shaped mesh would be replaced by its convex hull with a
single contact.

`python -m mjcf.scene` writes `ball_beam.xml` for the paper's rig.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import indent

from analytic.geometry import Channel, channel_of
from analytic.rig import Rig

SCENE_FILE = Path(__file__).with_name("ball_beam.xml")

Attribute = str | float | Sequence[float]
Attributes = Mapping[str, Attribute]

TIME_STEP = 1e-3  # of the committed scene [s]
ARMATURE = 1e11  # inertia of the pivot [kg m²]: the ball's weight (0.3 N m) turns the beam by 2e-10 rad in 10 s
SERVO_FREQUENCY = 6 * math.pi  # natural frequency of the viewer's beam servo, critically damped [rad/s]
SERVO_RANGE = math.radians(6.0)  # the paper's beam moves within ±6° [rad]
BALL_START = 0.36  # start position of the paper's runs [m]

# MuJoCo aligns a contact's first tangent with world y if the normal is inclined by less than 30° (|n_y| < 1/2): it
# is then across the beam at any beam angle. Beyond, it is aligned with z, and friction has to be isotropic.
LEAN_LIMIT = 0.5
# In a groove friction across the beam would carry part of the load. At 1/2000 of the friction along the beam, and
# softened by `impratio_of`, its share is below 1e-5 of the weight: each contact carries N R/(2 r), and the friction
# cone is never saturated, so that Newton's method converges in one iteration.
ACROSS = 1 / 2000
FRICTION = 0.5
# Share x of the slip velocity that friction removes per step. MuJoCo computes a contact's frame at the beginning of the
# step, which leaves a slip of ½ s α̇² dt (2 − x)/x; it vanishes for x = 2, but so does the damping: 1 − x is left after
# a step. `relaxation_of` lets it decay within the same 5 ms at any step, so that what is left is of second order.
RELAXATION = 1.8  # where a step is 1 ms, and where it is longer
SLIP_DECAY = 5e-3  # [s]
# With a time constant of 2 dt, MuJoCo's minimum, this removes a penetration and its rate in one step:
# λ² − (2 − b − k) λ + (1 − b) = 0 has λ = 0 twice for b = 2 dt/T and k = (dt/(T ζ))² both 1, T = 2 dt.
DAMPING_RATIO = 0.5
# The harder the contact, the sooner a ball hops: with 0.99 it left an edge in 5 of 120 random motions of the beam
# (`benchmarks.accuracy`) and erred by up to 16 µm in others, with 0.975 it still did in one. A softer one lets the
# ball's height follow the load: with 0.96 that shows in a steep groove and at steps of 2 ms.
IMPEDANCE = 0.965

# Visual stand without contacts [m].
PLATE = 0.006
BRACKET = 0.015
AXLE_RADIUS = 0.005
BASE_DROP = 0.15
BASE_THICKNESS = 0.01
BASE_WIDTH = 0.06


def aligned(rig: Rig) -> bool:
    """Whether MuJoCo's friction axes are along and across the beam at any beam angle."""
    return math.sin(rig.contact_angle) < LEAN_LIMIT


def default_option(rig: Rig, time_step: float = TIME_STEP) -> dict[str, Attribute]:
    """Attributes of `<option>` that attain the validated accuracy."""
    return {
        "timestep": time_step,
        "integrator": "Euler",
        "solver": "Newton",
        "cone": "elliptic",
        "jacobian": "dense",  # 4.0.0 has a bug in the sparse Cholesky factorisation
        "iterations": 50,
        "tolerance": 1e-16,  # relative to the pivot's inertia
        "impratio": impratio_of(ACROSS if aligned(rig) else 1.0),
    }


def default_pair(rig: Rig, time_step: float = TIME_STEP) -> dict[str, Attribute]:
    """Attributes of the ball's `<pair>` with each rail; friction is across, along, torsional, rolling, rolling."""
    along = channel_of(rig).grip * FRICTION
    across = along * ACROSS if aligned(rig) else along
    return {
        "condim": 3,
        "friction": (across, along, 0.0, 0.0, 0.0),
        "solref": (2 * time_step, DAMPING_RATIO),
        "solreffriction": friction_reference(relaxation_of(time_step), IMPEDANCE, time_step),
        "solimp": (IMPEDANCE, IMPEDANCE, 0.001, 0.5, 2.0),
        "margin": 0.0,
        "gap": 0.0,
    }


def impratio_of(ratio: float) -> float:
    """`impratio` for a `ratio` of friction coefficients across/along the beam [1].

    MuJoCo softens friction across by 1/impratio, and friction along by (across/along)² of that. The result makes
    friction along the beam ten times as stiff as the normal, so that it creeps little.
    """
    return min(1.0, 10.0 * ratio**2)


def relaxation_of(time_step: float) -> float:
    """Share of a slip velocity that friction removes per step [1], 2 − dt/5 ms and not below 1.8."""
    return max(2.0 - time_step / SLIP_DECAY, RELAXATION)


def friction_reference(relaxation: float, impedance: float, time_step: float) -> tuple[float, float]:
    """`solreffriction` that removes the share `relaxation` of a slip velocity per step [1/s², 1/s].

    MuJoCo divides the damping by the impedance dmax. The stiffness has no effect, as friction holds no position.
    """
    return -1.0 / time_step**2, -relaxation * impedance / time_step


def make_scene(
    rig: Rig,
    *,
    channel: Channel | None = None,
    option: Attributes | None = None,
    pair: Attributes | None = None,
    driven: bool = False,
    start: float = BALL_START,
) -> str:
    """MJCF of the rig, world and beam frames as in `analytic.geometry`.

    Args:
        rig: the rig; `level_angle` tilts gravity, so that it acts along the beam as g sin(α + α₀).
        channel: geometry; `None` for the default of `channel_of`.
        option: attributes of `<option>`, `None` for `default_option`.
        pair: attributes of the contacts, `None` for `default_pair`.
        driven: the scene used by `harness.engines.mujoco`: no visuals, an actuator for the beam's angular acceleration
            [rad/s²], and a sensor of each contact. Otherwise a scene for the viewer, with a servo for the beam angle
            [rad], a stand, and end stops.
        start: where the ball lies [m].
    """
    channel = channel or channel_of(rig)
    # g sin(α + α₀) along e_s and −g cos(α + α₀) along e_n
    gravity = (rig.gravity * math.sin(rig.level_angle), 0.0, -rig.gravity * math.cos(rig.level_angle))
    settings = {"gravity": gravity, **(option or default_option(rig))}
    carrying = ["floor"] if channel.flat else ["rail_left", "rail_right"]
    touched = [*carrying, *([] if driven else ["stop_near", "stop_far"])]
    pairs = [_tag("pair", {"geom1": "ball", "geom2": name}) for name in touched]
    if channel.flat and not driven:
        pairs += [_tag("pair", {"geom1": "ball", "geom2": name, "condim": 1}) for name in ("rail_left", "rail_right")]
    sections = [
        _tag("compiler", {"angle": "radian"}),
        _tag("option", settings),
        _tag("size", {"memory": "1M"}),
        "" if driven else _LOOKS,
        _block(
            "default",
            _tag("pair", pair or default_pair(rig)),
            # only the explicit pairs below collide
            _tag("geom", {"contype": 0, "conaffinity": 0} | ({} if driven else {"material": "aluminium"})),
        ),
        _block(
            "worldbody", "" if driven else _stand(channel), _beam(channel, driven), _ball(rig, channel, driven, start)
        ),
        _block("contact", *pairs),
        _block("actuator", _tag("motor", {"name": "turn", "joint": "pivot", "gear": ARMATURE}) if driven else _servo()),
        _block("sensor", *map(_contact_sensor, carrying)) if driven else "",
    ]
    body = "\n\n".join(section for section in sections if section)
    return f'<mujoco model="ball_beam">\n{indent(body, "  ", lambda line: line.strip() != "")}\n</mujoco>\n'


def write(path: Path = SCENE_FILE, rig: Rig | None = None) -> Path:
    """Write the scene of `rig` (`None` for the paper's) to `path`; returns it."""
    path.write_text(make_scene(rig or Rig()), encoding="utf-8")
    return path


# Dim headlight, soft key light, and a mark on the ball that shows its rotation.
_LOOKS = """\
<statistic center="0.3 0 -0.04" extent="0.6"/>

<visual>
  <headlight diffuse="0.35 0.35 0.35" ambient="0.3 0.3 0.3" specular="0.2 0.2 0.2"/>
  <global azimuth="75" elevation="-20" fovy="35" offwidth="1920" offheight="1080"/>
  <quality shadowsize="4096"/>
  <map znear="0.005"/>
</visual>

<asset>
  <texture name="sky" type="skybox" builtin="gradient" rgb1=".93 .95 .97" rgb2=".55 .62 .7" width="512" height="3072"/>
  <texture name="steel" type="cube" builtin="flat" mark="cross" rgb1=".8 .81 .83" markrgb=".16 .17 .2" width="256"/>
  <texture name="table" type="2d" builtin="checker" rgb1=".86 .85 .82" rgb2=".83 .82 .79" width="256" height="256"/>
  <material name="steel" texture="steel" specular="1" shininess="0.9" reflectance="0.3"/>
  <material name="aluminium" rgba="0.78 0.80 0.83 1" specular="0.6" shininess="0.5"/>
  <material name="axle" rgba="0.45 0.47 0.50 1" specular="0.8" shininess="0.7"/>
  <material name="stand" rgba="0.25 0.32 0.42 1" specular="0.3" shininess="0.3"/>
  <material name="base" rgba="0.18 0.18 0.20 1" specular="0.2" shininess="0.2"/>
  <material name="table" texture="table" texrepeat="8 8" texuniform="true" reflectance="0.08"/>
</asset>"""


def _stand(channel: Channel) -> str:
    """Table, base plate, the two cheeks carrying the axle, lights and cameras."""
    cheek = channel.half_width + channel.wall_thickness + 1.5 * PLATE + 0.001
    top = 3 * AXLE_RADIUS
    cheeks = [
        _box(f"cheek_{side}", (2 * BRACKET, PLATE / 2, (BASE_DROP + top) / 2), (0.0, y, (top - BASE_DROP) / 2), "stand")
        for side, y in (("left", cheek), ("right", -cheek))
    ]
    plate = (channel.centre, 0.0, -BASE_DROP - BASE_THICKNESS / 2)
    table: dict[str, Attribute] = {"name": "table", "type": "plane", "size": (0, 0, 0.05), "material": "table"}
    fill: dict[str, Attribute] = {"directional": "true", "castshadow": "false"}
    overview: dict[str, Attribute] = {"name": "overview", "fovy": 28}
    return "\n".join(
        [
            _tag("light", {"pos": (0.1, -0.5, 1.3), "dir": (0.15, 0.38, -1), "diffuse": (0.4, 0.4, 0.4)}),
            _tag("light", {**fill, "pos": (0, 0, 1.5), "dir": (0.3, 0.5, -1), "diffuse": (0.35, 0.35, 0.35)}),
            _tag("camera", {**overview, "pos": (-0.08, -1.0, 0.36), "xyaxes": (0.935, -0.355, 0, 0.12, 0.316, 0.941)}),
            _tag("camera", {"name": "side", "fovy": 28, "pos": (0.3, -1.2, -0.03), "xyaxes": (1, 0, 0, 0, 0, 1)}),
            _tag("geom", {**table, "pos": (0, 0, -BASE_DROP - 1.1 * BASE_THICKNESS)}),
            _box("base", (channel.length / 2, BASE_WIDTH, BASE_THICKNESS / 2), plate, "base"),
            *cheeks,
        ]
    )


def _beam(channel: Channel, driven: bool) -> str:
    """The channel on its pivot."""
    wall, tall = channel.wall_thickness / 2, (channel.wall_top - channel.floor_top) / 2
    rails = [
        _box(name, (channel.length / 2, wall, tall), (channel.centre, y, channel.wall_top - tall))
        for name, y in (("rail_left", channel.half_width + wall), ("rail_right", -channel.half_width - wall))
    ]
    touched = [_floor(channel)] if channel.flat else rails
    return _block(
        'body name="beam"',
        # The large armature makes the beam follow its drive under any load.
        _tag("inertial", {"pos": (0, 0, 0), "mass": 1, "diaginertia": (1, 1, 1)}),
        _tag("joint", {"name": "pivot", "type": "hinge", "axis": (0, 1, 0), "armature": ARMATURE}),
        *(touched if driven else [*rails, _floor(channel), *_fittings(channel)]),
    )


def _floor(channel: Channel) -> str:
    """The plate below the ball, which carries it on a flat rail."""
    half = (channel.length / 2, channel.half_width + channel.wall_thickness, channel.floor_thickness / 2)
    return _box("floor", half, (channel.centre, 0.0, channel.floor_top - channel.floor_thickness / 2))


def _fittings(channel: Channel) -> list[str]:
    """End stops, brackets and axle."""
    outer = channel.half_width + channel.wall_thickness
    floor = channel.floor_top
    bottom = floor - channel.floor_thickness
    end = channel.wall_thickness / 2
    high = channel.ball_height
    stops = [
        _box(name, (end, outer, (high - bottom) / 2), (x, 0.0, (high + bottom) / 2))
        for name, x in (("stop_near", channel.x_from - end), ("stop_far", channel.x_to + end))
    ]
    low, up = min(floor, -2 * AXLE_RADIUS), max(channel.edge_height - channel.wall_thickness, 2 * AXLE_RADIUS)
    brackets = [
        _box(f"bracket_{side}", (BRACKET, PLATE / 2, (up - low) / 2), (0.0, y, (up + low) / 2), "axle")
        for side, y in (("left", outer + PLATE / 2), ("right", -outer - PLATE / 2))
    ]
    length = outer + 3 * PLATE
    ends = (0, -length, 0, 0, length, 0)
    axle = _tag("geom", {"name": "axle", "type": "cylinder", "size": AXLE_RADIUS, "fromto": ends, "material": "axle"})
    return [*stops, *brackets, axle]


def _ball(rig: Rig, channel: Channel, driven: bool, start: float) -> str:
    """The ball with its declared inertia, not necessarily that of a homogeneous sphere."""
    looks = {} if driven else {"material": "steel"}
    return _block(
        f'body name="ball" pos="{_text((start, 0.0, channel.ball_height))}"',
        _tag("freejoint", {"name": "ball"}),
        _tag("inertial", {"pos": (0, 0, 0), "mass": rig.mass, "diaginertia": (rig.inertia,) * 3}),
        _tag("geom", {"name": "ball", "type": "sphere", "size": channel.ball_radius, **looks}),
    )


def _servo() -> str:
    gains = {"kp": ARMATURE * SERVO_FREQUENCY**2, "kv": 2 * ARMATURE * SERVO_FREQUENCY}
    return _tag("position", {"name": "angle", "joint": "pivot", "ctrlrange": (-SERVO_RANGE, SERVO_RANGE), **gains})


def _contact_sensor(rail: str) -> str:
    return _tag("contact", {"name": rail, "geom1": "ball", "geom2": rail, "data": "force"})


def _box(name: str, half: Sequence[float], centre: Sequence[float], material: str | None = None) -> str:
    paint = {"material": material} if material else {}
    return _tag("geom", {"name": name, "type": "box", "size": half, "pos": centre, **paint})


def _block(head: str, *lines: str) -> str:
    inner = indent("\n".join(line for line in lines if line), "  ", lambda line: line.strip() != "")
    return f"<{head}>\n{inner}\n</{head.split()[0]}>"


def _tag(name: str, attributes: Attributes) -> str:
    return f"<{name} " + " ".join(f'{key}="{_text(value)}"' for key, value in attributes.items()) + "/>"


def _text(value: Attribute) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return " ".join(map(_text, value))
    return f"{value:.15g}"  # one digit less than a double has: 0.165 instead of 0.16499999999999998


if __name__ == "__main__":
    print(write())
