"""`harness diagnose`: what the model lacks, into diagnosis.json and a report."""

from __future__ import annotations

import shlex
import time
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import click
import numpy as np
import pandas as pd

from harness.identify.forecast import forecast
from harness.identify.keep import model_record
from harness.identify.prepare import problem_of, record_of
from harness.identify.verdict import Diagnosis, diagnose, sentence
from harness.identify.verify import Comparison
from harness.outputs import all_or_nothing, report_folder, to_json
from harness.progress import told_on_stderr
from harness.recording import Case, load_case
from harness.report.diagnosis import render_diagnosis


def diagnose_case(path: Path, *, out: Path | None = None, as_json: bool = False) -> int:
    """Diagnose a case, write its files, say the verdict; return the exit code."""
    begin = time.monotonic()
    case = load_case(path)
    progress = told_on_stderr()
    folder = out or report_folder(case)
    with all_or_nothing(folder) as scratch:
        progress("drives and rig")
        problem, _ = problem_of(case)
        found = diagnose(problem, progress)
        record = as_record(found, case, time.monotonic() - begin)
        (scratch / "diagnosis.json").write_text(to_json(record) + "\n", encoding="utf-8")
        progress("report")
        page = render_diagnosis(found, record, case, command=_command(path, out))
        (scratch / "diagnosis.html").write_text(page, encoding="utf-8")
        for each in case.predict:
            predictions(found, case, each).to_csv(
                scratch / f"prediction_{Path(each).stem}.csv", index=False, float_format="%.6f"
            )
    progress("")
    files = f"diagnosis: {folder / 'diagnosis.json'}\nreport: {folder / 'diagnosis.html'}"
    click.echo(to_json(record) if as_json else f"{sentence(found)}\n{files}")
    return 0


def _command(path: Path, out: Path | None) -> str:
    """What repeats the diagnosis."""
    return shlex.join(["harness", "diagnose", str(path), *([] if out is None else ["--out", str(out)])])


def predictions(found: Diagnosis, case: Case, name: str) -> pd.DataFrame:
    """`time_s, ball_position_m` of a recording from its angle and the positions it knows, with a 95 % band."""
    record, _ = record_of(case, case.recordings[name], found.problem.rig)
    return forecast(found.problem, found.found, record, record.reading).table()


def as_record(found: Diagnosis, case: Case, wall_time: float) -> dict[str, Any]:
    """diagnosis.json."""
    shape = found.found.best.shape
    return {
        "schema": 1,
        "verdict": str(found.verdict),
        "sentence": sentence(found),
        "effects": [
            {
                "name": one.name,
                "parameters": {
                    key: {"value": value, "low": low, "high": high, "unit": unit}
                    for key, (value, low, high, unit) in one.values.items()
                },
                "indistinguishable_from": list(one.indistinguishable_from),
            }
            for one in found.findings
        ],
        "unlisted": None
        if shape is None
        else {
            "depends_on": [str(shape.depends)],
            "shape": {
                "at": shape.places.tolist(),
                "values": shape.nodes.tolist(),
                "unit": shape.unit,
                "friction": shape.friction,
                "low": shape.low,
                "step": shape.step,
            },
        },
        "errors": {"identify": _errors(found.identify), "heldout": _errors(found.heldout), "engines": found.engines},
        "ledger": [
            {
                "effect": entry.effect,
                "beside": list(entry.beside),
                "gain": entry.gain,
                "kept": entry.kept,
                "because": entry.because,
            }
            for entry in found.ledger
        ],
        "model": model_record(found.problem, found.found, case.sensors),
        "inputs": {
            "hashes": {name: case.recordings[name].sha256 for name in case.identify}
            | ({"rig.toml": case.sha256} if case.sha256 else {}),
            "versions": {name: version(name) for name in ("ball-beam-harness", "numpy", "scipy", "numba")},
            "seed": 0,
        },
        "wall_time_s": round(wall_time, 2),
    }


def _errors(one: Comparison) -> Mapping[str, Any]:
    return {
        when: {
            "rms_m": dict(each.rms),
            "innovation_correlation": float(np.round(each.whiteness, 4)),
            "innovation_over_noise": float(np.round(each.ratio, 4)),
        }
        for when, each in (("before", one.before), ("after", one.after))
    }
