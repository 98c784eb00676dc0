"""A folder, its rig.toml or a bare CSV: each becomes a whole case or one error."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest

from analytic.rig import Rig
from harness.errors import InputError
from harness.recording import Case, KnownRig, load_case
from harness.recording.case import BUILT_IN, case_path, typed_path
from tests.recording.simulated import ANGLE_STEP, POSITION_STEP, contract_columns, write

RIG = '[ball]\nmass_kg = 0.071\n[recordings]\nidentify = ["a.csv"]\npredict = ["b.csv"]\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A case with one recording to identify from and one to predict, whose later positions are blank."""
    write(tmp_path / "a.csv")
    columns = contract_columns()
    columns["ball_position_m"] = np.where(columns["time_s"] < 1.5, columns["ball_position_m"], np.nan)
    write(tmp_path / "b.csv", columns)
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    return tmp_path


def warnings(case: Case) -> list[str]:
    """Texts of all warnings."""
    return [finding.text for finding in case.findings if finding.severity == "warning"]


@pytest.mark.parametrize("name", ["", "rig.toml"])
def test_folder_and_rig_file_are_one_case(folder: Path, name: str) -> None:
    """Accept the folder and the rig.toml in it alike."""
    case = load_case(folder / name)
    assert case.identify == ("a.csv",)
    assert case.predict == ("b.csv",)
    assert list(case.recordings) == ["a.csv", "b.csv"]
    assert case.rig == KnownRig(mass=0.071)
    assert case.sha256 == hashlib.sha256(RIG.encode()).hexdigest()
    assert warnings(case) == []


def test_findings_of_recordings_are_findings_of_the_case(folder: Path) -> None:
    """List the findings of each recording under its name."""
    case = load_case(folder)
    assert set(case.recordings["b.csv"].findings) <= set(case.findings)
    assert any(finding.where.startswith("b.csv") for finding in case.findings)


def test_bare_csv_is_of_the_paper(tmp_path: Path) -> None:
    """Read a bare CSV as a recording of the paper's rig, with inferred resolutions."""
    case = load_case(write(tmp_path / "run.csv"))
    assert case.rig.complete() == Rig()
    assert case.rig.unknown == ()
    assert (case.identify, case.predict) == (("run.csv",), ())
    assert case.sensors.angle_resolution == pytest.approx(ANGLE_STEP, rel=1e-9)
    assert case.sensors.position_resolution == pytest.approx(POSITION_STEP, rel=1e-9)
    assert case.sensors.position_noise is None
    assert case.sha256 is None
    assert warnings(case) == []


def test_bare_csv_beside_a_rig_file(folder: Path) -> None:
    """Warn that a rig.toml is not used when only a CSV beside it is named."""
    (warning,) = warnings(load_case(folder / "a.csv"))
    assert "ignored" in warning


def test_folder_without_rig_file(folder: Path) -> None:
    """Take all recordings of the folder, assume the paper's rig and warn."""
    (folder / "rig.toml").unlink()
    case = load_case(folder)
    assert case.identify == ("a.csv", "b.csv")
    assert case.rig.complete() == Rig()
    assert "rig of the paper is assumed" in warnings(case)[0]


def test_rig_file_without_lists(folder: Path) -> None:
    """Identify from every recording of the folder when none is listed."""
    (folder / "rig.toml").write_text("[ball]\nmass_kg = 0.071\n", encoding="utf-8")
    assert load_case(folder).identify == ("a.csv", "b.csv")


def test_stray_csv_without_lists(folder: Path) -> None:
    """Say how to leave a CSV out that is not a recording."""
    (folder / "rig.toml").write_text("[ball]\nmass_kg = 0.071\n", encoding="utf-8")
    (folder / "results.csv").write_text("time_s,ball_position_m\n0,0.3\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"results\.csv.*no column 'beam_angle_rad'.*\[recordings\] identify"):
        load_case(folder)


def test_own_files_are_no_recordings(folder: Path) -> None:
    """Leave out what the harness wrote beside the recordings, and say so."""
    (folder / "rig.toml").write_text("[ball]\nmass_kg = 0.071\n", encoding="utf-8")
    write(folder / "next_experiment.csv")
    (folder / "b_predicted.csv").write_text("time_s,ball_position_m,low_m,high_m\n0,0.3,0.2,0.4\n", encoding="utf-8")
    (folder / "trajectories.csv").write_text("time_s,measured_m,cam\n0,0.3,0.3\n", encoding="utf-8")
    (folder / "metrics.csv").write_text("source,horizon,rms_error_m\ncam,whole,0.001\n", encoding="utf-8")
    for named in (folder / "rig.toml", folder):
        case = load_case(named)
        assert case.identify == ("a.csv", "b.csv")
        (finding,) = [one for one in case.findings if one.code == "own-files"]
        assert "'b_predicted.csv', 'metrics.csv', 'next_experiment.csv', 'trajectories.csv'" in finding.text
        (folder / "rig.toml").unlink(missing_ok=True)


def test_an_own_file_may_be_listed(folder: Path) -> None:
    """Take what is listed for a recording, whatever its name."""
    write(folder / "next_experiment.csv")
    (folder / "rig.toml").write_text('[recordings]\nidentify = ["next_experiment.csv"]\n', encoding="utf-8")
    assert load_case(folder).identify == ("next_experiment.csv",)


def test_a_dead_link_is_named(folder: Path) -> None:
    """Say where a symbolic link points that leads nowhere, instead of offering its own name."""
    (folder / "a.csv").unlink()
    (folder / "a.csv").symlink_to("moved/a.csv")
    with pytest.raises(InputError, match=r"'a\.csv', a symbolic link to moved/a\.csv, which does not exist"):
        load_case(folder)


def test_missing_recording(folder: Path) -> None:
    """Name the missing recording, and an existing one with a similar name."""
    (folder / "rig.toml").write_text('[recordings]\nidentify = ["a.cvs"]\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"rig\.toml: .*'a\.cvs'.*Did you mean 'a\.csv'"):
        load_case(folder)


def test_a_name_that_no_file_can_have(folder: Path) -> None:
    """Say of a name of 300 characters that there is no such recording, and no such case."""
    (folder / "rig.toml").write_text(f'[recordings]\nidentify = ["{"x" * 300}.csv"]\n', encoding="utf-8")
    with pytest.raises(InputError, match=r"rig\.toml: .*not found in"):
        load_case(folder)
    with pytest.raises(InputError, match="there is no such file or folder"):
        load_case(folder / ("x" * 300) / "case")


def test_listed_twice(folder: Path) -> None:
    """Refuse a recording that is listed twice."""
    (folder / "rig.toml").write_text('[recordings]\nidentify = ["a.csv", "a.csv"]\n', encoding="utf-8")
    with pytest.raises(InputError, match="more than once"):
        load_case(folder)


def test_predicting_what_was_identified_from(folder: Path) -> None:
    """Warn when a recording to predict is one to identify from, under its own or another name."""
    (folder / "copy.csv").write_bytes((folder / "a.csv").read_bytes())
    for predict in ("copy.csv", "a.csv"):
        text = f'[recordings]\nidentify = ["a.csv"]\npredict = ["{predict}"]\n'
        (folder / "rig.toml").write_text(text, encoding="utf-8")
        (warning,) = warnings(load_case(folder))
        assert "do not predict a recording used for identification" in warning


def test_nothing_listed(folder: Path) -> None:
    """Refuse a list without recordings."""
    (folder / "rig.toml").write_text("[recordings]\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"\[recordings\] is empty"):
        load_case(folder)


def test_identifying_without_positions(folder: Path) -> None:
    """Warn if a recording for identification has no position."""
    columns = contract_columns()
    del columns["ball_position_m"]
    write(folder / "a.csv", columns)
    assert any("cannot be used for identification" in text for text in warnings(load_case(folder)))


def test_positions_under_another_name(folder: Path) -> None:
    """Name the column that may hold the positions where none are found."""
    columns = contract_columns()
    columns["Distance (cm)"] = columns.pop("ball_position_m")
    write(folder / "a.csv", columns)
    assert any("'Distance (cm)'" in text for text in warnings(load_case(folder)))


def test_empty_folder(tmp_path: Path) -> None:
    """Refuse a folder without recordings."""
    with pytest.raises(InputError, match="contains no CSV recording"):
        load_case(tmp_path)


@pytest.mark.parametrize(("name", "simulated"), [("paper_protocol", True), ("open_ball_beam", False)])
def test_built_in_cases_have_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, simulated: bool) -> None:
    """Read a case of the package by its name from anywhere, and say whether it was measured."""
    monkeypatch.chdir(tmp_path)
    case = load_case(name)
    assert (case.name, case.simulated) == (name, simulated)
    assert case.origin is not None
    assert case.origin.startswith("simulated" if simulated else "measured")


def test_a_folder_comes_before_a_built_in_case(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read the user's folder where it has the name of a built-in case."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "open_ball_beam").symlink_to(folder)
    assert load_case("open_ball_beam").identify == ("a.csv",)


def test_a_built_in_name_misspelt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Suggest it."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"Did you mean .*open_ball_beam"):
        load_case("open_ball_bean")


def test_the_licence_comes_with_the_measured_recording() -> None:
    """Keep the notice that its licence demands beside the copy of the data, which is the only one."""
    notice = (BUILT_IN["open_ball_beam"] / "LICENSE").read_text(encoding="utf-8")
    assert "Copyright (c) 2021 Benjamin Gravell" in notice
    assert "The above copyright notice and this permission notice shall be included in all\ncopies" in notice


def test_path_misspelt(folder: Path) -> None:
    """Suggest a file with a similar name."""
    with pytest.raises(InputError, match=r"no such file or folder\. Did you mean .*rig\.toml"):
        load_case(folder / "rig.tml")


def test_bad_recording_spoils_the_case(folder: Path) -> None:
    """Refuse the whole case if one recording is invalid."""
    (folder / "b.csv").write_text("time_s,beam_angle_rad\n0,zero\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"b\.csv, row 2, column 'beam_angle_rad'"):
        load_case(folder)


def test_a_folder_of_results_does_not_hide_a_built_in_case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Take the built-in case beside a folder of its name without recordings, and the folder with one."""
    monkeypatch.chdir(tmp_path)
    folder = Path("open_ball_beam")
    folder.mkdir()
    (folder / "diagnosis.html").write_text("a result", encoding="utf-8")
    assert case_path("open_ball_beam") == BUILT_IN["open_ball_beam"]
    (folder / "rec_01.csv").write_text("time_s,beam_angle_rad,ball_position_m\n", encoding="utf-8")
    assert case_path("open_ball_beam") == folder


def test_a_built_in_case_is_called_by_its_name() -> None:
    """Write its name, and not where it is installed, into commands to repeat."""
    assert str(typed_path(BUILT_IN["open_ball_beam"])) == "open_ball_beam"
    assert typed_path(Path("my_rig")) == Path("my_rig")
