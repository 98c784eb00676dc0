"""Pages on measured rigs: what they say follows from the diagnoses, and readings that are not free are not drawn."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.measured.__main__ import cases_of, main, write_page
from benchmarks.measured.index import SIMPLE, geometric_mean, index
from benchmarks.measured.page import Rig, page
from harness.api.case import Case, load_case
from harness.api.diagnosis import input_hashes
from harness.api.saved import LoadedDiagnosis
from harness.identify.record import BaselinesRecord, EffectRecord, MarginRecord, ParameterRecord
from harness.identify.validation.baseline_comparison import AFTER, BASELINES, BEFORE, FORECASTS
from harness.recording.case import MEASURED
from tests.api.made import nothing_missing

MILLIMETRES = {BEFORE: 40.0, AFTER: 10.0} | {name: 20.0 + 10.0 * i for i, name in enumerate(BASELINES)}


def compared(sure: bool = True) -> BaselinesRecord:
    """Four blocks with the same error each; the best baseline, a ball at rest, errs by 20 mm, twice the model's."""
    margin = MarginRecord(value=0.01, low=0.001 if sure else -0.001, high=0.02, sure=sure)
    return BaselinesRecord(
        known_s=2.0,
        ahead_s=3.0,
        blocks=4,
        rms_m={name: 1e-3 * size for name, size in MILLIMETRES.items()},
        errors_m={name: (1e-3 * size,) * 4 for name, size in MILLIMETRES.items()},
        blocks_won=dict.fromkeys(BASELINES, 4),
        better_by_m=dict.fromkeys(BASELINES, margin),
    )


@pytest.fixture(scope="module")
def case() -> Case:
    """The measured rig that is built in."""
    return load_case(MEASURED)


@pytest.fixture(scope="module")
def rig(case: Case) -> Rig:
    """A diagnosis of it as if an absurd rolling resistance had been found, with errors that are easily counted."""
    steep = EffectRecord(
        name="rolling_resistance",
        parameters={"coefficient": ParameterRecord(value=0.12, low=0.11, high=0.13, unit="1")},
        indistinguishable_from=("stribeck_friction",),
        implausible=("coefficient",),
    )
    record = nothing_missing(MEASURED)
    inputs = record.inputs.model_copy(update={"hashes": input_hashes(case)})
    changed = {"effects": (steep,), "verdict": "effect", "baselines": compared(), "inputs": inputs}
    return Rig(case, LoadedDiagnosis(record.model_copy(update=changed), MEASURED))


@pytest.mark.slow
def test_the_page_says_what_is_known_found_and_left(rig: Rig) -> None:
    """Quote the rig file, give effects with intervals and rivals, all errors in mm, and what is implausible."""
    text = page(rig)
    assert "> MIT licence, Copyright (c) 2021 Benjamin Gravell" in text
    assert "| mass | 0.03900 kg |" in text
    assert "Not known: rolling radius" in text
    assert "| `coefficient` | 0.120 ± 0.010 (implausible) | `stribeck_friction` |" in text
    assert "| ball at rest | 20.0 | 20.0 | 1.00 … 20.0 | 4 of 4 |" in text
    assert "Implausibly sized, so that it may stand for something else: rolling resistance." in text
    assert "Not surely better" not in text
    unsure = rig.diagnosis.record.model_copy(update={"baselines": compared(sure=False)})
    assert "Not surely better than: ball at rest," in page(Rig(rig.case, LoadedDiagnosis(unsure, MEASURED)))


@pytest.mark.slow
def test_parameters_for_predictions_have_a_row_and_decide_the_ratio(rig: Rig) -> None:
    """Give their error beside that of the effects found, say whether they are used, and take the ratio of what is."""
    plain = compared()
    more = {
        "rms_m": plain.rms_m | {FORECASTS: 0.005},
        "errors_m": plain.errors_m | {FORECASTS: (0.005,) * 4},
    }
    for used, told, ratio in (
        (FORECASTS, "rig use them.", 0.25),
        (AFTER, "rig do not use them, as they predict no better.", 0.5),
    ):
        changed = {"baselines": plain.model_copy(update=more | {"predicting": used})}
        other = Rig(rig.case, LoadedDiagnosis(rig.diagnosis.record.model_copy(update=changed), MEASURED))
        text = page(other)
        assert "| model with parameters fitted to forecasts | 5.00 | 5.00 | — | — |" in text
        assert told in text
        assert other.ratio(SIMPLE) == pytest.approx(ratio)


@pytest.mark.slow
def test_the_table_of_all_rigs_has_their_ratios(rig: Rig) -> None:
    """Divide the model's error by that of the best baseline, and take the geometric mean over rigs."""
    assert rig.ratio(SIMPLE) == pytest.approx(0.5)
    assert rig.ratio(("output_error_2",)) == pytest.approx(0.2)
    assert geometric_mean([0.5, 0.125, np.nan]) == pytest.approx(0.25)
    text = index([rig, rig], "measured_rigs")
    assert text.count("[open_ball_beam](measured_rigs/open_ball_beam.md)") == 2
    assert "| **10.0** |" in text
    assert "**0.50** | **0.50** |" in text


@pytest.mark.slow
def test_short_recordings_have_a_page_too(rig: Rig) -> None:
    """Say that no blocks can be held out."""
    short = Rig(rig.case, LoadedDiagnosis(rig.diagnosis.record.model_copy(update={"baselines": None}), MEASURED))
    assert "too short" in page(short)
    assert "| — |" in index([short], "measured_rigs")


@pytest.mark.slow
def test_only_free_readings_are_drawn(rig: Rig, tmp_path: Path) -> None:
    """Draw windows of the built-in recording, and of another rig its errors by block alone."""
    write_page(rig.case, rig.diagnosis, tmp_path / "free")
    assert {file.name for file in (tmp_path / "free").iterdir()} == {
        "open_ball_beam.md", "open_ball_beam_errors.png", "open_ball_beam_windows.png"
    }  # fmt: skip
    shutil.copytree(MEASURED, tmp_path / "other")
    write_page(load_case(tmp_path / "other"), rig.diagnosis, tmp_path / "kept")
    assert {file.name for file in (tmp_path / "kept").iterdir()} == {"other.md", "other_errors.png"}


@pytest.mark.slow
def test_kept_diagnoses_are_written_anew(rig: Rig, tmp_path: Path) -> None:
    """Write pages and table from a diagnosis of the same files without another search; name a case that is broken."""
    folder, reports = tmp_path / "rigs", tmp_path / "reports"
    shutil.copytree(MEASURED, folder / "open_ball_beam")
    (folder / "broken").mkdir()
    (folder / "broken" / "rig.toml").write_text("[recordings]\nidentify = ['gone.csv']\n", encoding="utf-8")
    (reports / "open_ball_beam").mkdir(parents=True)
    (reports / "open_ball_beam" / "diagnosis.json").write_text(rig.diagnosis.record.text(), encoding="utf-8")
    assert json.loads(rig.diagnosis.record.text())["inputs"]["hashes"] == input_hashes(rig.case)
    out = tmp_path / "measured_rigs"
    done = CliRunner().invoke(main, [str(folder), "--out", str(out), "--reports", str(reports), "--keep"])
    assert done.exit_code == 3
    assert "error: broken:" in done.stderr
    assert (out / "open_ball_beam.md").is_file()
    assert "[open_ball_beam](measured_rigs/open_ball_beam.md)" in (tmp_path / "measured_rigs.md").read_text("utf-8")


def test_a_folder_without_cases_is_refused(tmp_path: Path) -> None:
    """Say what is expected."""
    done = CliRunner().invoke(main, [str(tmp_path)])
    assert done.exit_code == 2
    assert "has no cases; give a folder of folders with a rig.toml each" in done.stderr
    assert cases_of(MEASURED.parent, ("open_ball_beam",)) == [MEASURED]
