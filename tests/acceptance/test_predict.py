"""`harness predict`: what a user gets, and what is refused."""

from __future__ import annotations

import json
import stat
from pathlib import Path

import pandas as pd
import pytest

from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case
from tests.api.made import nothing_missing


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A case with the diagnosis.json of a model that nothing was missing from."""
    folder = write_short_case(tmp_path_factory.mktemp("predict") / "case")
    (folder / "diagnosis.json").write_text(nothing_missing(folder).text(), encoding="utf-8")
    return folder


def test_a_prediction_is_a_file_like_any_other(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Write the table and its hidden record, to be read by whoever may read what else is written there."""
    out = tmp_path / "out" / "predicted.csv"
    done = harness("predict", case, next(case.glob("*.csv")), "--out", out)
    assert done.code == 0, done.err
    assert sorted(path.name for path in out.parent.iterdir()) == [f".{out.name}.json", out.name]
    assert out.read_text(encoding="utf-8").startswith("time_s,ball_position_m,low_m,high_m\n")
    plain = tmp_path / "plain"
    plain.touch()
    assert stat.S_IMODE(out.stat().st_mode) == stat.S_IMODE(plain.stat().st_mode)


def test_a_recording_of_another_rig_is_told(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Warn where the rig.toml beside the recording has another ball; without one nothing can be compared."""
    recording = next(case.glob("*.csv"))
    copy = tmp_path / "other" / recording.name
    copy.parent.mkdir()
    copy.write_bytes(recording.read_bytes())
    for of in (recording, copy):
        done = harness("predict", case, of, "--out", tmp_path / "predicted.csv")
        assert "another rig" not in done.err
    rig = (case / "rig.toml").read_text(encoding="utf-8")
    for text, other in (
        (rig + "# a remark\n", False),
        (rig.replace("mass_kg = 0.", "mass_kg = 0.1"), True),
        ("[", False),
    ):
        (copy.parent / "rig.toml").write_text(text, encoding="utf-8")
        done = harness("predict", case, copy, "--out", tmp_path / "predicted.csv")
        assert done.code == 0, done.err
        assert (f"warning: {copy}: is of another rig than the diagnosis (mass 0.1" in done.err) == other


def test_a_prediction_that_cannot_be_put_leaves_nothing(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Exit with 2 where a folder has the name of the table, and leave no unfinished file beside it."""
    taken = tmp_path / "out" / "predicted.csv"
    taken.mkdir(parents=True)
    done = harness("predict", case, next(case.glob("*.csv")), "--out", taken)
    assert done.code == 2
    assert f"{taken}: is a folder" in done.err
    assert list(taken.parent.iterdir()) == [taken]


@pytest.mark.parametrize("part", ["sensors", "rig"])
def test_a_diagnosis_of_another_version_is_refused(harness: Harness, case: Path, tmp_path: Path, part: str) -> None:
    """Exit with 2 and say to diagnose anew where the rig or its sensors have fields that this version does not know."""
    record = json.loads((case / "diagnosis.json").read_text(encoding="utf-8"))
    record["model"][part]["of_another_version"] = 1.0
    (tmp_path / "diagnosis.json").write_text(json.dumps(record), encoding="utf-8")
    done = harness("predict", tmp_path, next(case.glob("*.csv")))
    assert done.code == 2
    assert "is no diagnosis that this version can use" in done.err
    assert "diagnose anew" in done.err


def test_what_is_odd_in_the_recording_is_said_with_its_prediction(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Warn of an angle with the wrong sign on stderr and in the JSON, and predict all the same."""
    table = pd.read_csv(sorted(case.glob("*.csv"))[0])
    table["beam_angle_rad"] *= -1.0
    table.to_csv(tmp_path / "reversed.csv", index=False)
    done = harness("predict", case, tmp_path / "reversed.csv", "--json")
    assert done.code == 0, done.err
    assert "warning: reversed.csv: " in done.err
    assert "angle-sign" in done.err
    assert "angle-sign" in {one["code"] for one in json.loads(done.out)["findings"]}
