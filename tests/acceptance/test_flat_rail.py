"""A rig whose ball rolls on a flat track, from its recordings to both reports, with the engines in them."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import pytest

from analytic.rig import SOLID_SPHERE, Rig
from harness.simulator import Experiment, write_case
from tests.acceptance.conftest import Harness

BALL = Rig()
FLAT = BALL.with_(rolling_radius=BALL.radius, inertia=SOLID_SPHERE * BALL.mass * BALL.radius**2)
COEFFICIENT = 0.004


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings of 5 s with a rolling resistance, and one to predict."""
    folder = tmp_path_factory.mktemp("flat") / "case"
    hidden = {"rolling_resistance": {"coefficient": COEFFICIENT}}
    write_case(folder, Experiment(rig=FLAT, hidden=hidden, duration=5.0))
    return folder


@pytest.mark.slow
def test_run_compares_the_engines_on_a_flat_rail(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Exit with 0, have both engines within micrometres of CAM, and claim nothing twice for r = R."""
    done = harness("run", case, "--window", 1, "--out", tmp_path / "out")
    assert done.code == 0, done.err
    with (tmp_path / "out" / "trajectories.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for engine in ("mujoco", "pybullet"):
        # Each is within 1 µm of eq. 14, the kernel within 1 nm; the file has micrometres.
        assert max(abs(float(row[f"{engine}_m"]) - float(row["cam_m"])) for row in rows) < 3e-6
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    ablation = page.partition('<section id="ablation"')[2].partition("</section>")[0]
    assert "On this flat rail the ball rolls on its own radius, r = R" in ablation
    heads = re.findall(r'<th scope="col"[^>]*>(.*?)</th>', ablation.partition("</thead>")[0])
    assert [re.sub("<[^>]+>", " ", one).split("α̈") for one in heads[1:]] == [
        [f"{term} ", f" {level} "] for level in ("α₀ = 0", "α₀ fitted") for term in ("no", "with")
    ]
    assert "R → r" not in ablation
    assert ablation.count("CUM → CAM") == 1
    claims = page.partition('<section id="paper"')[2].partition("</section>")[0]
    assert "radius" not in claims


@pytest.mark.slow
def test_diagnose_validates_with_the_engines_on_a_flat_rail(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Exit with 0, find the effect, and predict as well in both engines as in CAM; predict and replay from the file."""
    done = harness("diagnose", case, "--out", tmp_path / "out")
    assert done.code == 0, done.err
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    (effect,) = found["effects"]
    size = effect["parameters"]["coefficient"]
    assert (effect["name"], found["failures"]) == ("rolling_resistance", [])
    assert size["low"] < COEFFICIENT < size["high"]
    cam = found["errors"]["heldout"]["after"]["rms_m"]
    for name in ("mujoco", "pybullet"):
        engine = found["errors"]["engines"][name]["heldout"]["after"]
        assert engine["failed"] is None
        # a state, a step of 4 ms and CAM's of 10 ms: as in tests/identify/validation/test_engine_errors.py
        assert engine["rms_m"] == pytest.approx(cam, rel=1e-2, abs=2e-5)
    assert harness("predict", tmp_path / "out", case / "rec_03.csv", "--out", tmp_path / "predicted.csv").code == 0
    assert harness("replay", tmp_path / "out", case).code == 0
