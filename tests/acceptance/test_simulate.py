"""`harness simulate`: a case with a known truth, written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from harness.cli.main import main
from harness.recording import load_case
from harness.simulator import KINDS

SHORT = ("--duration", "3")


def simulated(out: Path, *arguments: str) -> Result:
    """The command's result."""
    return CliRunner().invoke(main, ["simulate", "--out", str(out), *SHORT, *arguments])


def test_a_case_that_the_other_commands_read(tmp_path: Path) -> None:
    """Write recordings, rig and truth with the effects asked for, hidden and declared, marked as simulated."""
    done = simulated(
        tmp_path / "case",
        *(
            "--hide",
            "viscous_damping.coefficient=0.03",
            "--hide",
            "settling_force.force=0.001",
            "--hide",
            "settling_force.time_constant=1.0",
        ),
        *("--declare", "level_error.angle=0.002"),
    )
    assert (done.exit_code, done.stderr) == (0, "")
    case = load_case(tmp_path / "case")
    assert (case.simulated, len(case.identify), len(case.predict)) == (True, 2, 1)
    assert [one.name for one in case.declared] == ["level_error"]
    truth = json.loads((tmp_path / "case" / "truth.json").read_text(encoding="utf-8"))
    assert truth["effects"] == [{"name": "viscous_damping", "parameters": {"coefficient": 0.03}}]
    assert truth["unlisted"] == "time"
    assert "imperfections" not in truth


def test_imperfections_are_asked_for_or_drawn(tmp_path: Path) -> None:
    """Spoil the record by the kinds asked for, or by drawn ones; the same files with the same seed."""
    for name in ("one", "again"):
        assert simulated(tmp_path / name, "--imperfect", "--seed", "3").exit_code == 0
    files = {path.name: path.read_bytes() for path in (tmp_path / "one").iterdir()}
    assert {path.name: path.read_bytes() for path in (tmp_path / "again").iterdir()} == files
    assert simulated(tmp_path / "lag", "--imperfection", "sensor_lag").exit_code == 0
    truth = json.loads((tmp_path / "lag" / "truth.json").read_text(encoding="utf-8"))
    assert truth["imperfections"]["sensor_lag"] > 0.0
    assert truth["imperfections"]["spiked"] == 0.0


def test_help_names_every_kind() -> None:
    """List the kinds of imperfection where they are asked for."""
    shown = CliRunner().invoke(main, ["simulate", "--help"]).stdout
    assert all(kind in shown for kind in KINDS)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--hide", "level_error"), "--hide 'level_error' is not NAME.PARAMETER=VALUE"),
        (("--hide", "level_error.angle=much"), "with a number in SI units"),
        (("--hide", "level_error.angle=nan"), "with a number in SI units"),
        (("--hide", "level_error.angle=0.0_1"), "with a number in SI units"),
        (("--duration", "nan"), "is not a finite number"),
        (("--hide", "level_errr.angle=0.1"), "Did you mean 'level_error'"),
        (("--declare", "level_error.angle=0.001", "--declare", "level_error.angle=0.002"), "given twice"),
        (("--imperfection", "spike"), "Did you mean 'spikes'"),
    ],
)
def test_a_bad_request_writes_nothing(tmp_path: Path, arguments: tuple[str, ...], message: str) -> None:
    """Exit with 2 and one message; leave no folder behind."""
    done = simulated(tmp_path / "case", *arguments)
    assert done.exit_code == 2
    assert message in done.stderr
    assert not (tmp_path / "case").exists()


def test_what_is_there_stays(tmp_path: Path) -> None:
    """Refuse a folder that holds anything."""
    (tmp_path / "note.txt").write_text("mine", encoding="utf-8")
    done = simulated(tmp_path)
    assert done.exit_code == 2
    assert "not an empty folder" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["note.txt"]
