"""Packages that only some formats need."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.importing import matlab_process, read_file
from tests.importing import made


@pytest.mark.parametrize(
    ("name", "package", "extra"),
    [("v73.mat", "h5py", "files"), ("book.xlsx", "openpyxl", "files"), ("log.mcap", "rosbags.typesys", "ros")],
)
def test_a_missing_package_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, package: str, extra: str
) -> None:
    """Say which extra to install where a format's package is missing."""
    path = tmp_path / name
    if name in made.FILES:
        made.FILES[name][0](path)
    else:
        path.write_bytes(b"\x89MCAP0\r\n")
    monkeypatch.setitem(sys.modules, package, None)
    (tmp_path / "without").mkdir()  # what a process of its own, which reads MAT-files, finds instead
    (tmp_path / "without" / f"{package}.py").write_text("raise ImportError", encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "without"))
    monkeypatch.setattr(matlab_process, "_started", None)
    with pytest.raises(InputError, match=rf"pip install 'ball-beam-harness\[{extra}\]'"):
        read_file(path)
    matlab_process._end()  # the one without the package
