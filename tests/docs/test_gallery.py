"""The gallery: its page is that of its code and results, its pictures are small, and README shows and quotes them."""

from __future__ import annotations

import json
import re
import runpy
import shlex
from typing import Any

import pytest
from click import Command, Group
from PIL import Image

from harness.cli.main import main
from tests.docs.pages import ROOT

DOCS = ROOT / "docs"
GALLERY = DOCS / "gallery"
WIDEST, LARGEST = 1200, 150_000  # [px], [bytes]


@pytest.fixture(scope="module")
def made() -> dict[str, Any]:
    """The names of docs/make_gallery.py."""
    return runpy.run_path(str(DOCS / "make_gallery.py"))


@pytest.fixture(scope="module")
def answers(made: dict[str, Any]) -> dict[str, list[str]]:
    """What the commands said when the pictures were taken, by entry."""
    return json.loads(made["ANSWERS"].read_text(encoding="utf-8"))


def test_the_page_is_up_to_date(made: dict[str, Any], answers: dict[str, list[str]]) -> None:
    """Have the page that `make gallery` writes of its results; it says of each picture if its data are simulated."""
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == made["text"](answers)
    assert all(one.data.startswith(("Simulated data: ", "Measured data: ")) for one in made["ENTRIES"])
    assert sum(one.data.startswith("Measured") for one in made["ENTRIES"]) == 1


def test_pictures_are_there_and_small(made: dict[str, Any]) -> None:
    """Have a picture an entry and no others, that can be decoded and is not blank."""
    pictures = sorted(GALLERY.glob("*.png"))
    assert {*GALLERY.iterdir()} == {*pictures, made["ANSWERS"]}
    assert {path.stem for path in pictures} == {one.name for one in made["ENTRIES"]}
    for path in pictures:
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


def test_a_line_that_no_longer_comes_is_noticed(made: dict[str, Any]) -> None:
    """Refuse to write a page whose words the command contradicts."""
    entry = next(one for one in made["ENTRIES"] if one.name == "diagnosis_measured")
    with pytest.raises(ValueError, match="diagnosis_measured: no line begins with A rolling resistance"):
        made["quoted"](entry, "No missing effect was found.\n")


def test_the_readme_quotes_the_measured_rig_as_its_results_say(answers: dict[str, list[str]]) -> None:
    """Quote sizes and errors of the command's sentence, and errors of the rig's page, rounded to millimetres."""
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    (sentence,) = answers["diagnosis_measured"]
    page = (DOCS / "measured_rigs" / "open_ball_beam.md").read_text(encoding="utf-8")
    assert sentence in page
    found = re.fullmatch(
        r"A rolling resistance of (\S+ ± \S+) and a lag of (\S+ ± \S+ ms) .* from (\S+) mm to (\S+) mm\.", sentence
    )
    assert found is not None
    assert f"a rolling resistance of {found[1]} and a lag of {found[2]} of the beam" in readme
    assert f"the command's own sentence says {found[3]} and {found[4]} mm" in readme
    table = page.split("## Held-out errors")[1].split("## ")[0]
    errors = {name: float(rms) for name, rms in re.findall(r"(?m)^\| ([^|]+) \| ([\d.]+) \|", table)}
    before, after = errors.pop("model with what is known"), errors.pop("model with the effects found")
    black_boxes = min(value for name, value in errors.items() if name.startswith("output-error model"))
    assert f"the RMS error falls from {before:.0f} to {after:.1f} mm" in readme
    assert f"a ball at rest errs by {errors['ball at rest']:.0f} mm" in readme
    assert f"at constant velocity by {errors['ball at constant velocity']:.0f} mm" in readme
    assert f"a double integrator by {errors['double integrator']:.0f} mm" in readme
    assert f"black boxes fitted to the forecast by {black_boxes:.0f} mm and more" in readme
