"""`harness predict`: ball positions from the angle alone, with the model that a diagnosis found."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from analytic.rig import Rig
from harness.cli.outputs import all_or_nothing, csv_text, to_json
from harness.errors import InputError
from harness.recording import Sensors, load_recording


def predict_recording(diagnosis: Path, recording: Path, *, out: Path | None = None, as_json: bool = False) -> int:
    """Predict one recording; return the exit code.

    Raises:
        InputError: the diagnosis or the recording cannot be used; nothing has been written then.
    """
    file = diagnosis / "diagnosis.json" if diagnosis.is_dir() else diagnosis
    kept, sensors, rig = _model(file)
    read = load_recording(recording, sensors=sensors)
    # Imported when what was given is readable: that takes seconds, and an answer to a bad file should not.
    from harness.identify.estimate.forecast import forecast
    from harness.identify.model_file import read_model
    from harness.identify.problem.prepare import record_from

    record, _ = record_from(read, sensors, rig)
    problem, found = read_model(kept, record, str(file))
    table = forecast(problem, found, record, record.reading).table()
    target = out or recording.with_name(f"{recording.stem}_predicted.csv")
    with all_or_nothing(target.parent) as scratch:
        (scratch / target.name).write_text(csv_text(table), encoding="utf-8")
    summary = {"out": str(target), "rows": len(read.time), "known": int(read.known.sum())}
    click.echo(to_json(summary) if as_json else f"prediction: {target} ({len(read.time)} rows)")
    return 0


def _model(file: Path) -> tuple[dict[str, Any], Sensors, Rig]:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))["model"]
        if not isinstance(kept, dict) or not {"sensors", "rig"} <= set(kept):
            raise KeyError("model")
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}); give the diagnosis.json of `diagnose`") from error
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{file}: is no diagnosis ({error}); give the diagnosis.json that `diagnose` wrote") from error
    try:
        return kept, Sensors(**kept["sensors"]), Rig(**kept["rig"])
    except (TypeError, ValueError) as error:
        raise InputError(f"{file}: is no diagnosis that this version can use ({error}); diagnose anew") from error
