"""Scenes of users, written in other styles than the built-in one: other names, frames, shapes and drives.

All of them are the rig that their function says, so that eq. 14 holds in them up to their contacts.
"""

from __future__ import annotations

from pathlib import Path

from analytic.rig import Rig
from harness.recording.scene_files import scene_of
from harness.scene import Scene

FLAT = Rig(rolling_radius=Rig.radius)
HALF = 2.0  # of the tracks' length [m]
OPTION = '<option cone="elliptic" gravity="0 0 -9.81" impratio="10"/>'
# Hard contacts: 2 dt of a time step of 1 ms is MuJoCo's shortest time constant, the impedance leaves 1 % of a force.
CONTACT = 'solref="0.002 1" solimp="0.99 0.99 0.001" friction="0.7 0 0" condim="3"'


def flat_track(*, joint: str = 'type="hinge" axis="1 0 0"', ball: str = "", option: str = OPTION) -> str:
    """A ball on a plank along the world's y axis: +s is towards −y where α grows with the joint's angle.

    The pivot stands at a height of half a metre, the plank lies 20 mm beside it.
    """
    r, h = FLAT.radius, FLAT.eccentricity
    return f"""
<mujoco model="plank">
  <compiler angle="radian"/>
  {option}
  <worldbody>
    <geom name="table" type="plane" size="2 2 0.1" pos="0 0 -0.5"/>
    <body name="seesaw" pos="0.1 0.2 0.5">
      <joint name="bearing" {joint}/>
      <geom name="plank" type="box" size="0.03 {HALF} 0.005" pos="0.02 0 {h - 0.005:.9g}" mass="0.6" {CONTACT}/>
      <geom name="shaft" type="cylinder" size="0.005 0.06" euler="0 1.5707963 0" mass="0.1"/>
    </body>
    <body name="marble" pos="0.12 0.56 {0.5 + h + r + 0.01}">
      <freejoint/>
      <inertial pos="0 0 0" mass="{FLAT.mass}" diaginertia="{FLAT.inertia} {FLAT.inertia} {FLAT.inertia}"/>
      <geom type="sphere" size="{r}" {CONTACT} {ball}/>
      <geom type="sphere" size="{r}" rgba="1 0 0 1" contype="0" conaffinity="0" group="1"/>
    </body>
  </worldbody>
</mujoco>
"""


def prism(rig: Rig, side: float) -> str:
    """An OBJ file of a rail with the section of a wedge, whose sharp edge carries the ball; |y| falls towards it."""
    w, h = rig.half_gap, rig.eccentricity
    section = [(w, h), (w + 0.004, h - 0.006), (w, h - 0.012)]
    points = [(x, side * y, z) for x in (-HALF, HALF) for y, z in section]
    faces = [(1, 2, 3), (4, 6, 5), (1, 4, 5), (1, 5, 2), (2, 5, 6), (2, 6, 3), (3, 6, 4), (3, 4, 1)]
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in points]
    order = 1 if side > 0 else -1
    return "\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in (face[::order] for face in faces))]) + "\n"


def mesh_rails(rig: Rig) -> str:
    """The paper's groove with rails that are meshes, in a file of its own that is included."""
    return f"""
<mujoco model="mesh rails">
  <compiler angle="degree" meshdir="parts"/>
  {OPTION}
  <include file="rails.xml"/>
  <worldbody>
    <body name="arm">
      <joint name="tilt" type="hinge" axis="0 1 0" damping="0.3"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
      <geom name="left" type="mesh" mesh="left" {CONTACT}/>
      <geom name="right" type="mesh" mesh="right" {CONTACT}/>
    </body>
    <body name="bearing_ball" pos="0.3 0 {rig.eccentricity + rig.rolling_radius}">
      <freejoint name="free"/>
      <inertial pos="0 0 0" mass="{rig.mass}" diaginertia="{rig.inertia} {rig.inertia} {rig.inertia}"/>
      <geom name="steel" type="sphere" size="{rig.radius}" {CONTACT}/>
    </body>
  </worldbody>
  <actuator>
    <position name="servo" joint="tilt" kp="50"/>
  </actuator>
</mujoco>
"""


def crank_and_link(rig: Rig) -> str:
    """The paper's groove of two boxes, lifted at s = 0.4 m by a link from a crank of 60 mm."""
    w, h, arm, crank, rod = rig.half_gap, rig.eccentricity, 0.4, 0.06, 0.25
    wall = 0.001
    rails = "\n".join(
        f'<geom name="{name}" type="box" size="{HALF} {wall} 0.006" pos="0 {side * (w + wall):.9g} {h - 0.006:.9g}" '
        f"{CONTACT}/>"
        for name, side in (("rail_a", 1), ("rail_b", -1))
    )
    # The crank's pin lies level with its shaft where the beam is level, the rod stands upright on it.
    stiff = 'solref="0.002 1" solimp="0.9999 0.9999 0.001"'
    return f"""
<mujoco model="crank and link">
  <compiler angle="radian"/>
  <option cone="elliptic" timestep="0.001"/>
  <worldbody>
    <body name="beam">
      <joint name="beam_hinge" type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="0.8" diaginertia="0.05 0.05 0.05"/>
      {rails}
    </body>
    <body name="wheel" pos="{arm - crank} 0.1 {-rod}">
      <joint name="motor" type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>
      <body name="rod" pos="{crank} 0 0">
        <joint name="crank_pin" type="hinge" axis="0 1 0"/>
        <inertial pos="0 0 {0.5 * rod}" mass="0.05" diaginertia="3e-4 3e-4 1e-5"/>
      </body>
    </body>
    <body name="ball" pos="0.3 0 {h + rig.rolling_radius}">
      <freejoint/>
      <inertial pos="0 0 0" mass="{rig.mass}" diaginertia="{rig.inertia} {rig.inertia} {rig.inertia}"/>
      <geom type="sphere" size="{rig.radius}" {CONTACT}/>
    </body>
  </worldbody>
  <equality>
    <connect name="rod_end" body1="rod" body2="beam" anchor="0 0 {rod}" {stiff}/>
  </equality>
  <actuator>
    <position joint="motor" kp="5"/>
  </actuator>
</mujoco>
"""


def written(folder: Path, text: str, **names: object) -> Scene:
    """A scene of one MJCF file in `folder`; names as in the table [scene]."""
    (folder / "own.xml").write_text(text, encoding="utf-8")
    return scene_in(folder, mjcf="own.xml", **names)


def scene_in(folder: Path, **names: object) -> Scene:
    """The scene of the files in `folder`, names as in the table [scene]."""
    table: dict[str, object] = {
        "mjcf": None,
        "urdf": None,
        "ball_urdf": None,
        "beam_joint": "pivot",
        "ball": "ball",
        "direction": 1,
        "level_joint_angle": 0.0,
        "driven_joint": None,
    }
    return scene_of(folder / "rig.toml", **(table | names))  # type: ignore[arg-type]


def write_mesh_rails(folder: Path, rig: Rig) -> Scene:
    """The scene with mesh rails and its files."""
    (folder / "parts").mkdir(exist_ok=True)
    for name, side in (("left", 1.0), ("right", -1.0)):
        (folder / "parts" / f"{name}.obj").write_text(prism(rig, side), encoding="utf-8")
    assets = '<mujoco><asset><mesh name="left" file="left.obj"/><mesh name="right" file="right.obj"/></asset></mujoco>'
    (folder / "rails.xml").write_text(assets, encoding="utf-8")
    return written(folder, mesh_rails(rig), beam_joint="tilt", ball="bearing_ball")


def plank_urdf(rig: Rig, shape: str = '<plane normal="0 0 1"/>') -> str:
    """A plank on a hinge for PyBullet; its joint turns the other way round, +s is along x."""
    h = rig.eccentricity
    return f"""<?xml version="1.0"?>
<robot name="plank">
  <link name="stand"/>
  <link name="plank">
    <inertial><mass value="0.6"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 {h}"/><geometry>{shape}</geometry></collision>
  </link>
  <joint name="bearing" type="revolute">
    <parent link="stand"/><child link="plank"/><origin xyz="0.1 0.2 0.5"/><axis xyz="0 -1 0"/>
    <limit lower="-0.5" upper="0.5" effort="10" velocity="10"/>
  </joint>
</robot>
"""


def grooved_urdf(rig: Rig) -> str:
    """Two square bars on a hinge for PyBullet, a face of each tangent to the ball."""
    width, lean = 0.003, rig.contact_angle
    stretch = (rig.radius + 0.5 * width) / rig.radius
    across, high = rig.half_gap * stretch, rig.eccentricity + rig.rolling_radius * (1.0 - stretch)
    bars = "".join(
        f'<collision><origin xyz="0 {side * across:.9g} {high:.9g}" rpy="{side * lean:.9g} 0 0"/>'
        f'<geometry><box size="{2 * HALF} {width} {width}"/></geometry></collision>'
        for side in (1, -1)
    )
    return f"""<robot name="bars"><link name="foot"/>
<link name="bars"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
{bars}</link>
<joint name="swing" type="continuous"><parent link="foot"/><child link="bars"/><axis xyz="0 1 0"/></joint></robot>
"""
