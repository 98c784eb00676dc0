"""Reading diagnosis.json, and its JSON Schema."""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from harness.errors import InputError
from harness.identify.record.diagnosis import SCHEMA, DiagnosisRecord

FILE = "diagnosis.json"
SCHEMA_FILE = Path(__file__).parents[2] / "data" / "diagnosis.schema.json"
_LONGEST_SHOWN = 40  # characters of a wrong value in a message


def read_record(path: Path) -> DiagnosisRecord:
    """Read a diagnosis.json, or the one in a folder.

    Raises:
        InputError: it cannot be read, or is not what this version writes.
    """
    file = path / FILE if path.is_dir() else path
    try:
        raw = file.read_bytes()
        content = json.loads(raw)
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}); give the {FILE} of `diagnose`") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{file}: is no diagnosis ({error}); give the {FILE} that `diagnose` wrote") from error
    version = content.get("schema") if isinstance(content, dict) else None
    if version is None:
        raise InputError(f"{file}: is no diagnosis (it has no schema); give the {FILE} that `diagnose` wrote")
    if isinstance(version, bool) or version != SCHEMA:
        raise InputError(
            f"{file}: is no diagnosis that this version can use (schema {version}, not {SCHEMA}); diagnose anew"
        )
    try:
        return DiagnosisRecord.model_validate_json(raw, strict=True)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise unusable(file, ".".join(map(str, first["loc"])), _fault(first)) from error


def unusable(file: Path | str, key: str, fault: str) -> InputError:
    """The error of a diagnosis.json in which a key holds what it cannot."""
    return InputError(f"{file}: is no diagnosis that this version can use ({key}: {fault}); diagnose anew")


def _fault(error: ErrorDetails) -> str:
    """What is wrong, and with which value if that is a short one."""
    text = error["msg"].removeprefix("Value error, ")
    given = error["input"]
    if isinstance(given, dict | list | tuple) or len(repr(given)) > _LONGEST_SHOWN:
        return text
    return f"{text}, not {json.dumps(given)}"


def schema_text() -> str:
    """JSON Schema of the format."""
    schema = DiagnosisRecord.model_json_schema(by_alias=True, mode="serialization")
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return json.dumps(head | schema | {"title": FILE}, indent=2, ensure_ascii=False) + "\n"
