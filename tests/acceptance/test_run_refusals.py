"""`harness run`: what a user gets when something is wrong. One message, the right exit code, nothing half written."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.acceptance.conftest import Harness, Outcome
from tests.acceptance.short import write_short_case
from tests.acceptance.test_run import FILES, table


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sound case."""
    return write_short_case(tmp_path_factory.mktemp("short") / "case")


def assert_refused(done: Outcome, *words: str) -> None:
    """Exit code 2, one message with all `words`, stdout empty, nothing written."""
    assert done.code == 2, done.err
    assert done.out == ""
    assert "Traceback" not in done.err
    messages = [line for line in done.errors if line.lower().startswith("error: ")]
    assert len(messages) == 1, done.err
    for word in words:
        assert word in messages[0]
    assert list(done.folder.iterdir()) == []


def test_a_bad_recording(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Name file, row and column of a cell that is no number."""
    lines = (case / "rec_01.csv").read_text().splitlines()
    lines[41] = lines[41].replace(",", ",x", 1)
    (tmp_path / "bad.csv").write_text("\n".join(lines))
    assert_refused(harness("run", tmp_path / "bad.csv"), "bad.csv", "42", "beam_angle_rad")


@pytest.mark.parametrize("words", [("run",), ("view", "paper_protocol", "--video", "clip.gif")])
def test_a_variable_that_keeps_mujoco_out(
    process: Harness, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Name the variable of the environment with which MuJoCo cannot be imported, and what it may be."""
    monkeypatch.setenv("MUJOCO_GL", "bogus")
    assert_refused(process(*words), "MUJOCO_GL=bogus", "unset this variable", "egl")


def test_a_missing_case(harness: Harness, tmp_path: Path) -> None:
    """Say that there is no such file."""
    assert_refused(harness("run", tmp_path / "nothing"), "nothing: there is no such file or folder")


def test_an_unreadable_rig(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Name the rig file that is no TOML."""
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "rig.toml").write_text("[ball\nmass_kg = 0.071\n")
    (tmp_path / "broken" / "rec_01.csv").write_bytes((case / "rec_01.csv").read_bytes())
    assert_refused(harness("run", tmp_path / "broken"), "rig.toml", "TOML")


def test_an_unknown_parameter(harness: Harness, case: Path) -> None:
    """List the valid parameters."""
    done = harness("run", case, "--set", "mujoco.frction=0.3")
    assert_refused(done, "no parameter 'frction'", "Did you mean 'friction'?", "Parameters are: time_step, slip_limit,")


def test_a_value_out_of_bounds(harness: Harness, case: Path) -> None:
    """Name the parameter and the value."""
    assert_refused(harness("run", case, "--set", "pybullet.time_step=-1"), "pybullet.time_step", "-1")


def test_an_unknown_engine(harness: Harness, case: Path) -> None:
    """List the valid engines."""
    assert_refused(harness("run", case, "--engine", "bullet"), "'bullet'", "mujoco, pybullet, dart")


def test_an_unknown_recording(harness: Harness, case: Path) -> None:
    """List the valid recordings."""
    assert_refused(harness("run", case, "--recording", "rec_9.csv"), "'rec_9.csv'", "rec_01.csv, rec_02.csv")


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--start", "0.36"),
        ("--start", "nan,0"),
        ("--level-angle", "steep"),
        ("--level-angle", "nan"),
        ("--window", "0"),
        ("--window", "nan"),
        ("--window", "inf"),
        ("--tube", "nan"),
        ("--tube", "inf"),
        ("--tube", "0.01_0"),
        ("--start", "0.3_6,0"),
        ("--level-angle", "0.0_1"),
        ("--set", "mujoco.friction=0.3_6"),
        ("--seed", "-1"),
        ("--seed", "1_0"),
        ("--out", ""),
        ("--out", "x" * 300),
        ("--effects", "x" * 300),
        ("--parameters", "deep/" * 900),
    ],
)
def test_a_bad_option(harness: Harness, case: Path, option: str, value: str) -> None:
    """Name the option and what it takes, and take no number that is not finite or not written plainly."""
    assert_refused(harness("run", case, f"{option}={value}"), option)


def test_a_level_angle_that_is_a_unit_error(harness: Harness, case: Path) -> None:
    """Refuse a level angle of 80°."""
    assert_refused(harness("run", case, "--level-angle", "80deg"), "--level-angle", "45°")


def test_a_recording_without_positions(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Refuse to start a ball that was never seen."""
    lines = (case / "rec_01.csv").read_text().splitlines()
    rows = [lines[0], *(line.rsplit(",", 1)[0] + "," for line in lines[1:])]
    (tmp_path / "blind.csv").write_text("\n".join(rows))
    assert_refused(harness("run", tmp_path / "blind.csv"), "blind.csv", "3 known ball positions are needed")


def test_a_file_where_the_folder_should_be(harness: Harness, case: Path, tmp_path: Path) -> None:
    """Leave a file alone that --out names, and say so before anything is computed."""
    file = tmp_path / "taken"
    file.write_text("mine")
    done = harness("run", case, "--out", file)
    assert_refused(done, "taken", "choose another folder with --out")
    assert file.read_text() == "mine"
    assert "models" not in done.err  # progress: nothing ran


def test_a_folder_that_cannot_be_made(harness: Harness, case: Path) -> None:
    """Say that the folder cannot be written."""
    assert_refused(harness("run", case, "--out", "/proc/nowhere"), "/proc/nowhere", "--out")


@pytest.mark.parametrize("command", ["run", "diagnose"])
def test_a_name_that_is_too_long(harness: Harness, command: str) -> None:
    """Say that no file can be called so."""
    assert_refused(harness(command, "x" * 300), "too long")


@pytest.mark.parametrize("step", ["1e-12", "5e-7"])
def test_a_time_step_that_memory_does_not_hold(harness: Harness, case: Path, step: str) -> None:
    """Say what it would take and what can be, before anything runs."""
    done = harness("run", case, "--set", f"mujoco.time_step={step}")
    assert_refused(done, "mujoco.time_step is", "GB of memory; give at least 1.5e-06 s")
    assert "models" not in done.err  # progress: nothing ran


@pytest.mark.slow
def test_a_falling_ball(harness: Harness, case: Path) -> None:
    """Exit with 3 and one message where an engine drops the ball, and still report all other sources."""
    soft = ("--set", "pybullet.contact_stiffness=10", "--set", "pybullet.contact_damping=0.1")
    done = harness("run", case, "--window", 1, *soft, "--json")
    assert done.code == 3
    assert len(done.errors) == 1, done.err
    assert done.errors[0].startswith("error: pybullet failed at t = ")
    assert "left the rails" in done.errors[0]
    assert "4 of its 4 runs failed" in done.errors[0]
    answer = json.loads(done.out)
    assert len(answer["failures"]) == 4
    folder = done.folder / "reports" / "case"
    assert {file.name for file in folder.iterdir()} == FILES
    assert "the ball left the rails" in (folder / "report.html").read_text("utf-8")
    rows = table(folder / "trajectories.csv")
    assert {row["pybullet_m"] for row in rows} == {""}
    assert all(row["mujoco_m"] and row["cam_m"] for row in rows)
    assert len(json.loads((folder / "manifest.json").read_text("utf-8"))["failures"]) == 4


@pytest.mark.slow
def test_the_module_is_the_command(tmp_path: Path) -> None:
    """Do with `python -m harness` what `harness` does, exit codes included."""
    command = [sys.executable, "-m", "harness", "run", "nothing"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, encoding="utf-8", check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert "nothing: there is no such file or folder" in done.stderr


@pytest.mark.slow
def test_a_section_that_raises(harness: Harness, case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit with 3 where a section of the report raises, name it, and write all other sections and files."""
    from harness.report.comparison import SECTIONS

    def fail(_: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setitem(SECTIONS, "friction", fail)  # type: ignore[arg-type]
    done = harness("run", case, "--window", 1, "--engine", "mujoco")
    assert done.code == 3
    (message,) = done.errors
    assert message.startswith("error: report section friction failed: ZeroDivisionError: division by zero (")
    folder = done.folder / "reports" / "case"
    assert {file.name for file in folder.iterdir()} == FILES
    page = (folder / "report.html").read_text("utf-8")
    assert page.count("ZeroDivisionError: division by zero") == 2  # at the top and in its place
    assert '<section id="answer"' in page
    assert "ZeroDivisionError" in (folder / "manifest.json").read_text("utf-8")


@pytest.mark.slow
def test_an_engine_whose_package_raises(harness: Harness, case: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit with 3 and name the exception where an engine's package raises one, and report the other sources."""
    from harness.engines.mujoco import MuJoCo

    def fail(*_: object) -> None:
        raise RuntimeError("no display")

    monkeypatch.setattr(MuJoCo, "drive", fail)
    done = harness("run", case, "--window", 1)
    assert done.code == 3
    (message,) = done.errors
    assert "mujoco failed at t = " in message
    assert "RuntimeError: no display" in message
    rows = table(done.folder / "reports" / "case" / "trajectories.csv")
    assert {row["mujoco_m"] for row in rows} == {""}
    assert all(row["pybullet_m"] for row in rows)
