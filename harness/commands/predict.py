"""`harness predict`: ball positions from the angle alone, with the model that a diagnosis found."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

import click

from analytic.rig import Rig
from harness.errors import InputError
from harness.outputs import csv_text, to_json
from harness.recording import Sensors, load_recording


def predict_recording(diagnosis: Path, recording: Path, *, out: Path | None = None, as_json: bool = False) -> int:
    """Predict one recording; return the exit code.

    Raises:
        InputError: the diagnosis or the recording cannot be used; nothing has been written then.
    """
    file = diagnosis / "diagnosis.json" if diagnosis.is_dir() else diagnosis
    kept = _model(file)
    sensors = Sensors(**kept["sensors"])
    read = load_recording(recording, sensors=sensors)
    # Imported when what was given is readable: that takes seconds, and an answer to a bad file should not.
    from harness.identify.forecast import forecast
    from harness.identify.keep import read_model
    from harness.identify.prepare import record_from

    record, _ = record_from(read, sensors, Rig(**kept["rig"]))
    problem, found = read_model(kept, record, str(file))
    table = forecast(problem, found, record, record.reading).table()
    target = out or recording.with_name(f"{recording.stem}_predicted.csv")
    _write(target, csv_text(table))
    summary = {"out": str(target), "rows": len(read.time), "known": int(read.known.sum())}
    click.echo(to_json(summary) if as_json else f"prediction: {target} ({len(read.time)} rows)")
    return 0


def _model(file: Path) -> dict[str, Any]:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))["model"]
        if not isinstance(kept, dict) or not {"sensors", "rig"} <= set(kept):
            raise KeyError("model")
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}); give the diagnosis.json of `diagnose`") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{file}: is no diagnosis ({error}); give the diagnosis.json that `diagnose` wrote") from error
    return kept


def _write(target: Path, text: str) -> None:
    """All of it or nothing."""
    try:
        with tempfile.NamedTemporaryFile("w", dir=target.parent, delete=False, encoding="utf-8") as scratch:
            scratch.write(text)
        os.replace(scratch.name, target)
    except OSError as error:
        raise InputError(f"{target}: cannot be written ({error.strerror}); choose another file with --out") from error
