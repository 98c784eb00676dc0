"""`harness.check`: what is kept of a check where effects would not show."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from harness.api.case import load_case
from harness.api.check import FILE, REPORT, Check
from harness.identify.design.choose import choose_to_detect
from harness.identify.design.detection import detection_limits
from harness.identify.pose import problem_of
from harness.identify.validation.at_rest import AgainstRest
from harness.recording.own_files import NEXT_EXPERIMENT
from tests.acceptance.short import write_short_case

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def unseen(tmp_path_factory: pytest.TempPathFactory) -> Check:
    """A check of 3 s of a simulated rig as if no effect had shown, with the motion that is then proposed."""
    case = load_case(write_short_case(tmp_path_factory.mktemp("short")))
    problem = problem_of(case)
    found = detection_limits(problem)
    nothing = tuple(one if one.inverse else replace(one, explained=2.0 * one.typical) for one in found.limits)
    proposal = choose_to_detect(problem, found.base, [one.effect for one in nothing if not one.seen])
    assert proposal is not None
    return Check(case, (), replace(found, limits=nothing), proposal)


def test_a_proposed_motion_is_drawn_and_kept(unseen: Check, tmp_path: Path) -> None:
    """Write the angle to record next, name its profile on the page, and fail in no section."""
    unseen.save(tmp_path)
    assert {one.name for one in tmp_path.iterdir() if not one.name.startswith(".")} == {
        FILE,
        REPORT,
        NEXT_EXPERIMENT,
    }
    table = pd.read_csv(tmp_path / NEXT_EXPERIMENT)
    assert {"time_s", "beam_angle_rad"} <= set(table.columns)
    page = (tmp_path / REPORT).read_text(encoding="utf-8")
    assert unseen.proposal is not None
    assert f"The profile “{unseen.proposal.profile.name}”" in page
    assert "Not everything worked" not in page
    assert "To detect more effects" in repr(unseen)


def test_a_model_worse_than_a_ball_at_rest_is_told(unseen: Check, tmp_path: Path) -> None:
    """Say in the answer, on the page and in the record that 1 s is predicted worse than a ball at rest would be."""
    worse = replace(unseen, ahead=AgainstRest(0.0409, 0.0278))
    told = "predicts worse than a ball at rest would: RMS error 40.9 mm, of a ball that stays where it is 27.8 mm."
    assert told in worse.sentence
    worse.save(tmp_path)
    page = (tmp_path / REPORT).read_text(encoding="utf-8")
    assert "predicts worse than a ball at rest would" in page
    assert "worse than a ball at rest" in page.partition("</h1>")[0]  # a badge
    kept = json.loads((tmp_path / FILE).read_text(encoding="utf-8"))
    assert kept["error_over_1_s"] == {"model": 0.0409, "at_rest": 0.0278}
    assert "at rest" not in replace(unseen, ahead=AgainstRest(0.01, 0.0278)).sentence


def test_a_check_is_replaced_by_the_next(unseen: Check, tmp_path: Path) -> None:
    """Replace its own files without being forced to."""
    unseen.save(tmp_path)
    unseen.save(tmp_path)
    assert (tmp_path / FILE).is_file()
