"""Quantities of a rig that a settings file gives in place of those of rig.toml: its table `[rig]`."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path

from analytic.naming import did_you_mean
from analytic.rig import RigError
from harness.errors import InputError
from harness.recording.case import Case
from harness.recording.findings import DataFinding
from harness.recording.known_rig import KnownRig
from harness.recording.rig_file import TABLES
from harness.toml_text import parse_toml

TABLE = "rig"
RIG_CHANGES = "rig-changes"
"""Code of the note on them."""
_QUANTITIES = {
    field.alias or name: name
    for table in ("ball", "beam", "environment")
    for name, field in TABLES[table].model_fields.items()
}


def rig_changes(file: Path | None) -> dict[str, float]:
    """The quantities in the table `[rig]` of a settings file, by their names in `KnownRig`; none without it.

    Raises:
        InputError: the file cannot be read, or a key is none of rig.toml's, or its value no number.
    """
    if file is None:
        return {}
    try:
        table = parse_toml(file.read_text(encoding="utf-8-sig")).get(TABLE, {})
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror or error})") from error
    except ValueError as error:
        raise InputError(f"{file}: not valid TOML: {error}") from error
    if not isinstance(table, dict):
        raise InputError(f"{file}: {TABLE} is not a table; write [{TABLE}] above its quantities")
    changes = {}
    for key, value in table.items():
        if key not in _QUANTITIES:
            hint = did_you_mean(key, _QUANTITIES)
            raise InputError(f"{file}: [{TABLE}] has no {key!r}.{hint} Quantities are: {', '.join(_QUANTITIES)}.")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{file}: [{TABLE}] {key} is {value!r}; give a number")
        try:
            changes[_QUANTITIES[key]] = float(value)
        except OverflowError:  # TOML has integers of any length
            raise InputError(f"{file}: [{TABLE}] {key} is too large for a number of physics; correct it") from None
    return changes


def with_rig_changes(case: Case, file: Path | None) -> Case:
    """The case with the quantities of the table `[rig]` of this file, and a note on them.

    Raises:
        InputError: the file cannot be used, or the rig cannot exist with them.
    """
    changes = rig_changes(file)
    if not changes or file is None:
        return case
    try:
        rig = KnownRig(**asdict(case.rig) | changes)
    except RigError as error:
        raise InputError(f"{file}: [{TABLE}]: impossible rig: {error}. Correct the values or their units.") from error
    told = ", ".join(f"{name.replace('_', ' ')} {value:.6g}" for name, value in changes.items())
    text = f"replaces quantities of the rig for all models and engines: {told}."
    note = DataFinding("note", file.name, text, RIG_CHANGES)
    return replace(case, rig=rig, findings=(*case.findings, note), rig_from=dict.fromkeys(changes, file.name))
