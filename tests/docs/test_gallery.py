"""The gallery: its page is that of its code, its pictures are small, and README shows them."""

from __future__ import annotations

import re
import runpy
import shlex
from pathlib import Path
from typing import Any

import pytest
from click import Command, Group
from PIL import Image

from harness.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
GALLERY = DOCS / "gallery"
WIDEST, LARGEST = 1200, 150_000  # [px], [bytes]


@pytest.fixture(scope="module")
def made() -> dict[str, Any]:
    """The names of docs/make_gallery.py."""
    return runpy.run_path(str(DOCS / "make_gallery.py"))


def test_the_page_is_up_to_date(made: dict[str, Any]) -> None:
    """Have the page that `make gallery` writes, which says of each picture whether its data are simulated."""
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == made["text"]()
    assert all(one.data.startswith(("Simulated data: ", "Measured data: ")) for one in made["ENTRIES"])
    assert sum(one.data.startswith("Measured") for one in made["ENTRIES"]) == 1


def test_pictures_are_there_and_small(made: dict[str, Any]) -> None:
    """Have a picture an entry and no others, that can be decoded and is not blank."""
    assert {path.stem for path in GALLERY.iterdir()} == {one.name for one in made["ENTRIES"]}
    for path in GALLERY.iterdir():
        with Image.open(path) as image:
            assert image.width <= WIDEST
            assert len(image.convert("RGB").getcolors(maxcolors=1 << 24)) > 50
        assert path.stat().st_size <= LARGEST


def test_commands_are_those_that_there_are(made: dict[str, Any]) -> None:
    """Name commands and options of the harness."""
    assert isinstance(main, Group)
    harness = [command for one in made["ENTRIES"] for command in one.commands if command.startswith("harness ")]
    assert len(harness) >= 4
    for command in harness:
        _, name, *rest = shlex.split(command)
        called = main.commands[name]
        assert isinstance(called, Command)
        known = {option for parameter in called.params for option in parameter.opts}
        assert {word for word in rest if word.startswith("--")} <= known


def test_the_readme_shows_four_of_them() -> None:
    """Link four pictures on README's first screen to their headings in the gallery."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    first = readme[: readme.index("## ")]
    shown = re.findall(r"\[!\[[^]]+\]\(docs/gallery/(\w+)\.png\)\]\(docs/gallery\.md#([\w-]+)\)", first)
    assert len(shown) == 4
    heads = re.findall(r"(?m)^## (.*)$", (DOCS / "gallery.md").read_text(encoding="utf-8"))
    anchors = [re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads]
    for name, anchor in shown:
        assert (GALLERY / f"{name}.png").is_file()
        assert anchor in anchors
