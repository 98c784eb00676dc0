"""The comparison report of a real study of a short simulated recording, in which one engine fails."""

from __future__ import annotations

import base64
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from analytic.models import MODELS
from harness.comparison import Choices, prepare, study
from harness.engines.catalogue import engine_of, parameters_of
from harness.engines.health import Failure
from harness.engines.parameters import EngineParameters
from harness.errors import EngineFailure
from harness.recording import load_case
from harness.report.comparison import SECTIONS, render_comparison
from harness.report.palette import label_of
from harness.tolerances import Checked
from tests.recording.simulated import simulated, write

pytestmark = pytest.mark.slow

RIG_FILE = """
origin = "simulated for a test"
[ball]
mass_kg = 0.071
inertia_kg_m2 = 4.948e-6
radius_m = 0.0132
[beam]
rolling_radius_m = 0.0118
eccentricity_m = 0.035
[environment]
gravity_m_s2 = 9.81
[sensors]
angle_resolution_rad = 0.000157079633
position_noise_m = 0.0003
[[declared]]
name = "rolling_resistance"
coefficient = 0.0
[recordings]
identify = ["rec_01.csv"]
predict = []
"""
MANIFEST = {"inputs": {"rec_01.csv": "0123abcd"}, "versions": {"numpy": "9.9"}, "seed": 0, "command": "harness run x"}
VOID = {"meta", "img", "br", "link"}


class Broken:
    """An engine that loses the ball in every run."""

    scene_file = ""
    name = "broken"
    parameters = EngineParameters

    def version(self) -> str:
        """Of no package."""
        return "0"

    def run(self, rig, motion, start, time, *, parameters=None, force=None, base=None):
        """Fail as engines do."""
        raise EngineFailure(self.name, Failure.LEFT_GROOVE, float(time[0]) + 0.3, Failure.LEFT_GROOVE.value)


class Page(HTMLParser):
    """Checks nesting on the way and collects ids, images and visible text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open, self.ids, self.images, self.text, self.links = [], [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        """Open an element."""
        values = dict(attributes)
        if "id" in values:
            self.ids.append(values["id"])
        if tag == "img":
            self.images.append(values)
        if tag == "a":
            self.links.append(values["href"])
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        """Close the element that was opened last."""
        assert self.open.pop() == tag, f"</{tag}> at {self.getpos()}"

    def handle_data(self, data):
        """Collect what is read, not style, scripts and their data."""
        if self.open[-1:] not in (["style"], ["script"]):
            self.text.append(data)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """The study of six seconds with one spike, through PyBullet and an engine that fails."""
    folder = tmp_path_factory.mktemp("swing")
    time, angle, position = simulated(duration=6.0)
    spiked = np.where(np.arange(len(time)) == 300, position + 0.2, position)
    write(folder / "rec_01.csv", {"time_s": time, "beam_angle_rad": angle, "ball_position_m": spiked})
    (folder / "rig.toml").write_text(RIG_FILE, encoding="utf-8")
    pybullet = engine_of("pybullet")
    engines = [(pybullet, parameters_of(pybullet, {})), (Broken(), EngineParameters())]
    return study(prepare(load_case(folder), Choices(draws=16)), engines)


@pytest.fixture(scope="module")
def html(result):
    """Its report."""
    return render_comparison(result, MANIFEST)


@pytest.fixture(scope="module")
def page(html):
    """Its report, parsed."""
    return Page(html)


@pytest.fixture(scope="module")
def text(page):
    """What a reader reads."""
    return re.sub(r"\s+", " ", "".join(page.text))


def test_it_is_well_formed(page):
    """Close every element in order, with ids that occur once and inner links that lead somewhere."""
    assert page.open == []
    assert len(set(page.ids)) == len(page.ids)
    assert all(link.startswith("#") and link[1:] in page.ids for link in page.links)


def test_it_opens_offline(html):
    """Load nothing: no script of another file, no style sheet, no address."""
    assert not re.search(r"<script[^>]* src|<link|@import|url\(|(src|href)=\"(?!data:|#)", html)
    assert len(html) < 3e6


def test_it_names_language_and_title(html):
    """Tell browsers and readers its language and title."""
    assert html.startswith("<!DOCTYPE html>")
    assert '<html lang="en">' in html
    assert "<title>Ball and beam: swing" in html


def test_every_section_is_there(page, result):
    """Show all sections but that of checks, which were not asked for."""
    anchors = [link[1:] for link in page.links[: len(SECTIONS) - 1]]
    assert anchors[0] == "answer"
    assert anchors[-1] == "reproduce"
    assert len(set(anchors)) == len(SECTIONS) - 1
    assert "checks" not in anchors


def test_every_source_is_there(text):
    """Name every model and engine, the failed one too."""
    for source in (*MODELS, "pybullet", "broken"):
        assert label_of(source) in text


def test_pictures_are_described_vector_graphics(page):
    """Give each picture a description and keep it an SVG of less than 300 kB with letters as paths."""
    assert len(page.images) >= 8
    for image in page.images:
        kind, _, data = image["src"].partition(";base64,")
        drawing = base64.b64decode(data)
        assert kind == "data:image/svg+xml"
        assert len(drawing) < 300e3
        assert b"<text" not in drawing
        assert len(image["alt"]) > 40


def test_simulated_data_are_never_called_measured(page, text):
    """Call a simulated recording simulated on the first screen and in every picture's description."""
    assert "simulated data" in text
    assert "the simulated recording" in text
    assert not any("measured" in image["alt"] for image in page.images)


def test_findings_are_there(text):
    """Show what was found in the input on the first screen, with its place."""
    assert "1 of 601 positions are outliers" in text
    assert "row 302" in text.split("How errors grow")[0]


def test_failures_are_prominent(text):
    """Name a failed engine, when and why, before anything else is said."""
    alert = text.index("broken failed at t = 0.300 s: the ball left the rails")
    assert alert < text.index("PyBullet agrees with CAM")
    assert text.index("broken failed") < alert, "the badge beside the title"


def test_what_is_not_a_number_is_a_sign(text):
    """Print — and ∞, never nan or inf."""
    assert "—" in text
    assert "∞" in text
    assert not re.search(r"\b(nan|inf)\b", text, re.IGNORECASE)


def test_a_perfect_model_is_recognised(text):
    """Find CAM closest to what CAM made, within the uncertainty, and send nobody after physics."""
    assert "CAM and PyBullet are closest to the simulated recording" in text
    assert "no evidence against it" in text


def test_declared_effects_are_there(text):
    """Say which effects are declared, and that every model holds them."""
    assert re.search(r"rolling_resistance \(coefficient = 0[.0]*\)", text)
    assert "every model and engine" in text


def test_the_paper_is_answered(text):
    """Judge all three claims and print Table 2."""
    for words in ("(a) CUM and CAM are very sensitive", "(b) modelling the eccentric", "(c) a friction term", "0.2837"):
        assert words in text


def test_it_can_be_reproduced(text):
    """Print the command, the hashes and the versions."""
    for words in ("harness run x", "0123abcd", "versions.numpy", "9.9"):
        assert words in text


def test_checks_are_shown_missed_first(result):
    """List every limit with its value, the missed ones first, and say so beside the title."""
    checks = [
        Checked("cam", "whole", "rms_error_mm", "mm", False, "<=", 0.4, 1.0, True, 0.6, "", "a"),
        Checked("cum", "whole", "rms_error_mm", "mm", False, "<=", 9.0, 5.0, False, -0.8, "", "b"),
    ]
    text = re.sub(r"\s+", " ", "".join(Page(render_comparison(result, MANIFEST, checks=checks)).text))
    assert "1 check failed" in text
    table = text[text.index("1 of 2 limits") :]
    assert table.index("CUM") < table.index("CAM")
