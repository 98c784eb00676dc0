"""`harness diagnose paper_protocol`: the built-in simulated case tells what is hidden in it, and its model serves."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from harness.simulator.bundled import case_folder
from tests.acceptance.conftest import Outcome, call

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """The command as a newcomer types it."""
    return call(tmp_path_factory.mktemp("bundled_diagnosis"), "diagnose", "paper_protocol")


@pytest.fixture(scope="module")
def found(diagnosed: Outcome) -> dict[str, object]:
    """Its diagnosis.json."""
    file = diagnosed.folder / "reports" / "paper_protocol" / "diagnosis.json"
    return json.loads(file.read_text(encoding="utf-8"))


def test_it_names_what_is_hidden_and_nothing_else(diagnosed: Outcome, found: dict) -> None:
    """Find the effects of truth.json alone, the values within their intervals, and a smaller held-out error."""
    assert diagnosed.code == 0, diagnosed.err
    truth = json.loads((case_folder() / "truth.json").read_text(encoding="utf-8"))
    assert [one["name"] for one in found["effects"]] == [one["name"] for one in truth["effects"]]
    for one, true in zip(found["effects"], truth["effects"], strict=True):
        for name, value in true["parameters"].items():
            assert one["parameters"][name]["low"] < value < one["parameters"][name]["high"]
    before, after = (found["errors"]["heldout"][when]["rms_m"]["3 s"] for when in ("before", "after"))
    # Readings alone differ from the true ball by their noise, 0.6 mm RMS; a third more is what 3 s of angle error add.
    assert after < 0.0009 < 0.02 < before


def test_it_is_replayed(diagnosed: Outcome) -> None:
    """Come to the same deviances, decisions and conclusions."""
    done = call(diagnosed.folder, "replay", "reports/paper_protocol", "paper_protocol")
    assert done.code == 0, done.out
    assert "nothing differs" in done.out


def test_its_model_predicts_the_third_recording(diagnosed: Outcome, tmp_path: Path) -> None:
    """Predict 3 s from 2 s of positions, with most of the readings within the band."""
    whole = pd.read_csv(case_folder() / "rec_03.csv", comment="#")
    known = whole[whole["time_s"] < 5.0].copy()
    known.loc[known["time_s"] > 2.0, "ball_position_m"] = np.nan
    known.to_csv(tmp_path / "known.csv", index=False)
    done = call(
        diagnosed.folder, "predict", "reports/paper_protocol", tmp_path / "known.csv", "--out", tmp_path / "out.csv"
    )
    assert done.code == 0, done.err
    predicted, later = pd.read_csv(tmp_path / "out.csv"), (known["time_s"] > 2.0).to_numpy()
    read = whole["ball_position_m"].to_numpy()[: len(known)]
    error = (predicted["ball_position_m"].to_numpy() - read)[later]
    # Reading noise of up to 0.8 mm, and twice as much from the angle within its counts.
    assert np.sqrt(np.mean(error**2)) < 0.0025
    half = (predicted["high_m"] - predicted["low_m"]).to_numpy()[later] / 2.0
    assert np.mean(np.abs(error) < np.hypot(half, 1.96 * 0.0008)) > 0.8  # one path: its errors last for a second
