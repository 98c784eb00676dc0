"""What the page of a sweep says: in words that need no knowledge of the program."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from harness import sweep
from tests.sweeps.made import spec_file

SPEC = """
sources = ["mujoco", "cam"]
recordings = "first"
window_s = 2.0
design = "latin_hypercube"
size = 2
seed = 3
time_step = [4e-3]
[mujoco]
friction = { low = 0.3, high = 0.5 }
"""


@pytest.fixture(scope="module")
def html(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The page of a sweep over friction."""
    folder: Path = tmp_path_factory.mktemp("swept")
    done = sweep(spec_file(folder, SPEC), out=folder / "out")
    assert done.report_failures == ()
    return (folder / "out" / "sweep.html").read_text(encoding="utf-8")


def test_sections_say_what_they_are_of(html: str) -> None:
    """Call accuracy over processor time so, which is no error over the time of the recording."""
    titles = re.findall(r"<h2 [^>]*>(.*?)</h2>", html)
    assert "Accuracy and processor time" in titles
    assert not any("against time" in title for title in titles)


def test_words_are_those_of_the_field(html: str) -> None:
    """Speak of quantities that were varied, of models and engines, and of how values were drawn."""
    words = re.sub(r"<script.*?</script>|<style>.*?</style>|<[^>]+>", " ", html, flags=re.DOTALL)
    assert "Latin hypercube: values of the ranges drawn evenly" in words
    assert "2 samples, seed 3" in words
    assert "each run begins anew every 2 s" in words
    assert "model or engine" in words
    for private in ("factor", "source", "compiled kernel", "base sample"):
        assert private not in words, private


def test_captions_have_units(html: str) -> None:
    """Say in every caption what is drawn in which unit."""
    captions = re.findall(r"<figcaption>(.*?)</figcaption>", html, flags=re.DOTALL)
    assert captions
    assert all(re.search(r"\bin m\b", one) for one in captions)
