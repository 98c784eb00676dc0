"""diagnosis.json as one model: written, published as a schema, read back, and refused with one message."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.api.saved import load_diagnosis
from harness.errors import InputError
from harness.exports.model import export_model
from harness.identify.record import SCHEMA_FILE, DiagnosisRecord, ErrorsRecord, read_record, schema_text
from harness.provenance import seal_of
from harness.recording import load_case
from tests.acceptance.short import write_short_case
from tests.api.made import nothing_missing

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short one."""
    return write_short_case(tmp_path_factory.mktemp("record") / "case")


@pytest.fixture(scope="module")
def record(case: Path) -> DiagnosisRecord:
    """Of the short case."""
    return nothing_missing(case)


def test_the_schema_is_published() -> None:
    """Ship the schema of exactly this model (`make schema` writes it)."""
    assert SCHEMA_FILE.read_text(encoding="utf-8") == schema_text()


def test_a_record_is_valid_by_its_schema(record: DiagnosisRecord) -> None:
    """Write what the published schema describes."""
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(json.loads(record.text()), json.loads(schema_text()))


def test_a_record_tells_where_the_ball_was(case: Path, record: DiagnosisRecord) -> None:
    """Keep from where to where positions were recorded, which exported scenes need; older records do without."""
    loaded = load_case(case)
    positions = np.concatenate([loaded.recordings[name].position for name in loaded.identify])
    known = positions[np.isfinite(positions)]
    low, high = record.model.visited_m
    assert np.min(known) <= low < high <= np.max(known)
    assert high - low > 0.9 * np.ptp(known)  # half a percent of the readings at either end are left out
    assert export_model(record, "").visited == (low, high)
    older = record.model_copy(update={"model": record.model.model_copy(update={"visited_m": None})})
    assert export_model(older, "").visited is None


def test_the_manual_names_the_keys_that_are_there(record: DiagnosisRecord) -> None:
    """Describe no key in docs/diagnosis.md that the file does not have, and every key at its top."""
    manual = (ROOT / "docs" / "diagnosis.md").read_text(encoding="utf-8")
    table = manual[manual.index("### diagnosis.json") : manual.index("## Catalogue")]
    named = set(re.findall(r"`(\w+)`", " ".join(line.split("|")[1] for line in table.splitlines() if "|" in line)))
    content = json.loads(record.text())
    keys = content.keys() | content["errors"].keys() | content["errors"]["heldout"]["before"].keys()
    assert named <= keys
    unnamed = {"schema", "sentence", "hidden_by_unknown_rig", "model", "inputs", "wall_time_s"}
    assert content.keys() - named <= unnamed


def test_a_record_comes_back_as_it_was(record: DiagnosisRecord, tmp_path: Path) -> None:
    """Lose nothing in the file, and find it by its folder too."""
    (tmp_path / "diagnosis.json").write_text(record.text(), encoding="utf-8")
    read = read_record(tmp_path)
    assert read == read_record(tmp_path / "diagnosis.json")
    assert read == record.with_seal()


def test_a_record_is_sealed(record: DiagnosisRecord, tmp_path: Path) -> None:
    """Write the SHA-256 of the canonical JSON of all but the seal, and tell any other content from it."""
    content = json.loads(record.text())
    seal = content.pop("sealed")
    canonical = json.dumps(content, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    assert hashlib.sha256(canonical.encode()).hexdigest() == seal
    file = tmp_path / "diagnosis.json"
    for change, intact in (({}, True), ({"sentence": "All is well."}, False), ({"sealed": ""}, False)):
        file.write_text(json.dumps(content | {"sealed": seal} | change), encoding="utf-8")
        assert read_record(file).intact is intact


def test_a_file_from_before_a_key_was_added_is_intact(record: DiagnosisRecord, tmp_path: Path) -> None:
    """Take a file that was sealed without a key that has a default for intact, until anything else is changed."""
    content = json.loads(record.text())
    del content["model"]["forecast"]
    content["sealed"] = seal_of(content)
    file = tmp_path / "diagnosis.json"
    for change, intact in (({}, True), ({"sentence": "All is well."}, False)):
        file.write_text(json.dumps(content | change), encoding="utf-8")
        assert read_record(file).intact is intact


def test_the_contract_holds(record: DiagnosisRecord) -> None:
    """Have the keys that other programs read."""
    content = json.loads(record.text())
    assert content["schema"] == 3
    assert {"verdict", "effects", "unlisted", "errors", "ledger", "inputs"} <= content.keys()
    assert {"identify", "heldout", "engines"} <= content["errors"].keys()
    assert {"before", "after"} == content["errors"]["heldout"].keys()
    assert {"hashes", "versions", "seed"} <= content["inputs"].keys()


def test_what_is_no_number_is_null() -> None:
    """Write null for infinity and NaN, which JSON does not have."""
    one = ErrorsRecord(
        rms_m={"1 s": math.inf}, innovation_correlation=math.nan, innovation_over_noise=1.0, innovation_on_beam={}
    )
    assert json.loads(one.model_dump_json())["rms_m"] == {"1 s": None}
    assert one.innovation_correlation is None


def _older(content: dict[str, Any]) -> str:
    content["schema"] = 1
    return r"schema 1, not 3\); diagnose anew"


def _strange(content: dict[str, Any]) -> str:
    content["model"]["rig"]["of_another_version"] = 1.0
    return r"model\.rig\.of_another_version.*diagnose anew"


def _incomplete(content: dict[str, Any]) -> str:
    del content["ledger"]
    return r"ledger: Field required\); diagnose anew"


def _nothing(content: dict[str, Any]) -> str:
    content.clear()
    return "is no diagnosis"


@pytest.mark.parametrize("spoil", [_older, _strange, _incomplete, _nothing])
def test_what_cannot_be_used_is_refused(
    record: DiagnosisRecord, tmp_path: Path, spoil: Callable[[dict[str, Any]], str]
) -> None:
    """Say in one message what is wrong and what to do."""
    content = json.loads(record.text())
    said = spoil(content)
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=said):
        read_record(tmp_path)


@pytest.mark.parametrize(
    ("text", "said"), [(None, "cannot be read"), ("no JSON", "is no diagnosis"), ("[]", "no schema")]
)
def test_what_is_no_diagnosis_is_refused(tmp_path: Path, text: str | None, said: str) -> None:
    """Say so of a missing file, of what is no JSON, and of other JSON."""
    file = tmp_path / "diagnosis.json"
    if text is not None:
        file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=said):
        read_record(file)


COVARIANCE = [[1e-6, 0.0], [0.0, 1e-6]]
TWO = {"effects": ["viscous_damping", "level_error"], "parameters": [0.1, 0.2], "covariance": COVARIANCE}


@pytest.mark.parametrize(
    ("where", "value", "said"),
    [
        ("schema", 99, "schema 99, not 3"),
        ("schema", True, "schema True, not 3"),
        ("verdict", "certain", "verdict: "),
        ("model.parameters", None, "model.parameters: "),
        ("model.parameters", ["0.1"], r"model.parameters.0: .*not \"0.1\""),
        ("model.parameters", [math.nan], "model.parameters.0: .*finite"),
        ("model.process_noise_m2_s3", -1e-9, "model.process_noise_m2_s3: .*greater than 0, not -1e-09"),
        ("model.process_noise_m2_s3", None, "model.process_noise_m2_s3: "),
        ("model.process_noise_m2_s3", "much", "model.process_noise_m2_s3: "),
        ("model.band", 0.0, "model.band: "),
        ("model.reading_variance_m2", -1.0, "model.reading_variance_m2: "),
        ("model.phases", 10**9, "model.phases is 1000000000, but problem.recordings names 2"),
        ("model.rig.mass", -0.071, "model.rig: mass is -0.071; it must be positive"),
        ("model.rig.rolling_radius", 1.0, "model.rig: rolling_radius 1 m exceeds"),
        ("model.sensors.position_noise", -1.0, "model.sensors.position_noise: "),
        ("model", {**TWO, "covariance": [[1e-6, 0.0]]}, "model: covariance is not a table of 2 rows and columns"),
        ("model", {**TWO, "covariance": [[-1e-6, 0.0], [0.0, 1e-6]]}, "model: covariance has the negative variance"),
        ("model", {**TWO, "covariance": [[1e-6, 0.0], [1e-7, 1e-6]]}, "model: covariance is not symmetric"),
        ("model", {**TWO, "covariance": [[1e-6, 2e-6], [2e-6, 1e-6]]}, "model: covariance is not positive semi-def"),
        ("model.spline_term", {"depends": "angle", "friction": True, "low": 0, "step": 1, "nodes": 9}, "no friction"),
        ("model.spline_term", {"depends": "time", "friction": True, "low": 0, "step": 1, "nodes": 9999}, "nodes: "),
    ],
)
def test_a_number_that_cannot_be_is_refused(
    record: DiagnosisRecord, tmp_path: Path, where: str, value: object, said: str
) -> None:
    """Name file, key and fault of what no diagnosis can have, so that nothing is predicted from it."""
    content = json.loads(record.text())
    *parents, key = where.split(".")
    place = content
    for parent in parents:
        place = place[parent]
    place[key] = {**place[key], **value} if isinstance(place[key], dict) and isinstance(value, dict) else value
    file = tmp_path / "diagnosis.json"
    file.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=rf"diagnosis\.json: .*{said}.*; diagnose anew"):
        load_diagnosis(file)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (TWO | {"parameters": [0.1]} | {"covariance": [[1e-6]]}, r"model\.parameters: 1 numbers, but .* have 2"),
        (TWO | {"parameters": [1e6, 0.2]}, r"model\.parameters\.0: coefficient of viscous_damping is .*between"),
        (TWO | {"covariance": [[None, 0.0], [0.0, 1e-6]]}, r"model\.covariance: holds null"),
        (TWO | {"effects": ["level_error", "level_error"]}, r"model\.effects: .* twice"),
        ({"declared": [{"name": "level_error", "values": {"angle": 3.0}}]}, r"model\.declared: .*between"),
        ({"declared": [{"name": "level_error", "values": {}}]}, r"model\.declared: .*has the parameters angle"),
        ({"effects": ["magnet"]}, "the effect magnet is not in the catalogue; .*--effects"),
        ({"sensors": {"angle_resolution": 1e300}}, "its model does not predict .*rec_01.csv"),
    ],
)
def test_a_model_that_no_fit_gives_does_not_predict(
    case: Path, record: DiagnosisRecord, tmp_path: Path, change: dict[str, object], said: str
) -> None:
    """Refuse to predict with parameters out of bounds, too few, or of unknown uncertainty, and say which."""
    content = json.loads(record.text())
    content["model"] |= change
    file = tmp_path / "diagnosis.json"
    file.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=rf"diagnosis\.json: .*{said}"):
        load_diagnosis(file).predict(case / "rec_01.csv")


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"angle": {"value": 9.0, "low": None, "high": None, "unit": "rad"}}, "value: 9 is not between"),
        ({"angle": {"value": 0.1, "low": None, "high": None, "unit": "m"}}, "unit: it is 'rad', not 'm'"),
        ({"tilt": {"value": 0.1, "low": None, "high": None, "unit": "rad"}}, "level_error has angle, not tilt"),
    ],
)
def test_an_effect_that_cannot_be_is_refused(
    record: DiagnosisRecord, tmp_path: Path, parameters: dict[str, object], said: str
) -> None:
    """Refuse an effect of the catalogue with a value, a unit or a parameter that it cannot have."""
    content = json.loads(record.text())
    content["effects"] = [{"name": "level_error", "parameters": parameters, "indistinguishable_from": []}]
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(InputError, match=rf"effects\.0\.parameters.*{said}.*; diagnose anew"):
        load_diagnosis(tmp_path)


def test_an_interval_that_is_not_known_is_taken(record: DiagnosisRecord, tmp_path: Path) -> None:
    """Read null where the recordings do not bound a value."""
    content = json.loads(record.text())
    value = {"value": 0.01, "low": None, "high": None, "unit": "rad"}
    content["effects"] = [{"name": "level_error", "parameters": {"angle": value}, "indistinguishable_from": []}]
    (tmp_path / "diagnosis.json").write_text(json.dumps(content), encoding="utf-8")
    assert load_diagnosis(tmp_path).effects["level_error"]["angle"].interval == (None, None)


def test_other_programs_find_what_they_read() -> None:
    """Keep the names of the public contract: effects with intervals, unlisted law, errors, ledger, inputs."""
    schema = json.loads(schema_text())
    parts = {name: set(part["properties"]) for name, part in schema["$defs"].items() if "properties" in part}
    assert {"schema", "verdict", "effects", "unlisted", "errors", "ledger", "inputs"} <= set(schema["properties"])
    assert parts["UnlistedRecord"] == {"depends_on", "shape"}
    assert parts["ParameterRecord"] == {"value", "low", "high", "unit"}
    assert parts["EffectRecord"] == {
        "name",
        "parameters",
        "indistinguishable_from",
        "by_recording",
        "implausible",
        "together",
    }
    assert {"identify", "heldout", "engines"} <= parts["AllErrorsRecord"]
    assert {"effect", "kept", "because"} <= parts["LedgerLine"]
