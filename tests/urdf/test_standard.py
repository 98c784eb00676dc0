"""The URDF is standard URDF: urdfdom, the standard's own parser, finds nothing to object to."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from analytic.geometry import RAIL_REACH, channel_of
from analytic.rig import Rig
from urdf.scene import BALL_FILE, BEAM_FILE, ball_urdf, beam_urdf

PAPER = Rig()
SMALL = Rig(radius=0.01, rolling_radius=0.007, inertia=2.84e-6, eccentricity=-0.02)
FLAT = PAPER.with_(rolling_radius=PAPER.radius)
LONG = channel_of(PAPER, x_from=-RAIL_REACH, x_to=RAIL_REACH)
TEXTS = {
    "committed beam": BEAM_FILE.read_text(encoding="utf-8"),
    "committed ball": BALL_FILE.read_text(encoding="utf-8"),
    "beam of another rig": beam_urdf(SMALL),
    "ball of another rig": ball_urdf(SMALL),
    "beam of a flat rail": beam_urdf(FLAT),
    "driven beam": beam_urdf(PAPER, LONG, driven=True),
}
SCRIPTS = Path(sysconfig.get_path("scripts"))


@pytest.fixture(params=["of the lock", "of the system"])
def check_urdf(request: pytest.FixtureRequest) -> Path:
    """The program check_urdf: package cmeel-urdfdom of the lock, and an older urdfdom where the system has one."""
    if request.param == "of the lock":
        if sys.platform == "win32":
            pytest.skip("cmeel-urdfdom has no wheel for Windows")
        return SCRIPTS / "check_urdf"  # not there: an error, not a skip
    folders = [folder for folder in os.environ["PATH"].split(os.pathsep) if Path(folder) != SCRIPTS]
    found = shutil.which("check_urdf", path=os.pathsep.join(folders))
    if found is None:
        pytest.skip("the system has no check_urdf of its own (Debian: liburdfdom-tools); that of the lock is used")
    return Path(found)


def objections(check_urdf: Path, text: str, folder: Path) -> str:
    """What urdfdom writes to stderr. It skips a shape that it does not know and still exits with 0."""
    file = folder / "scene.urdf"
    file.write_text(text, encoding="utf-8")
    done = subprocess.run([check_urdf, file], capture_output=True, text=True, check=True)
    assert "Successfully Parsed XML" in done.stdout
    return done.stderr


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS.keys())
def test_urdfdom_objects_to_nothing(check_urdf: Path, text: str, tmp_path: Path) -> None:
    """Parse every file without an error or a warning."""
    assert objections(check_urdf, text, tmp_path) == ""


def test_urdfdom_objects_to_an_extension(check_urdf: Path, tmp_path: Path) -> None:
    """Notice a capsule, which PyBullet reads and the standard does not have."""
    text = re.sub(r'<box size="[^"]*"', '<capsule radius="0.001" length="0.7"', beam_urdf(PAPER))
    assert "Could not parse" in objections(check_urdf, text, tmp_path)
