"""`harness diagnose`: what a user gets, and what is said when the case is none."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from harness.simulator import Experiment, write_case
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case

PARAMETER = {"value", "low", "high", "unit"}


@pytest.mark.slow
def test_a_diagnosis_keeps_its_contract(process: Harness, tmp_path: Path) -> None:
    """Write diagnosis.json with every promised key, name the effect that is hidden, and predict what was asked for."""
    hidden = {"rolling_resistance": {"coefficient": 0.004}}
    write_case(tmp_path / "case", Experiment(hidden=hidden, duration=8.0))
    done = process("diagnose", tmp_path / "case", "--out", tmp_path / "out")
    assert done.code == 0, done.err
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert {"schema", "verdict", "effects", "unlisted", "errors", "ledger", "inputs"} <= set(found)
    assert (found["schema"], found["verdict"], found["unlisted"]) == (3, "effect", None)
    (effect,) = found["effects"]
    assert set(effect) == {"name", "parameters", "indistinguishable_from", "by_recording", "implausible", "together"}
    assert effect["name"] == "rolling_resistance"
    size = effect["parameters"]["coefficient"]
    assert set(size) == PARAMETER
    assert size["low"] < size["value"] < size["high"]
    assert size["low"] < 0.004 < size["high"]
    for when in ("identify", "heldout"):
        assert found["errors"][when]["after"]["rms_m"]["whole"] < found["errors"][when]["before"]["rms_m"]["whole"]
    assert all({"effect", "kept", "because"} <= set(line) for line in found["ledger"])
    assert {"hashes", "versions", "seed"} <= set(found["inputs"])
    assert (tmp_path / "out" / "prediction_rec_03.csv").read_text().startswith("time_s,ball_position_m")
    proposed = found["next_experiment"]
    assert {"profile", "sentence", "separations", "limits", "open_loop_drift_m"} <= set(proposed)
    assert proposed["separations"][0]["found"] == "rolling_resistance"
    columns = (tmp_path / "out" / proposed["file"]).read_text().splitlines()
    assert columns[0] == "time_s,beam_angle_rad,ball_position_m"


@pytest.mark.slow
def test_an_unknown_rig_with_rare_positions_is_diagnosed(process: Harness, tmp_path: Path) -> None:
    """Come to a result from 8 s at 20 Hz of a rig of which nothing is known, three of four positions blank."""
    hidden = {"viscous_damping": {"coefficient": 0.03}}
    experiment = Experiment(hidden=hidden, rate=20.0, duration=8.0, identify=1, predict=0, position_noise=4e-3, seed=7)
    write_case(tmp_path / "case", experiment)
    (tmp_path / "case" / "rig.toml").write_text('[recordings]\nidentify = ["rec_01.csv"]\n', encoding="utf-8")
    file = tmp_path / "case" / "rec_01.csv"
    table = pd.read_csv(file)
    table.loc[table.index % 4 != 0, "ball_position_m"] = np.nan
    table.to_csv(file, index=False)
    done = process("diagnose", tmp_path / "case", "--out", tmp_path / "out")
    assert done.code == 0, done.err
    assert "Traceback" not in done.err
    found = json.loads((tmp_path / "out" / "diagnosis.json").read_text(encoding="utf-8"))
    assert found["verdict"] in ("none", "effect", "unlisted", "not_identifiable")  # 40 readings need not show it
    assert not found["failures"]


def test_a_missing_case_is_refused(harness: Harness, tmp_path: Path) -> None:
    """Exit with 2 and one message where there is no such case, and write nothing."""
    done = harness("diagnose", tmp_path / "nothing", "--out", tmp_path / "out")
    assert done.code == 2
    assert "there is no such file or folder" in done.err
    assert not (tmp_path / "out").exists()


def test_two_predictions_into_one_file_are_refused(harness: Harness, tmp_path: Path) -> None:
    """Exit with 2 before the search where one prediction would overwrite another, and write nothing."""
    case = write_short_case(tmp_path / "case")
    first, second = sorted(case.glob("*.csv"))
    (case / "later").mkdir()
    second.rename(case / "later" / first.name)
    rig = case / "rig.toml"
    rest = re.sub(r"(?ms)^\[recordings\].*?(?=^\[|\Z)", "", rig.read_text(encoding="utf-8"))
    listed = f'[recordings]\nidentify = []\npredict = ["{first.name}", "later/{first.name}"]\n'
    rig.write_text(f"{rest}\n{listed}", encoding="utf-8")
    done = harness("diagnose", case, "--out", tmp_path / "out")
    assert done.code == 2
    assert f"later/{first.name} would both be predicted into prediction_{first.stem}.csv" in done.err
    assert not (tmp_path / "out").exists()
