"""The settings file of a tuned engine: what it says is what `--parameters` reads."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.engines.catalogue import read_settings
from harness.errors import InputError
from harness.recording import load_case
from harness.recording.rig_changes import rig_changes, with_rig_changes
from harness.tuning.settings_file import settings_text


def test_settings_and_scene_are_read_back(tmp_path: Path) -> None:
    """Return every digit of every number, choices and what is not set."""
    settings = {"friction": 0.0123456789, "condim": 6, "cone": "elliptic", "refsafe": True, "margin": None}
    file = tmp_path / "tuned.toml"
    text = settings_text("mujoco", settings, {"level_angle_rad": -0.002, "rolling_radius_m": 0.0117}, "a\nb")
    file.write_text(text, encoding="utf-8")
    assert read_settings(file, ()) == {"mujoco": settings}
    assert rig_changes(file) == {"level_angle": -0.002, "rolling_radius": 0.0117}


def test_a_case_takes_quantities_of_the_rig_and_says_so(tmp_path: Path) -> None:
    """Replace quantities of rig.toml, and note which."""
    file = tmp_path / "tuned.toml"
    file.write_text("[rig]\nlevel_angle_rad = 0.001\n", encoding="utf-8")
    case = load_case("paper_protocol")
    changed = with_rig_changes(case, file)
    assert changed.rig.level_angle == 0.001
    assert changed.rig.rolling_radius == case.rig.rolling_radius
    assert (dict(case.rig_from), dict(changed.rig_from)) == ({}, {"level_angle": "tuned.toml"})
    assert any(one.code == "rig-changes" and "level angle 0.001" in one.text for one in changed.findings)
    assert with_rig_changes(case, None) is case


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[rig]\nlevel_angel_rad = 0.1\n", "Did you mean 'level_angle_rad'"),
        ('[rig]\nlevel_angle_rad = "a"\n', "give a number"),
        ("rig = 3\n", "is not a table"),
        ("[rig]\nrolling_radius_m = 1.0\n", "impossible rig"),
        ("[rig\n", "not valid TOML"),
    ],
)
def test_a_bad_table_is_refused(tmp_path: Path, text: str, told: str) -> None:
    """Name file and fault."""
    file = tmp_path / "tuned.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=told) as raised:
        with_rig_changes(load_case("paper_protocol"), file)
    assert str(file) in str(raised.value)
