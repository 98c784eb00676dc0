"""Whether a diagnosis is what `diagnose` wrote, and a recording of the rig that it was made on."""

from __future__ import annotations

import math
from pathlib import Path

from harness.errors import InputError
from harness.formatting import number
from harness.identify.record import DiagnosisRecord
from harness.recording import KnownRig
from harness.recording.known_rig import NEEDED, UNITS
from harness.recording.rig_file import read_rig_file

RIG_FILE = "rig.toml"
_SAME = 1e-6  # relative: rig.toml may have been rounded
_CONTRADICTED = "rig-contradicted"  # a finding: the diagnosis has other numbers than its own rig.toml
_REPLACED = ("mass", "inertia", "gravity")  # by it


def changed_since(record: DiagnosisRecord, origin: str | Path) -> str:
    """A warning that a diagnosis, read from `origin`, is not as `diagnose` wrote it; empty if it is."""
    if record.intact:
        return ""
    text = "has been changed since `diagnose` wrote it, or was not sealed; `harness replay` says what differs"
    return f"warning: {origin}: {text}"


def of_another_rig(record: DiagnosisRecord, rig: KnownRig, sha256: str | None, where: str | Path) -> str:
    """A warning that a rig is not that of a diagnosis; empty if it may be the same.

    What one of them does not know tells nothing. Effects that are found are of the rig that they were found on.

    Args:
        record: the diagnosis.
        rig: what is known of the other rig.
        sha256: of its rig.toml; `None` without one.
        where: what is named in the warning.
    """
    if sha256 and record.problem.inputs.hashes.get(RIG_FILE) == sha256:
        return ""
    contradicted = any(one.code == _CONTRADICTED for one in record.findings)
    apart = []
    for name in NEEDED:
        here, there = getattr(rig, name), getattr(record.model.rig, name)
        if here is None or (contradicted and name in _REPLACED) or math.isclose(here, there, rel_tol=_SAME):
            continue
        apart.append(f"{name.replace('_', ' ')} {number(here, 4)} {UNITS[name]}, there {number(there, 4)}")
    if not apart:
        return ""
    return (
        f"warning: {where}: is of another rig than the diagnosis ({'; '.join(apart)}); what was found on one rig need "
        "not act on another"
    )


def recorded_on_another_rig(record: DiagnosisRecord, recording: Path) -> str:
    """The same for a recording, by the rig.toml beside it; empty without one, or if it cannot be read."""
    file = recording.parent / RIG_FILE
    if not file.is_file():
        return ""
    try:
        read = read_rig_file(file)
    except InputError:  # a prediction does not need it
        return ""
    return of_another_rig(record, read.rig, read.sha256, recording)
