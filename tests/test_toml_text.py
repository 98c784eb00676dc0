"""Whatever is wrong with a user's TOML is one message, wherever it is read."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.engines.catalogue import read_settings
from harness.errors import InputError
from harness.recording.rig_changes import rig_changes
from harness.recording.rig_file import read_rig_file
from harness.sweeps import read_spec
from harness.tolerances.file import read_tolerances
from harness.toml_text import parse_toml

TEXTS = {"a = " + "[" * 5000: "nested too deep", "a = " + "9" * 5000: "thousands of digits", "a = [": "not valid TOML"}


def settings(path: Path) -> None:
    """As `--parameters` reads a file."""
    read_settings(path, ())


@pytest.mark.parametrize("text", TEXTS)
@pytest.mark.parametrize("read", [settings, rig_changes, read_rig_file, read_spec, read_tolerances])
def test_every_reader_refuses_it(tmp_path: Path, read: Callable[[Path], object], text: str) -> None:
    """Raise one InputError that names the file and what is wrong."""
    file = tmp_path / "file.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=f"file.toml: .*{TEXTS[text]}"):
        read(file)


def test_a_good_text_is_read() -> None:
    """Give what `tomllib` gives."""
    assert parse_toml("a = 1\n[b]\nc = [1.5]") == tomllib.loads("a = 1\n[b]\nc = [1.5]")


def test_a_quantity_beyond_all_floats_is_refused(tmp_path: Path) -> None:
    """Name the key of a table [rig] whose integer is too large for a float."""
    file = tmp_path / "tuned.toml"
    file.write_text("[rig]\nmass_kg = 1" + "0" * 400, encoding="utf-8")
    with pytest.raises(InputError, match=r"tuned.toml: \[rig\] mass_kg is too large"):
        rig_changes(file)


@pytest.mark.parametrize("value", ["[" * 5000, "9" * 5000])
def test_an_option_of_such_a_value_is_no_crash(value: str) -> None:
    """Take what `--set` is given and is no TOML for a text."""
    assert read_settings(None, [f"mujoco.friction={value}"]) == {"mujoco": {"friction": value}}
