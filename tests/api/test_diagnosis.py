"""`harness.diagnose`: what was found, in tables, words, pictures and predictions; the same from its file."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import harness
from harness.simulator import Experiment, write_case
from tests.acceptance.short import write_short_case
from tests.api.made import nothing_missing

COEFFICIENT = 0.004
MAGNET = Path(__file__).resolve().parents[2] / "docs" / "examples" / "magnet.py"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings of 8 s of a ball that rolls with resistance, one of them to predict."""
    folder = tmp_path_factory.mktemp("diagnose") / "case"
    write_case(folder, Experiment(hidden={"rolling_resistance": {"coefficient": COEFFICIENT}}, duration=8.0))
    return folder


@pytest.fixture(scope="module")
def diagnosis(folder: Path) -> harness.Diagnosis:
    """Made in this process alone."""
    return harness.diagnose(folder)


@pytest.fixture(scope="module")
def saved(diagnosis: harness.Diagnosis, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What it writes."""
    return diagnosis.save(tmp_path_factory.mktemp("saved"))


@pytest.mark.slow
def test_the_effect_is_found_with_its_interval(diagnosis: harness.Diagnosis) -> None:
    """Name the hidden effect, and hold its value within the interval."""
    assert diagnosis.verdict == "effect"
    coefficient = diagnosis.effects["rolling_resistance"]["coefficient"]
    low, high = coefficient.interval
    assert low is not None
    assert high is not None
    assert low < COEFFICIENT < high
    assert coefficient.unit == "1"


@pytest.mark.slow
def test_ledger_and_errors_are_tables(diagnosis: harness.Diagnosis) -> None:
    """Give a row an attempt, and errors before and after by data, source and horizon."""
    ledger, errors = diagnosis.ledger, diagnosis.errors
    assert {"effect", "kept", "because"} <= set(ledger.columns)
    assert "rolling_resistance" in set(ledger.loc[ledger["kept"], "effect"])
    whole = errors[(errors["data"] == "heldout") & (errors["horizon"] == "whole")].set_index("source")
    assert {"cam", "mujoco", "pybullet"} == set(whole.index)
    assert (whole["after_m"] < whole["before_m"]).all()


@pytest.mark.slow
def test_it_shows_itself(diagnosis: harness.Diagnosis) -> None:
    """Say the verdict and the value, as text, as HTML and as a picture."""
    for shown in (repr(diagnosis), diagnosis._repr_html_()):
        assert "rolling resistance of 0.0040" in shown
        assert "rolling_resistance" in shown
    assert diagnosis.plot().axes[0].get_ylabel() == "position s [m]"


@pytest.mark.slow
def test_a_saved_diagnosis_predicts_the_same(diagnosis: harness.Diagnosis, saved: Path, folder: Path) -> None:
    """Predict blank positions within a few millimetres, with a band; from the file to the bit, as was written."""
    assert {"diagnosis.json", "diagnosis.html", "prediction_rec_03.csv"} <= {file.name for file in saved.iterdir()}
    prediction = diagnosis.predict(folder / "rec_03.csv")
    assert list(prediction.columns) == ["time_s", "ball_position_m", "low_m", "high_m"]
    truth = pd.read_csv(folder / "rec_03_true.csv")["ball_position_m"]
    # 1 mm/s of error at the start, which 0.3 mm of noise over two seconds leaves, is 6 mm at the end of 8 s.
    assert float(np.sqrt(np.mean((prediction["ball_position_m"] - truth) ** 2))) < 6e-3
    again = harness.load_diagnosis(saved)
    assert again.verdict == diagnosis.verdict
    pd.testing.assert_frame_equal(again.predict(folder / "rec_03.csv"), prediction, check_exact=True)
    written = pd.read_csv(saved / "prediction_rec_03.csv")
    pd.testing.assert_frame_equal(written, prediction, check_exact=False, atol=0.51e-6, rtol=0.0)


@pytest.mark.slow
def test_its_ledger_comes_out_again(saved: Path, diagnosis: harness.Diagnosis, folder: Path) -> None:
    """Replay from the file and from the object."""
    assert harness.replay(saved, folder).reproduced
    assert harness.replay(diagnosis, folder).attempts == len(diagnosis.ledger)


def test_a_file_is_enough_to_predict(tmp_path: Path) -> None:
    """Predict a recording with the model of a diagnosis.json alone, whatever folder the file is in."""
    case = write_short_case(tmp_path / "case")
    file = tmp_path / "diagnosis.json"
    file.write_text(nothing_missing(case).text(), encoding="utf-8")
    kept = harness.load_diagnosis(tmp_path)
    assert (kept.verdict, kept.effects, len(kept.ledger)) == ("none", {}, 0)
    prediction = kept.predict(case / "rec_01.csv")
    assert (prediction["low_m"] < prediction["ball_position_m"]).all()
    assert str(file) in repr(kept)


def test_no_process_is_forked_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refuse bad input before anything, and stay in this process: `os.fork` is not called."""
    monkeypatch.setattr(os, "fork", lambda: pytest.fail("forked"))
    case = write_short_case(tmp_path / "case")
    with pytest.raises(harness.InputError, match="which is in use already"):
        harness.diagnose(case, also=[case / "rec_01.csv"])


def test_effects_of_ones_own_leave_the_catalogue_again(tmp_path: Path) -> None:
    """Know the effects of a file for as long as the call lasts, also where it ends by an error."""
    from analytic.effects import CATALOGUE

    case = write_short_case(tmp_path / "case")
    with pytest.raises(harness.InputError, match="in use already"):
        harness.diagnose(case, effects=[MAGNET], also=[case / "rec_01.csv"])
    assert "magnet" not in CATALOGUE
