"""`harness.check`: what is kept of a check where effects would not show."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from harness.api.case import load_case
from harness.api.check import FILE, REPORT, Check
from harness.identify.design.choose import choose_to_detect
from harness.identify.design.detection import detection_limits
from harness.identify.pose import problem_of
from harness.recording.own_files import NEXT_EXPERIMENT
from tests.acceptance.short import write_short_case


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


def test_a_check_is_replaced_by_the_next(unseen: Check, tmp_path: Path) -> None:
    """Replace its own files without being forced to."""
    unseen.save(tmp_path)
    unseen.save(tmp_path)
    assert (tmp_path / FILE).is_file()
