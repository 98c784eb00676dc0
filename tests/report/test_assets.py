"""Libraries kept in the repository are what their version files say."""

import hashlib
import tomllib
from pathlib import Path

import pytest

import harness.report.assets as assets

UPLOT = Path(assets.__file__).parent / "uplot"
AXE = Path(__file__).parent / "axe"


@pytest.mark.parametrize("folder", [UPLOT, AXE])
def test_libraries_are_unchanged(folder):
    """Keep each vendored file as published, with its licence beside it."""
    for name, sha256 in tomllib.loads((folder / "VERSION.toml").read_text(encoding="utf-8"))["sha256"].items():
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == sha256, name
    assert (folder / "LICENSE").is_file()


def test_scripts_cannot_end_their_element():
    """Write no end tag within scripts, which would end them early."""
    assert "</script" not in assets.scripts(charts=True).lower()


def test_a_page_without_charts_has_no_library():
    """Leave the library out of pages that draw nothing."""
    assert "uPlot" not in assets.scripts(charts=False)
