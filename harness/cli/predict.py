"""`harness predict`: ball positions from the beam angle, with the model of a diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from harness.api.outputs import sealed_json, to_json, write_csv
from harness.api.same_rig import changed_since, recorded_on_another_rig
from harness.api.saved import load_diagnosis
from harness.api.writing import all_or_nothing, hashes_of
from harness.errors import InputError
from harness.recording import load_recording
from harness.recording.findings import warnings_of


def predict_recording(
    diagnosis: Path, recording: Path, *, out: Path | None, effects: Sequence[Path], force: bool, as_json: bool
) -> tuple[str, tuple[str, ...]]:
    """Predict a recording and write the CSV; what is to be printed, and warnings.

    Args:
        diagnosis, recording: files to read; for the diagnosis also its folder.
        out: CSV to write; `<recording>_predicted.csv` beside the recording if none is given.
        effects: files of effects of the user's own.
        force: replace a file that no prediction wrote, or that has been changed since, too.
        as_json: print JSON.

    Raises:
        InputError: something cannot be read, predicted or written; nothing has been written then.
    """
    kept = load_diagnosis(diagnosis, effects=effects)
    read = load_recording(recording, sensors=kept.sensors)
    target = out or recording.with_name(f"{recording.stem}_predicted.csv")
    if target.name in ("", ".."):
        raise InputError(f"{target}: is a folder; name the CSV file to write with --out")
    # A table has no place for its own record (`harness.api.writing`), so that this is a hidden file beside it.
    record = f".{target.name}.json"
    inputs = (recording, kept.origin, *effects)
    with all_or_nothing(
        target.parent, record=record, names=(target.name, record), inputs=inputs, force=force
    ) as scratch:
        table = kept.predict(read)
        write_csv(table, scratch / target.name)
        told = {
            "command": "predict",
            "diagnosis": kept.record.sealed,
            "recording": {read.name: read.sha256},
            "files": hashes_of(scratch),
        }
        (scratch / record).write_text(sealed_json(told), encoding="utf-8")
    of_diagnosis = changed_since(kept.record, kept.origin), recorded_on_another_rig(kept.record, recording)
    warnings = (*filter(None, of_diagnosis), *map(str, warnings_of(read.findings)))
    travel = kept.record.model.travel_m
    if not as_json:
        return f"prediction: {target} ({len(table)} rows{_within(travel)})", warnings
    summary = {
        "out": str(target),
        "rows": len(table),
        "known": int(read.known.sum()),
        "travel_m": travel,
        "findings": read.findings,
    }
    return to_json(summary), warnings


def _within(travel: tuple[float, float] | None) -> str:
    """What is told of where predictions are kept, if they are."""
    if travel is None:
        return ""
    low, high = travel
    return f", kept between {low:.3g} and {high:.3g} m, where the ball was recorded"
