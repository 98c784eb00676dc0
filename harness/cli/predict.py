"""`harness predict`: ball positions from the beam angle, with the model that a diagnosis identified."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from harness.api.outputs import all_or_nothing, to_json, write_csv
from harness.api.saved import load_diagnosis
from harness.recording import load_recording


def predict_recording(
    diagnosis: Path, recording: Path, *, out: Path | None, effects: Sequence[Path], as_json: bool
) -> int:
    """Predict one recording; return the exit code.

    Raises:
        InputError: the diagnosis or the recording cannot be used; nothing has been written then.
    """
    kept = load_diagnosis(diagnosis, effects=effects)
    read = load_recording(recording, sensors=kept.sensors)
    table = kept.predict(read)
    target = out or recording.with_name(f"{recording.stem}_predicted.csv")
    with all_or_nothing(target.parent) as scratch:
        write_csv(table, scratch / target.name)
    summary = {"out": str(target), "rows": len(table), "known": int(read.known.sum())}
    click.echo(to_json(summary) if as_json else f"prediction: {target} ({len(table)} rows)")
    return 0
