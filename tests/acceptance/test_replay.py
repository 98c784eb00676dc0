"""`harness replay`, and `harness diagnose --also`: what a user gets, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from harness.simulator import Experiment, write_case
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case

HIDDEN = {"rolling_resistance": {"coefficient": 0.004}}


@pytest.mark.slow
def test_a_diagnosis_is_replayed_and_held_against_another_recording(process: Harness, tmp_path: Path) -> None:
    """Tell errors on a further recording; replay with 0, on a forged ledger 1, on a changed input 2 with its name."""
    case, out, further = tmp_path / "case", tmp_path / "out", tmp_path / "further"
    write_case(case, Experiment(hidden=HIDDEN, duration=8.0, seed=0))
    write_case(further, Experiment(hidden=HIDDEN, duration=8.0, seed=7))
    done = process("diagnose", case, "--out", out, "--also", further / "rec_02.csv")
    assert done.code == 0, done.err
    found = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    ((name, also),) = found["errors"]["also"].items()
    assert name == str(further / "rec_02.csv")  # the case has a rec_02.csv of its own
    assert also["after"]["rms_m"]["whole"] < also["before"]["rms_m"]["whole"]
    assert set(also["engines"]) == {"mujoco", "pybullet"}
    assert name not in found["inputs"]["hashes"]
    again = process("replay", out, case, "--json")
    assert (again.code, json.loads(again.out)["reproduced"]) == (0, True), again.out
    refitted = process("replay", out, case, "--refit")
    assert refitted.code == 0, refitted.out
    found["ledger"][0]["kept"] = not found["ledger"][0]["kept"]
    (out / "diagnosis.json").write_text(json.dumps(found), encoding="utf-8")
    forged = process("replay", out / "diagnosis.json", case)
    assert forged.code == 1
    assert "attempt 1, " in forged.out
    with (case / "rec_02.csv").open("a", encoding="utf-8") as file:
        file.write("\n")
    changed = process("replay", out, case)
    assert changed.code == 2
    assert "rec_02.csv has changed" in changed.err


def test_a_recording_that_is_fitted_to_is_no_further_one(harness: Harness, tmp_path: Path) -> None:
    """Refuse with 2 to hold the result against what it is found from, and write nothing."""
    case = write_short_case(tmp_path / "case")
    file = sorted(case.glob("*.csv"))[0]
    done = harness("diagnose", case, "--out", tmp_path / "out", "--also", file)
    assert done.code == 2
    assert f"{file}: is {file.name}, which is in use already" in done.err
    assert not (tmp_path / "out").exists()


def test_a_recording_without_positions_is_no_further_one(harness: Harness, tmp_path: Path) -> None:
    """Refuse with 2 a further recording that holds nothing to compare with."""
    case = write_short_case(tmp_path / "case")
    rows = [f"{0.01 * n:.2f},{0.001 * n:.4f}," for n in range(200)]
    blank = tmp_path / "blank.csv"
    blank.write_text("\n".join(["time_s,beam_angle_rad,ball_position_m", *rows]) + "\n", encoding="utf-8")
    done = harness("diagnose", case, "--out", tmp_path / "out", "--also", blank)
    assert done.code == 2
    assert "blank.csv: holds no ball positions" in done.err


def test_what_is_no_diagnosis_is_refused(harness: Harness, tmp_path: Path) -> None:
    """End with 2 and one message where there is no ledger to replay."""
    (tmp_path / "diagnosis.json").write_text('{"schema": 1, "ledger": []}', encoding="utf-8")
    done = harness("replay", tmp_path, tmp_path)
    assert done.code == 2
    assert "no ledger with hashes" in done.err
