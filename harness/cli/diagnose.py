"""`harness diagnose`: what the model lacks, into diagnosis.json and a report."""

from __future__ import annotations

import shlex
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import click
import numpy as np

from analytic.motion import FloatArray
from harness.cli.outputs import all_or_nothing, csv_text, report_folder, to_json
from harness.cli.progress import told_on_stderr
from harness.errors import InputError
from harness.identify.design.proposal import FILE
from harness.identify.diagnosis import Diagnosis, diagnose
from harness.identify.estimate.forecast import forecast
from harness.identify.model_file import model_record
from harness.identify.problem.prepare import problem_of, record_of
from harness.identify.selection.ledger_record import ledger_record
from harness.identify.validation.engine_errors import entries
from harness.identify.validation.held_out import BeforeAfter
from harness.provenance import versions
from harness.recording import Case, Recording, load_recording
from harness.recording.source import read_source
from harness.report.diagnosis import render_diagnosis
from harness.report.wording import sentence


def diagnose_case(
    case: Case,
    *,
    out: Path | None = None,
    also: Sequence[Path] = (),
    effects: Sequence[Path] = (),
    as_json: bool = False,
) -> int:
    """Diagnose a case, write its files, say the verdict; return the exit code.

    Args:
        case: as read.
        out: folder to write into.
        also: further recordings of the same rig to hold the result against.
        effects: files whose effects have joined the catalogue (`harness.recording.user_effects`).
        as_json: print diagnosis.json.

    Raises:
        InputError: the case, one of the further recordings or a file's name cannot be used; nothing has been written
            then.
    """
    begin = time.monotonic()
    progress = told_on_stderr()
    folder = out or report_folder(case)
    hashes, tables = input_hashes(case, effects), prediction_files(case)
    with all_or_nothing(folder) as scratch:
        progress("drives and rig")
        problem, _ = problem_of(case)
        further = _further(case, also)
        records = [record_of(case, one, problem.rig)[0] for one in further]
        found = diagnose(problem, progress, also=records, length=case.rig.length)
        record = as_record(found, case, time.monotonic() - begin, hashes, further)
        (scratch / "diagnosis.json").write_text(to_json(record) + "\n", encoding="utf-8")
        progress("report")
        again = _command("replay", folder, case.path, effects=effects)
        command = _command("diagnose", case.path, out=out, also=also, effects=effects)
        page = render_diagnosis(found, record, case, command=command, replay=again)
        (scratch / "diagnosis.html").write_text(page, encoding="utf-8")
        if found.next_experiment is not None:
            (scratch / FILE).write_text(csv_text(found.next_experiment.table()), encoding="utf-8")
        for file, each in tables.items():
            (scratch / file).write_text(csv_text(predictions(found, case, each)), encoding="utf-8")
    progress("")
    files = f"diagnosis: {folder / 'diagnosis.json'}\nreport: {folder / 'diagnosis.html'}"
    click.echo(to_json(record) if as_json else f"{sentence(found)}\n{files}")
    return 0


def _further(case: Case, files: Sequence[Path]) -> list[Recording]:
    """Recordings beside the case's own, each under a name of its own."""
    used = {case.recordings[name].sha256: name for name in case.identify}
    found: dict[str, Recording] = {}
    for file in files:
        one = load_recording(file, rig=case.rig, sensors=case.sensors)
        if one.sha256 in used:
            raise InputError(
                f"{file}: is {used[one.sha256]}, which is in use already; give --also a recording that is not"
            )
        if not one.known.any():
            raise InputError(f"{file}: holds no ball positions, so there is nothing to hold predictions against")
        used[one.sha256] = str(file)
        name = str(file) if one.name in (*found, *case.identify) else one.name
        found[name] = replace(one, name=name)
    return list(found.values())


def _command(
    name: str, *paths: Path, out: Path | None = None, also: Sequence[Path] = (), effects: Sequence[Path] = ()
) -> str:
    """What is to be typed."""
    options = [("--out", out)] if out is not None else []
    options += [*(("--also", file) for file in also), *(("--effects", file) for file in effects)]
    words = [str(word) for option in options for word in option]
    return shlex.join(["harness", name, *map(str, paths), *words])


def input_hashes(case: Case, effects: Sequence[Path] = ()) -> dict[str, str]:
    """SHA-256 of everything that a diagnosis is made from, by file; files of effects by name, wherever they lie.

    Raises:
        InputError: a file of effects cannot be read, or has the name of another file.
    """
    hashes = {name: case.recordings[name].sha256 for name in case.identify}
    hashes |= {"rig.toml": case.sha256} if case.sha256 else {}
    for file in effects:
        if file.name in hashes:
            raise InputError(f"{file}: another file that the diagnosis is made from has this name; rename one of them")
        hashes[file.name] = read_source(file).sha256
    return hashes


def prediction_files(case: Case) -> dict[str, str]:
    """The recordings to predict, by the file that each prediction is written to.

    Raises:
        InputError: two recordings have one stem.
    """
    files: dict[str, str] = {}
    for name in case.predict:
        file = f"prediction_{Path(name).stem}.csv"
        if file in files:
            raise InputError(f"{case.path}: {files[file]} and {name} would both be predicted into {file}; rename one")
        files[file] = name
    return files


def predictions(found: Diagnosis, case: Case, name: str) -> dict[str, FloatArray]:
    """`time_s, ball_position_m` of a recording from its angle and the positions it knows, with a 95 % band."""
    record, _ = record_of(case, case.recordings[name], found.problem.rig)
    return forecast(found.problem, found.found, record, record.reading).table()


def as_record(
    found: Diagnosis,
    case: Case,
    wall_time: float,
    hashes: Mapping[str, str],
    further: Sequence[Recording] = (),
) -> dict[str, Any]:
    """diagnosis.json; `hashes` as of `input_hashes`."""
    shape = found.found.best.shape
    inputs = {"hashes": hashes, "versions": versions()}
    return {
        "schema": 2,
        "verdict": str(found.verdict),
        "sentence": sentence(found),
        "effects": [
            {
                "name": one.name,
                "parameters": {key: asdict(estimate) for key, estimate in one.parameters.items()},
                "indistinguishable_from": list(one.indistinguishable_from),
            }
            for one in found.effects
        ],
        "unlisted": None
        if shape is None
        else {
            "depends_on": [str(one) for one in found.depends_on],
            "shape": {
                "at": shape.places.tolist(),
                "values": shape.nodes.tolist(),
                "unit": shape.unit,
                "friction": shape.friction,
                "low": shape.low,
                "step": shape.step,
            },
        },
        "errors": {
            "identify": _errors(found.identify),
            "heldout": _errors(found.heldout),
            "engines": found.engines,
            "engines_enter": entries(found.found),
            "also": {name: {**_errors(one.errors), "engines": one.engines} for name, one in found.also.items()},
        },
        "hidden_by_unknown_rig": list(found.hidden),
        "baselines": None if found.baselines is None else found.baselines.record(),
        **ledger_record(found.problem, found.selection, inputs),
        "model": model_record(found.problem, found.found, case.sensors),
        "inputs": {
            **inputs,
            "also": {one.name: one.sha256 for one in further},
            "seed": 0,
        },
        "next_experiment": None if found.next_experiment is None else found.next_experiment.record(),
        "wall_time_s": round(wall_time, 2),
    }


def _errors(one: BeforeAfter) -> Mapping[str, Any]:
    return {
        when: {
            "rms_m": dict(each.rms),
            "innovation_correlation": float(np.round(each.whiteness, 4)),
            "innovation_over_noise": float(np.round(each.ratio, 4)),
            "innovation_on_beam": {
                name: {"p": one.p, "correlation": round(one.correlation, 4), "lag_s": round(one.lag, 3)}
                for name, one in each.beam.items()
            },
        }
        for when, each in (("before", one.before), ("after", one.after))
    }
