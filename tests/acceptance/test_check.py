"""`harness check` as a user types it: fit or not, what it prints and writes, what it refuses."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

import harness as package
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case
from tests.recording.in_water import water


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two simulated recordings of 3 s."""
    return write_short_case(tmp_path_factory.mktemp("short"))


@pytest.mark.slow
def test_a_good_case_is_fit_and_its_effects_are_listed(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Print the answer and the limits, write page and record, and end with 0."""
    done = harness("check", case, "--out", tmp_path / "out")
    assert done.code == 0, done.err
    assert "Fit for use: " in done.out
    assert "Detection limits" in done.out
    assert "rolling_resistance" in done.out
    page = (tmp_path / "out" / "check.html").read_text(encoding="utf-8")
    assert "What these recordings can show" in page
    assert not re.search(r"(?:src|href|url\()\W{0,2}https?:", page)  # opens offline
    kept = json.loads((tmp_path / "out" / "check.json").read_text(encoding="utf-8"))
    assert kept["fit"] is True
    assert {"effect", "limit", "limit_explained", "typical", "unit", "alike"} <= set(kept["effects"][0])


@pytest.mark.slow
def test_json_is_one_document_and_quiet_a_line(harness: Harness, case: Path) -> None:
    """Print JSON alone on stdout, and with --quiet the answer alone and no progress."""
    assert json.loads(harness("check", case, "--json").out)["fit"] is True
    quiet = harness("check", case, "--quiet")
    assert quiet.out.count("\n") == 1
    assert quiet.err == ""


def turned(case: Path, folder: Path, *, known: int = 1, every: int = 1) -> Path:
    """The case with angles of the other sign in a folder of its own, and the first `known` of `every` positions."""
    folder.mkdir()
    for file in case.iterdir():
        text = file.read_text(encoding="utf-8")
        if file.suffix == ".csv":
            head, *rows = text.strip().splitlines()
            angle, position = (head.split(",").index(name) for name in ("beam_angle_rad", "ball_position_m"))
            cells = [row.split(",") for row in rows]
            for number, one in enumerate(cells):
                one[angle] = repr(-float(one[angle]))
                one[position] = one[position] if number % every < known else ""
            text = "\n".join([head, *map(",".join, cells)]) + "\n"
        (folder / file.name).write_text(text, encoding="utf-8")
    return folder


def test_a_reversed_sign_is_not_fit(harness: Harness, case: Path, tmp_path: Path) -> None:
    """End with 1 and name the finding when angle and position contradict each other."""
    done = harness("check", turned(case, tmp_path / "turned"))
    assert done.code == 1
    assert "Not fit for use" in done.out
    assert "[angle-sign]" in done.out


def test_a_reversed_sign_that_the_rig_alone_shows_is_not_fit(harness: Harness, tmp_path: Path) -> None:
    """End with 1, name the case and write page and record where K of an unknown rig comes out negative.

    Positions in bursts of 0.1 s are too short for the sign to be seen at the start.
    """
    unknown = write_short_case(tmp_path / "short", known={}, duration=6.0)
    reversed_, out = turned(unknown, tmp_path / "reversed", known=10, every=40), tmp_path / "out"
    done = harness("check", reversed_, "--out", out, "--json")
    assert done.code == 1, done.err
    (reason,) = json.loads(done.out)["reasons"]
    assert reason.startswith(
        f"{reversed_}: the recordings show a ball that does not roll down the recorded angle (K = -"
    )
    assert "the sign of angle or position is reversed" in reason
    assert json.loads((out / "check.json").read_text(encoding="utf-8"))["reasons"] == [reason]
    assert "the sign of angle or position is reversed" in (out / "check.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_ratio_that_no_ball_has_is_warned_of(harness: Harness, tmp_path: Path) -> None:
    """Say in the check, too, that the ball accelerates as none does on any track, as in water or behind a crank."""
    done = harness("check", water(tmp_path / "water", ratio=0.09, damping=3.0, delay=0.0))
    assert "but a ball, solid or hollow, has 0.12 to 0.71 on any track" in " ".join(done.out.split())
    assert "[rig-contradicted]" in done.out


def test_too_few_positions_are_not_fit(harness: Harness, tmp_path: Path) -> None:
    """End with 1 when no recording has 20 positions."""
    rows = [f"{0.01 * k:.2f},{0.03 * math.sin(0.05 * k):.6f},{0.3 + 1e-4 * k if k < 10 else ''}" for k in range(300)]
    file = tmp_path / "few.csv"
    file.write_text("\n".join(["time_s,beam_angle_rad,ball_position_m", *rows]) + "\n", encoding="utf-8")
    done = harness("check", file)
    assert done.code == 1
    assert "Too few positions: the best recording has 10" in done.out


def test_what_cannot_be_read_is_bad_input(harness: Harness, tmp_path: Path) -> None:
    """End with 2 and one message when there is no such case, and write nothing."""
    done = harness("check", tmp_path / "nowhere", "--out", tmp_path / "out")
    assert done.code == 2
    assert "nowhere" in done.err
    assert not (tmp_path / "out").exists()


def test_a_foreign_file_is_not_replaced(
    harness: Harness, case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """End with 2 before anything is computed, and keep a check.html that the command did not write."""
    monkeypatch.setattr("harness.identify.pose.problem_of", pytest.fail)
    (tmp_path / "check.html").write_text("mine", encoding="utf-8")
    assert harness("check", case, "--out", tmp_path).code == 2
    assert harness("check", case, "--out", tmp_path / "check.html").code == 2
    assert (tmp_path / "check.html").read_text(encoding="utf-8") == "mine"


def test_the_function_gives_a_table(case: Path) -> None:
    """Give one row an effect with positive limits where there are any, and the answer as text."""
    made = package.check(case)
    assert made.fit
    assert len(made.effects) > 15
    assert (made.effects.limit >= made.effects.limit_explained)[~made.effects.shows_below_limit].all()
    assert made.sentence in repr(made)
