"""Commands replace nothing but what they wrote themselves: inputs, notes and edited results stay."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case
from tests.api.made import nothing_missing

NOT_OURS = "this command did not write it, or it has been changed since"


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """A case with the diagnosis.json of a model that nothing was missing from."""
    folder = write_short_case(tmp_path / "case")
    (folder / "diagnosis.json").write_text(nothing_missing(folder).text(), encoding="utf-8")
    return folder


@pytest.mark.parametrize("name", ["rec_01.csv", "diagnosis.json"])
def test_a_prediction_does_not_overwrite_its_inputs(harness: Harness, case: Path, name: str) -> None:
    """Exit with 2 and leave the recording and the diagnosis as they are, also with --force."""
    before = (case / name).read_bytes()
    for more in ((), ("--force",)):
        done = harness("predict", case, case / "rec_01.csv", "--out", case / name, *more)
        assert done.code == 2
        (message,) = done.errors
        assert f"{name}: is an input of this command and is never overwritten" in message
        assert (case / name).read_bytes() == before


def test_a_prediction_replaces_only_predictions(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Replace an earlier prediction, also that of another recording; refuse any other file, and take --force."""
    out = tmp_path / "predicted.csv"
    for name in ("rec_01.csv", "rec_01.csv", "rec_02.csv"):
        assert harness("predict", case, case / name, "--out", out).code == 0
    second = out.read_bytes()
    out.write_bytes(second + b"a note of mine\n")
    done = harness("predict", case, case / "rec_01.csv", "--out", out)
    assert (done.code, NOT_OURS in done.err) == (2, True)
    assert out.read_bytes() == second + b"a note of mine\n"
    other = case / "rec_02.csv"
    kept = other.read_bytes()
    done = harness("predict", case, case / "rec_01.csv", "--out", other)
    assert (done.code, NOT_OURS in done.err, other.read_bytes() == kept) == (2, True, True)
    assert harness("predict", case, case / "rec_02.csv", "--out", out, "--force").code == 0
    assert out.read_bytes() == second


@pytest.mark.parametrize("out", ["", "..", "folder", "x" * 300 + ".csv", "no/" + "x" * 300 + "/p.csv"])
def test_a_prediction_needs_a_file(harness: Harness, case: Path, tmp_path: Path, out: str) -> None:
    """Exit with 2 and one message where --out can be no file, and leave nothing."""
    (tmp_path / "work" / "folder").mkdir()
    done = harness("predict", case, case / "rec_01.csv", "--out", out)
    assert done.code == 2
    assert len([line for line in done.errors if line.lower().startswith("error: ")]) == 1, done.err
    assert [path.name for path in (tmp_path / "work").iterdir()] == ["folder"]


def test_a_changed_diagnosis_is_noticed(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Predict with a diagnosis that was edited, but say so."""
    content = json.loads((case / "diagnosis.json").read_text(encoding="utf-8"))
    out = tmp_path / "predicted.csv"
    assert harness("predict", case, case / "rec_01.csv", "--out", out).err == ""
    content["model"]["band"] = 2.0
    (case / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    done = harness("predict", case, case / "rec_01.csv", "--out", out)
    assert done.code == 0
    assert "warning: " in done.err
    assert "has been changed since `diagnose` wrote it" in done.err


def test_where_predictions_are_kept_is_told(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Say from where to where predictions are kept with a model that has a range of travel, in JSON too."""
    out, recording = tmp_path / "predicted.csv", case / "rec_01.csv"
    assert "kept" not in harness("predict", case, recording, "--out", out).out
    content = json.loads((case / "diagnosis.json").read_text(encoding="utf-8"))
    content["model"]["travel_m"] = [-0.25, 0.125]
    (case / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    done = harness("predict", case, recording, "--out", out)
    assert "kept between -0.25 and 0.125 m, where the ball was recorded" in done.out
    assert json.loads(harness("predict", case, recording, "--out", out, "--json").out)["travel_m"] == [-0.25, 0.125]


@pytest.mark.slow
def test_a_comparison_replaces_only_its_own_result(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Replace an earlier result; refuse an edited report and a file of the user's before anything is computed."""
    out = tmp_path / "out"
    arguments = ("run", case, "--out", out, "--engine", "mujoco", "--window", 1)
    assert harness(*arguments).code == 0
    assert harness(*arguments).code == 0
    report = out / "report.html"
    report.write_text(report.read_text(encoding="utf-8") + "<!-- mine -->", encoding="utf-8")
    done = harness(*arguments)
    assert (done.code, f"report.html: exists, and {NOT_OURS}" in done.err) == (2, True)
    assert "models" not in done.err  # progress: nothing ran
    assert report.read_text(encoding="utf-8").endswith("<!-- mine -->")
    assert harness(*arguments, "--force").code == 0


@pytest.mark.parametrize("name", ["diagnosis.html", "next_experiment.csv"])
def test_a_diagnosis_is_refused_before_it_begins(harness: Harness, case: Path, tmp_path: Path, name: str) -> None:
    """Exit with 2 at once where a file that may be written is the user's."""
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_text("mine", encoding="utf-8")
    done = harness("diagnose", case, "--out", out)
    assert (done.code, f"{name}: exists, and {NOT_OURS}" in done.err) == (2, True)
    assert "drives" not in done.err
    assert [(file.name, file.read_text(encoding="utf-8")) for file in out.iterdir()] == [(name, "mine")]


def test_a_diagnosis_beside_its_recordings_keeps_them(harness: Harness, tmp_path: Path) -> None:
    """Never write over a recording that has the name of a result, also with --force."""
    case = write_short_case(tmp_path / "case")
    (case / "rec_02.csv").rename(case / "next_experiment.csv")
    with (case / "rig.toml").open("a", encoding="utf-8") as rig:  # not listed, it would be left out as no recording
        rig.write('\n[recordings]\nidentify = ["rec_01.csv", "next_experiment.csv"]\n')
    done = harness("diagnose", case, "--out", case, "--force")
    assert done.code == 2
    assert "next_experiment.csv: is an input of this command" in done.err


def test_a_simulated_case_is_not_written_over_another(harness: Harness, tmp_path: Path) -> None:
    """Refuse a folder that holds anything; with --force, replace the files of the case and leave all others."""
    out = tmp_path / "case"
    arguments = ("simulate", "--out", out, "--duration", 3)
    assert harness(*arguments).code == 0
    (out / "rig.toml").write_text("mine", encoding="utf-8")
    (out / "note.txt").write_text("mine", encoding="utf-8")
    assert harness(*arguments).code == 2
    assert (out / "rig.toml").read_text(encoding="utf-8") == "mine"
    assert harness(*arguments, "--force").code == 0
    assert "mass_kg" in (out / "rig.toml").read_text(encoding="utf-8")
    assert (out / "note.txt").read_text(encoding="utf-8") == "mine"
