"""What a user's scene lacks or contradicts is told by name, with what to do."""

from __future__ import annotations

from pathlib import Path

import pytest

from analytic.rig import Rig
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.own_scene.checks import Check, Status, Use
from harness.engines.own_scene.engine import SceneEngine
from harness.errors import InputError
from harness.scene import Scene
from tests.own_scenes import FLAT, crank_and_link, flat_track, plank_urdf, scene_in, written

USE = Use(positions=(0.1, 0.6), angles=(-0.1, 0.1))


def engine_with(scene: Scene, name: str = "mujoco") -> SceneEngine:  # type: ignore[type-arg]
    """The engine that runs it."""
    engine = engine_of(name, scene)
    assert isinstance(engine, SceneEngine)
    return engine


def plank(folder: Path, change: tuple[str, str] = ("", ""), **names: object) -> SceneEngine:  # type: ignore[type-arg]
    """The plank with one text in its file changed."""
    text = flat_track(joint='type="hinge" axis="-1 0 0"')
    assert change[0] in text
    names = {"beam_joint": "bearing", "ball": "marble"} | names
    return engine_with(written(folder, text.replace(*change) if change[0] else text, **names))


def found(engine: SceneEngine, rig: Rig = FLAT) -> dict[str, Check]:  # type: ignore[type-arg]
    """Checks by name, the worst of each name."""
    made: dict[str, Check] = {}
    for one in engine.checks(rig, USE):
        if one.name not in made or one.status is not Status.OK:
            made[one.name] = one
    return made


def test_good_scene_has_no_error_and_no_warning(tmp_path: Path) -> None:
    """Find nothing to say of a scene that is the rig."""
    assert {one.status for one in found(plank(tmp_path)).values()} == {Status.OK}


@pytest.mark.parametrize(
    ("change", "names", "message"),
    [
        (("", ""), {"beam_joint": "bering"}, r"no joint 'bering'. Did you mean 'bearing'"),
        (("", ""), {"ball": "ball"}, r"no body 'ball'.* seesaw, marble.*\[scene\], ball"),
        (('type="hinge"', 'type="slide"'), {}, r"joint 'bearing' is of type slide.*hinge"),
        (('axis="-1 0 0"', 'axis="-1 0 0.1"'), {}, r"axis leans by 5\.7.*horizontal"),
        (("<freejoint/>", ""), {}, r"body 'marble' is not free.*<freejoint/>"),
        (
            ('<geom type="sphere" size="0.0132" solref', '<geom type="box" size="0.01 0.01 0.01" solref'),
            {},
            "collides as box",
        ),
        (('gravity="0 0 -9.81"', 'gravity="0 0 0"'), {}, "no gravity"),
        (('diaginertia="4.948e-06 4.948e-06', 'diaginertia="4.948e-06 6.9e-06'), {}, "three equal ones"),
        (
            (
                'condim="3"/>\n      <geom name="shaft"',
                'condim="3" contype="0" conaffinity="0"/>\n      <geom name="shaft"',
            ),
            {},
            "touches no part of the beam.*contype",
        ),
        (('type="plane"', 'type="plain"'), {}, "MuJoCo cannot load it"),
    ],
    ids=["joint", "ball", "slide", "axis", "not free", "no sphere", "weightless", "inertia", "no contact", "MJCF"],
)
def test_what_cannot_be_driven_is_refused_with_a_remedy(
    tmp_path: Path, change: tuple[str, str], names: dict[str, object], message: str
) -> None:
    """Break the scene in one place and read one message that names the file, the place and what to do."""
    with pytest.raises(InputError, match=message) as caught:
        list(plank(tmp_path, change, **names).checks(FLAT, USE))
    assert "own.xml" in str(caught.value)


@pytest.mark.parametrize(
    ("change", "names", "check", "status", "message"),
    [
        (("0.03 2.0 0.005", "0.03 0.45 0.005"), {}, "track", Status.ERROR, "Make the track longer"),
        (
            ('size="0.03 2.0 0.005" pos="0.02 0 ', 'size="0.03 0.5 0.005" pos="0.02 0.45 '),
            {"direction": -1},
            "track",
            Status.ERROR,
            "direction = -1",
        ),
        (('name="seesaw"', 'name="seesaw" euler="0.01 0 0"'), {}, "level", Status.ERROR, "level_joint_angle_rad = "),
        (('mass="0.071"', 'mass="0.08"'), {}, "mass", Status.WARNING, "0.08 kg in the scene, 0.071 kg in rig.toml"),
        (('mass="0.071"', 'mass="0.08"'), {}, "rolling ratio", Status.ERROR, "apart"),
        (('gravity="0 0 -9.81"', 'gravity="0 0 -9.6"'), {}, "gravity", Status.ERROR, "9.6 m/s² in the scene"),
        (('pos="0.02 0 0.03"', 'pos="0.02 0 0.04"'), {}, "eccentricity", Status.ERROR, "0.045 m in the scene"),
        (('friction="0.7 0 0"', 'friction="0.01 0 0"'), {}, "friction", Status.WARNING, "below 0.05"),
        (('condim="3"', 'condim="1"'), {}, "friction", Status.ERROR, "the ball slides"),
        (
            ("<freejoint/>", '<joint type="free" damping="0.01"/>'),
            {},
            "what brakes the ball",
            Status.WARNING,
            "Delete them",
        ),
        (
            ("<option cone", '<option density="1.2" viscosity="2e-5" cone'),
            {},
            "what brakes the ball",
            Status.WARNING,
            "medium",
        ),
        (
            ('axis="-1 0 0"', 'axis="-1 0 0" limited="true" range="-0.05 0.05"'),
            {},
            "joint limits",
            Status.WARNING,
            "widen",
        ),
        (('axis="-1 0 0"', 'axis="-1 0 0" damping="2"'), {}, "what acts on the joint", Status.WARNING, "switched off"),
        (
            ("</worldbody>", '</worldbody><actuator><position joint="bearing" kp="9"/></actuator>'),
            {},
            "what acts on the joint",
            Status.WARNING,
            "1 actuator is switched off",
        ),
    ],
    ids=[
        "short track",
        "other end",
        "not level",
        "mass",
        "K",
        "gravity",
        "height",
        "slippery",
        "no friction",
        "damped ball",
        "air",
        "limits",
        "damped joint",
        "servo",
    ],
)
def test_what_differs_from_the_rig_is_told(
    tmp_path: Path, change: tuple[str, str], names: dict[str, object], check: str, status: Status, message: str
) -> None:
    """Change the scene in one place and find the check that tells it."""
    checks = found(plank(tmp_path, change, **names))
    assert checks[check].status is status
    assert message in checks[check].text


def test_what_the_ball_touches_besides_the_beam_is_named(tmp_path: Path) -> None:
    """Put a post where the ball rests and read its name."""
    # The ball is at s = 0.36 m, y = 0.56 m of the world, its centre 0.5482 m high; the post reaches 1 mm into it.
    post = '<geom name="post" type="sphere" size="0.02" pos="0.1522 0.56 0.5482"/></worldbody>'
    checks = found(plank(tmp_path, ("</worldbody>", post)))
    assert checks["other contacts"].status is Status.ERROR
    assert "post" in checks["other contacts"].text


def test_loop_of_the_linkage_has_to_be_closed(tmp_path: Path) -> None:
    """Take the constraint away that closes the loop."""
    text = crank_and_link(Rig())
    names = {"beam_joint": "beam_hinge", "driven_joint": "motor"}
    # 0.4 m of the beam over 60 mm of the crank.
    assert "turns by 6.67 rad per rad" in found(engine_with(written(tmp_path, text, **names)), Rig())["linkage"].text
    begin, end = text.index("<equality>"), text.index("</equality>") + len("</equality>")
    with pytest.raises(InputError, match="no equality constraint"):
        list(engine_with(written(tmp_path, text[:begin] + text[end:], **names)).checks(Rig(), USE))


def test_a_linkage_that_gives_way_is_told_before_a_run(tmp_path: Path) -> None:
    """Warn of constraints as soft as MuJoCo's defaults; not of stiff ones, of which hardly any impedance is missing."""
    names = {"beam_joint": "beam_hinge", "driven_joint": "motor"}
    text, stiff = crank_and_link(Rig()), 'solref="0.002 1" solimp="0.9999 0.9999 0.001"'
    assert stiff in text
    what = "stiffness of the linkage"
    for enough in (stiff, stiff.replace("0.002", "0.02"), 'solref="0.002 1"'):  # yields of 0.02, 0.3 and 4 µrad
        assert what not in found(engine_with(written(tmp_path, text.replace(stiff, enough), **names)), Rig())
    soft = found(engine_with(written(tmp_path, text.replace(stiff, ""), **names)), Rig())[what]
    assert soft.status is Status.WARNING
    assert "by some 4e-04 rad" in soft.text  # 3.7e-4 in a run


def test_crank_that_is_too_short_is_told(tmp_path: Path) -> None:
    """Ask a crank of 60 mm at 0.4 m for 12°, which takes 83 mm."""
    scene = written(tmp_path, crank_and_link(Rig()), beam_joint="beam_hinge", driven_joint="motor")
    with pytest.raises(InputError, match=r"cannot turn the beam to α = |dead centre"):
        list(engine_with(scene).checks(Rig(), Use(angles=(-0.21, 0.21))))


@pytest.mark.parametrize(
    ("change", "names", "message"),
    [
        (("", ""), {"beam_joint": "bering"}, "Did you mean 'bearing'"),
        (('type="revolute"', 'type="fixed"'), {}, "is no hinge"),
        (('xyz="0 -1 0"', 'xyz="0 -1 0.1"'), {}, "axis leans"),
        (('<child link="plank"/>', '<child link="plonk"/>'), {}, "PyBullet cannot load it"),
    ],
    ids=["joint", "fixed", "axis", "URDF"],
)
def test_urdf_that_cannot_be_driven_is_refused(
    tmp_path: Path, change: tuple[str, str], names: dict[str, object], message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """Break the URDF in one place; nothing of Bullet's own goes to standard output."""
    text = plank_urdf(FLAT)
    (tmp_path / "plank.urdf").write_text(text.replace(*change) if change[0] else text, encoding="utf-8")
    scene = scene_in(tmp_path, **({"urdf": "plank.urdf", "beam_joint": "bearing", "direction": -1} | names))
    with pytest.raises(InputError, match=message):
        list(engine_with(scene, "pybullet").checks(FLAT, USE))
    assert capfd.readouterr().out == ""


def test_parameters_of_the_built_in_scene_are_refused_in_words(tmp_path: Path) -> None:
    """Ask for friction across the beam, which only the built-in scene has."""
    with pytest.raises(InputError, match=r"no parameter 'friction_across'.*built-in scene; here own\.xml decides it"):
        parameters_of(plank(tmp_path), {"friction_across": 0.1})


def test_engines_of_other_names_keep_the_built_in_scene(tmp_path: Path) -> None:
    """Run PyBullet's own scene where only an MJCF is named."""
    assert engine_of("pybullet", written(tmp_path, flat_track())).scene_file == ""
