"""diagnosis.json as one model: written, published as a schema, read back, and refused with one message."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from harness.errors import InputError
from harness.identify.record import SCHEMA_FILE, DiagnosisRecord, ErrorsRecord, read_record, schema_text
from tests.acceptance.short import write_short_case
from tests.api.made import nothing_missing

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> DiagnosisRecord:
    """Of a short case."""
    return nothing_missing(write_short_case(tmp_path_factory.mktemp("record") / "case"))


def test_the_schema_is_published() -> None:
    """Ship the schema of exactly this model (`make schema` writes it)."""
    assert SCHEMA_FILE.read_text(encoding="utf-8") == schema_text()


def test_a_record_is_valid_by_its_schema(record: DiagnosisRecord) -> None:
    """Write what the published schema describes."""
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(json.loads(record.text()), json.loads(schema_text()))


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
    assert read_record(tmp_path) == read_record(tmp_path / "diagnosis.json") == record


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


def test_other_programs_find_what_they_read() -> None:
    """Keep the names of the public contract: effects with intervals, unlisted law, errors, ledger, inputs."""
    schema = json.loads(schema_text())
    parts = {name: set(part["properties"]) for name, part in schema["$defs"].items() if "properties" in part}
    assert {"schema", "verdict", "effects", "unlisted", "errors", "ledger", "inputs"} <= set(schema["properties"])
    assert parts["UnlistedRecord"] == {"depends_on", "shape"}
    assert parts["ParameterRecord"] == {"value", "low", "high", "unit"}
    assert parts["EffectRecord"] == {"name", "parameters", "indistinguishable_from", "by_recording", "implausible"}
    assert {"identify", "heldout", "engines"} <= parts["AllErrorsRecord"]
    assert {"effect", "kept", "because"} <= parts["LedgerLine"]
