"""`harness.replay`: whatever a diagnosis says that does not follow from its inputs is listed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import harness
from harness.identify.record import DiagnosisRecord
from harness.identify.selection.ledger_record import digest, fit_hash
from harness.simulator import Experiment, write_case
from tests.shared_data import BUNDLED_RIG

Content = dict[str, Any]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recordings of 8 s of a ball that rolls with resistance."""
    folder = tmp_path_factory.mktemp("replay") / "case"
    write_case(folder, Experiment(hidden={"rolling_resistance": {"coefficient": 0.004}}, duration=8.0, predict=1))
    return folder


@pytest.fixture(scope="module")
def saved(case: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of its diagnosis."""
    return harness.diagnose(case).save(tmp_path_factory.mktemp("saved"))


@pytest.fixture
def content(saved: Path) -> Content:
    """Of diagnosis.json, to be forged."""
    return json.loads((saved / "diagnosis.json").read_text(encoding="utf-8"))


def differing(content: Content, case: Path, folder: Path) -> dict[str, str]:
    """What a replay of the content says differs, by place; it is sealed anew, as who forges it well would do it."""
    file = folder / "diagnosis.json"
    file.write_text(DiagnosisRecord.model_validate_json(json.dumps(content)).text(), encoding="utf-8")
    done = harness.replay(file, case)
    assert done.reproduced is (not done.mismatches)
    return {one.where: one.what for one in done.mismatches}


@pytest.mark.slow
def test_what_was_not_touched_comes_out_again(saved: Path, case: Path) -> None:
    """Find nothing that differs, and say what was not computed anew; with the engines nothing is left out."""
    done = harness.replay(saved, case)
    assert done.mismatches == ()
    assert done.unverified == ("errors of the engines (--engines runs them)",)
    done = harness.replay(saved, case, engines=True)
    assert (done.mismatches, done.unverified) == ((), ())


@pytest.mark.slow
def test_a_search_by_held_out_errors_comes_out_again(tmp_path: Path) -> None:
    """Find nothing that differs on the bundled measured rig, whose result has a band that no decision tells of."""
    made = harness.diagnose(BUNDLED_RIG)
    assert made.record.model.estimator == "free_runs"
    assert harness.replay(made.save(tmp_path / "saved"), BUNDLED_RIG).mismatches == ()


@pytest.mark.slow
def test_a_file_that_the_harness_put_beside_the_recordings_is_no_difference(
    content: Content, case: Path, tmp_path: Path
) -> None:
    """Find nothing that differs where a prediction lay in the folder once, or does since, and was left out."""
    note = {"severity": "note", "where": case.name, "text": "'rec_01_predicted.csv': written by the harness"}
    content["findings"].append({**note, "code": "own-files"})
    assert differing(content, case, tmp_path) == {}


@pytest.mark.slow
def test_every_forged_conclusion_is_listed(content: Content, case: Path, tmp_path: Path) -> None:
    """List verdict, sentence, effects, errors and model that were changed, seal and all, with both values."""
    (effect,) = content["effects"]
    coefficient = effect["parameters"]["coefficient"]
    forged: list[tuple[Content, str, Any, str]] = [
        (content, "verdict", "none", "verdict"),
        (content, "sentence", "All is well.", "sentence"),
        (content, "hidden_by_unknown_rig", ["angle_gain"], "hidden_by_unknown_rig"),
        (effect, "name", "viscous_damping", "effects.0.name"),
        (effect, "indistinguishable_from", ["level_error"], "effects.0.indistinguishable_from"),
        (coefficient, "value", coefficient["value"] * 1.0001, "effects.0.parameters.coefficient.value"),
        (coefficient, "low", coefficient["value"] * 0.9, "effects.0.parameters.coefficient.low"),
        (content["errors"]["heldout"]["after"]["rms_m"], "3 s", 1e-6, "errors.heldout.after.rms_m.3 s"),
        (content["errors"]["identify"]["before"]["rms_m"], "1 s", 1.0, "errors.identify.before.rms_m.1 s"),
        (content["errors"]["identify"]["after"], "innovation_over_noise", 1.0, ".innovation_over_noise"),
        (content["errors"]["engines_enter"], "rolling_resistance", "nowhere", "errors.engines_enter."),
        (content["baselines"]["rms_m"], "after", 1e-6, "baselines.rms_m.after"),
        (content["model"], "process_noise_m2_s3", 1e-6, "model.process_noise_m2_s3"),
        (content["model"], "parameters", [1.0], "model.parameters.0"),
        (content["model"], "band", 2.0, "model.band"),
        (content["model"], "reading_variance_m2", 1e-6, "model.reading_variance_m2"),
        (content["model"]["rig"], "mass", 0.05, "model.rig.mass"),
        (content["model"]["sensors"], "position_noise", 1e-6, "model.sensors.position_noise"),
        (content["next_experiment"], "profile", "steps of mine", "next_experiment.profile"),
        (content["inputs"], "hashes", {}, "inputs.hashes"),
    ]
    for place, key, value, _ in forged:
        place[key] = value
    said = differing(content, case, tmp_path)
    for _, _, _, where in forged:
        assert any(where in at for at in said), where
    assert said["verdict"] == 'is "effect", recorded "none"'
    assert said["effects.0.parameters.coefficient.value"].endswith(f"recorded {coefficient['value']}")
    assert len(said) == len(forged)


def _empty(content: Content) -> str:
    """No attempt at all; the model is the rig as declared."""
    base = next(iter(content["fits"]))
    content.update(ledger=[], fits={base: content["fits"][base]}, found=base)
    return "ledger"


def _unattempted(content: Content) -> str:
    """A rival was never tried."""
    content["ledger"] = [line for line in content["ledger"] if line["tried"] != ["viscous_damping"]]
    return "ledger"


def _broken_off(content: Content) -> str:
    """The result is a fit that the decisions do not lead to."""
    content["found"] = next(line["fit"] for line in content["ledger"] if line["tried"] == ["viscous_damping"])
    return "found"


def _unnamed(content: Content) -> str:
    """The result is not named."""
    content["found"] = ""
    return "found"


def _kept(content: Content) -> str:
    """The first attempt was not kept, it says, hash and all."""
    line = next(line for line in content["ledger"] if line["kept"])
    line["kept"] = False
    line["hash"] = digest({key: value for key, value in line.items() if key != "hash"})
    return "attempt "


@pytest.mark.slow
@pytest.mark.parametrize("forge", [_empty, _unattempted, _broken_off, _unnamed, _kept])
def test_a_forged_search_is_noticed(
    content: Content, case: Path, tmp_path: Path, forge: Callable[[Content], str]
) -> None:
    """Find that a ledger lacks attempts of the search, or that its decisions do not lead to the result."""
    where = forge(content)
    assert any(at.startswith(where) for at in differing(content, case, tmp_path))


@pytest.mark.slow
def test_an_edit_breaks_the_seal(saved: Path, content: Content, case: Path, tmp_path: Path) -> None:
    """Name the seal where a word was changed, and a file beside it that was."""
    for file in saved.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    assert harness.replay(tmp_path, case).reproduced
    content["wall_time_s"] += 1.0
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    (tmp_path / "prediction_rec_03.csv").write_text("time_s,ball_position_m\n", encoding="utf-8")
    assert [one.where for one in harness.replay(tmp_path, case).mismatches] == ["sealed", "prediction_rec_03.csv"]


@pytest.mark.slow
def test_a_step_that_failed_excuses_no_empty_ledger(content: Content, case: Path, tmp_path: Path) -> None:
    """Find that nothing was tried also where a later step of the search is said to have failed."""
    _empty(content)
    content["failures"] = [{"part": "search", "name": "swaps", "message": "failed", "where": ""}]
    assert "ledger" in differing(content, case, tmp_path)


def test_fits_of_earlier_files_keep_their_names(content: Content) -> None:
    """Find a fit by its hash in a file without the keys that came later; what such a key says changes the hash."""
    fits = content["fits"]
    for entry in fits.values():
        for key in ("band_growth_m2_s", "travel_m", "forecast_errors_m"):
            assert not entry.pop(key)
    record = DiagnosisRecord.model_validate(content)
    assert all(fit_hash(record.problem, entry) == name for name, entry in record.fits.items())
    name, entry = next(iter(record.fits.items()))
    assert fit_hash(record.problem, entry.model_copy(update={"travel_m": (0.1, 0.2)})) != name
