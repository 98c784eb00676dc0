"""The files of a user's scene are found within the case, hashed, and never followed outside."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path

import pytest

from analytic.rig import Rig
from harness.errors import InputError
from harness.recording.case import BUNDLED, load_case
from tests.own_scenes import scene_in, write_mesh_rails

PLAIN = "<mujoco><worldbody/></mujoco>"


def test_included_files_and_meshes_belong_to_the_scene(tmp_path: Path) -> None:
    """Hash the main file, what it includes, and the meshes in a folder of their own."""
    scene = write_mesh_rails(tmp_path, Rig())
    assert set(scene.sha256) == {"own.xml", "rails.xml", "parts/left.obj", "parts/right.obj"}
    for name, digest in scene.sha256.items():
        assert digest == hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<mujoco><include file="../other.xml"/></mujoco>', r"<include> names '\.\./other\.xml', outside"),
        ('<mujoco><asset><mesh file="/etc/hostname"/></asset></mujoco>', "names '/etc/hostname', outside"),
        ('<mujoco><asset><mesh file="raill.obj"/></asset></mujoco>', "no file .*raill.obj.* Did you mean 'rail.obj'"),
        ('<!DOCTYPE a [<!ENTITY b SYSTEM "/etc/hostname">]><mujoco>&b;</mujoco>', "document type"),
        ("<mujoco><worldbody></mujoco>", "not valid XML.*mismatched tag"),
        ('<?xml version="1.0" encoding="no-such"?><mujoco/>', "unknown encoding.*Save it as UTF-8"),
        (
            '<mujoco><asset><model name="m" file="own.xml"/></asset></mujoco>',
            "names 'own.xml', which this file is",
        ),
        ('<mujoco><asset><hfield nrow="100000" ncol="100000"/></asset></mujoco>', r"<hfield> has 1e\+10 parts"),
        ('<mujoco><worldbody><replicate count="1000000"/></worldbody></mujoco>', r"<replicate> has 1e\+06 parts"),
        ('<robot><link><geometry><sphere radius="-1"/></geometry></link></robot>', "<sphere> has radius='-1'"),
        ('<robot><mesh filename="package://rig/rail.obj"/></robot>', "by its path relative to"),
    ],
    ids=[
        "include outside",
        "mesh outside",
        "missing mesh",
        "entity",
        "not XML",
        "encoding",
        "itself",
        "field",
        "replicas",
        "radius",
        "package",
    ],
)
def test_what_lies_outside_or_is_no_scene_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """Refuse the file with a message that names it."""
    folder = tmp_path / "case"
    folder.mkdir()
    (tmp_path / "other.xml").write_text(PLAIN, encoding="utf-8")
    (folder / "rail.obj").write_text("v 0 0 0\n", encoding="utf-8")
    (folder / "own.xml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        scene_in(folder, mjcf="own.xml")
    assert "own.xml" in str(caught.value)


def test_link_that_leads_outside_is_refused(tmp_path: Path) -> None:
    """Refuse a symbolic link to a file elsewhere."""
    folder = tmp_path / "case"
    folder.mkdir()
    (tmp_path / "other.xml").write_text(PLAIN, encoding="utf-8")
    (folder / "own.xml").symlink_to(tmp_path / "other.xml")
    with pytest.raises(InputError, match="outside"):
        scene_in(folder, mjcf="own.xml")


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('[scene]\nbeam_joint = "pivot"\n', "names no scene"),
        ('[scene]\nmjcf = "own.xml"\ndirection = 2\n', r"\[scene\] direction = 2: write 1 or -1"),
        ('[scene]\nmjfc = "own.xml"\n', "Did you mean 'mjcf'"),
        ('[scene]\nurdf = "own.xml"\ndriven_joint = "crank"\n', "no closed loops"),
        ('[scene]\nmjcf = "own.xml"\nball_urdf = "own.xml"\n', "ball_urdf without urdf"),
        ('[scene]\nmjcf = "own.xlm"\n', "Did you mean 'own.xml'"),
    ],
    ids=["no file", "direction", "typo", "crank in URDF", "ball alone", "missing"],
)
def test_table_scene_is_checked(tmp_path: Path, table: str, message: str) -> None:
    """Refuse a table that cannot be meant, with its key and what to write."""
    shutil.copy(BUNDLED / "rec_01.csv", tmp_path)
    (tmp_path / "own.xml").write_text(PLAIN, encoding="utf-8")
    (tmp_path / "rig.toml").write_text(f'[recordings]\nidentify = ["rec_01.csv"]\n\n{table}', encoding="utf-8")
    with pytest.raises(InputError, match=message):
        load_case(tmp_path)


def test_scene_is_measured_where_the_ball_rolls(tmp_path: Path) -> None:
    """Take the median of all recorded positions, which lie between 0.1 and 0.6 m."""
    shutil.copy(BUNDLED / "rec_01.csv", tmp_path)
    (tmp_path / "own.xml").write_text(PLAIN, encoding="utf-8")
    (tmp_path / "rig.toml").write_text('[scene]\nmjcf = "own.xml"\n', encoding="utf-8")
    case = load_case(tmp_path)
    assert case.scene is not None
    assert case.scene.rolls_at is not None
    assert 0.1 < case.scene.rolls_at < 0.6
