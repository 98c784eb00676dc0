"""What the pages and tables of a tuning say of parameters that nothing but the user's scene sets."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.api.tuning import Tuning
from harness.engines.catalogue import engine_of
from harness.identify.pose import problem_of
from harness.recording import load_case
from harness.report.tuning import sections
from harness.simulator import Experiment, write_case
from harness.tuning.tune import tune
from tests.own_scenes import FLAT, flat_track

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def tuning(tmp_path_factory: pytest.TempPathFactory) -> Tuning:
    """Friction and time constant of a user's plank, fitted to a recording of 5 s."""
    folder: Path = tmp_path_factory.mktemp("own") / "case"
    hidden = {"contact_slip": {"friction_coefficient": 0.0085}}
    write_case(folder, Experiment(rig=FLAT, hidden=hidden, duration=6.0, rate=25.0, identify=1, predict=0))
    (folder / "plank.xml").write_text(flat_track(), encoding="utf-8")
    with (folder / "rig.toml").open("a", encoding="utf-8") as file:
        file.write('[scene]\nmjcf = "plank.xml"\nbeam_joint = "bearing"\nball = "marble"\ndirection = -1\n')
    case = load_case(folder)
    free = ["friction=0.004:0.02", "solref_timeconst=0.008:0.02"]
    return Tuning(case, tune(problem_of(case), engine_of("mujoco", case.scene), {"time_step": 4e-3}, free))


def test_what_the_scene_sets_is_said_to_be_as_in_its_file(tuning: Tuning) -> None:
    """Name the scene's file where no number is known before tuning, and where a parameter is left alone."""
    told = str(tuning.summary().text())
    found = next(line for line in told.splitlines() if line.lstrip().startswith("friction"))
    assert "as in plank.xml" in found
    assert "—" not in found
    assert "Left as in plank.xml" in told
    tried = sections.screening(tuning._subject()).context["content"].tables[0].rows
    verdict = next(row.cells[-1] for row in tried if "solref_timeconst" in row.cells[0])
    assert verdict == "not seen: left as in plank.xml"


def test_captions_say_what_is_drawn_in_which_unit(tuning: Tuning) -> None:
    """Name both panels of every picture over time, with their units, and what the engine was given."""
    content = sections.answer(tuning._subject()).context["content"]
    (caption,) = [one.caption for one in content.pictures]
    assert "Above, position of the ball along the beam in m, simulated and as MuJoCo has it" in caption
    assert "below, the engine's minus the simulated position in mm" in caption


def test_no_column_is_without_a_head(tuning: Tuning) -> None:
    """Give every column of every table a head."""
    made = (sections.answer, sections.screening, sections.identifiability, sections.inputs)
    tables = [table for section in made for table in section(tuning._subject()).context["content"].tables]
    assert tables
    assert all(column.head for table in tables for column in table.columns)
