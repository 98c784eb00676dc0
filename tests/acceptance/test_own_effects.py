"""`--effects`: what a user gets who adds the documentation's effect, and who does not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from harness.api.diagnosis import input_hashes
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case

FILE = Path(__file__).resolve().parents[2] / "docs" / "examples" / "magnet.py"
HIDDEN = {"force": 0.012, "centre": 0.33, "distance": 0.06}


def diagnosed(harness: Harness, case: Path, out: Path, *arguments: object) -> dict[str, Any]:
    """diagnosis.json."""
    done = harness("diagnose", case, "--out", out, *arguments)
    assert done.code == 0, done.err
    found: dict[str, Any] = json.loads((out / "diagnosis.json").read_text(encoding="utf-8"))
    return found


@pytest.mark.slow
def test_an_effect_of_ones_own_is_found(harness: Harness, tmp_path: Path) -> None:
    """Name the magnet, its size within three standard errors, predict with it; else find a force of position."""
    case, out = tmp_path / "case", tmp_path / "out"
    declared = {"rolling_resistance": {"coefficient": 0.002}}
    truth = write_case(case, Experiment(declared=declared, unlisted={"magnet": HIDDEN}))

    found = diagnosed(harness, case, out, "--effects", FILE)
    (effect,) = found["effects"]
    assert (found["verdict"], found["unlisted"], effect["name"]) == ("effect", None, "magnet")
    assert effect["indistinguishable_from"] == []
    for key, value in HIDDEN.items():
        size = effect["parameters"][key]
        # Three standard errors, which one number in 370 exceeds; a 95 % interval would miss one of these three in 7.
        assert abs(size["value"] - value) < 3.0 / 1.96 * 0.5 * (size["high"] - size["low"]), key
        assert size["high"] - size["low"] < 0.05 * value, key
    assert found["errors"]["engines"].keys() >= {"mujoco", "pybullet"}
    assert FILE.name in found["inputs"]["hashes"]
    assert "--effects" in (out / "diagnosis.html").read_text(encoding="utf-8")

    blank, csv = case / "rec_03.csv", tmp_path / "predicted.csv"
    refused = harness("predict", out, blank, "--out", csv)
    assert refused.code == 2
    assert "the effect magnet is not in the catalogue" in refused.err
    assert not csv.exists()
    done = harness("predict", out, blank, "--out", csv, "--effects", FILE)
    assert done.code == 0, done.err
    made, known = pd.read_csv(csv), pd.read_csv(blank)["ball_position_m"].notna().to_numpy()
    error = made["ball_position_m"].to_numpy() - truth[-1].position
    # A ball that starts with an error of 1 mm/s, which 0.3 mm of noise over two seconds leaves, is off by some 15 mm at
    # the end of 16 s; the magnet left out would cost decimetres.
    assert np.sqrt(np.mean(error[~known] ** 2)) < 0.015

    without = diagnosed(harness, case, tmp_path / "without")
    assert without["verdict"] == "unlisted"
    assert without["unlisted"]["depends_on"][0] == "position"
    assert "magnet" not in {one["effect"] for one in without["ledger"]}


@pytest.mark.slow
def test_a_declared_effect_of_ones_own_needs_its_file(harness: Harness, tmp_path: Path) -> None:
    """Say how to give the file where rig.toml declares what the catalogue does not have."""
    write_case(tmp_path / "case", Experiment(duration=4.0, identify=1, predict=0))
    rig = tmp_path / "case" / "rig.toml"
    values = "\n".join(f"{key} = {value}" for key, value in HIDDEN.items())
    rig.write_text(f'{rig.read_text(encoding="utf-8")}\n[[declared]]\nname = "magnet"\n{values}\n', encoding="utf-8")
    refused = harness("run", tmp_path / "case", "--engine", "mujoco")
    assert refused.code == 2
    assert "there is no effect 'magnet'" in refused.err
    assert "--effects" in refused.err
    done = harness("run", tmp_path / "case", "--engine", "mujoco", "--effects", FILE)
    assert done.code == 0, done.err


def test_a_bad_file_is_refused(harness: Harness, tmp_path: Path) -> None:
    """Exit with 2, naming file and line, and write nothing."""
    file = tmp_path / "mine.py"
    file.write_text("from analytic.effects import Effect\nEffect()\n", encoding="utf-8")
    done = harness("diagnose", tmp_path, "--effects", file, "--out", tmp_path / "out")
    assert done.code == 2
    assert f"{file}, line 2: TypeError" in done.err
    assert not (tmp_path / "out").exists()


def test_a_file_of_effects_is_known_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Hash a file under one name from whatever folder it is given, so that a replay from another one finds it."""
    case = load_case(write_short_case(tmp_path / "case"))
    monkeypatch.chdir(FILE.parent)
    assert input_hashes(case, [FILE]) == input_hashes(case, [Path(FILE.name)])
    assert FILE.name in input_hashes(case, [FILE])


def test_two_files_of_effects_with_one_name_are_refused(harness: Harness, tmp_path: Path) -> None:
    """Exit with 2 where a replay could not tell two files of effects from each other, and write nothing."""
    other = tmp_path / FILE.name
    other.write_text(FILE.read_text(encoding="utf-8").replace('"magnet"', '"second_magnet"'), encoding="utf-8")
    case = write_short_case(tmp_path / "case")
    done = harness("diagnose", case, "--effects", FILE, "--effects", other, "--out", tmp_path / "out")
    assert done.code == 2
    assert f"{other}: another file that the diagnosis is made from has this name" in done.err
    assert not (tmp_path / "out").exists()
