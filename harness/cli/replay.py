"""`harness replay`: does the ledger of a diagnosis come out again?"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from harness.cli.diagnose import input_hashes
from harness.cli.outputs import to_json
from harness.cli.progress import told_on_stderr
from harness.errors import InputError
from harness.identify.problem.prepare import problem_of
from harness.identify.selection.replay import Replay, replay
from harness.provenance import versions
from harness.recording import load_case

_SHOWN = 12  # digits of a hash in a message


def replay_case(
    diagnosis: Path, path: Path, *, refit: bool = False, effects: Sequence[Path] = (), as_json: bool = False
) -> int:
    """Replay a diagnosis on its case, say what does not come out again; return the exit code.

    Raises:
        InputError: the diagnosis cannot be used, or the case is not the one that it was made from.
    """
    file = diagnosis / "diagnosis.json" if diagnosis.is_dir() else diagnosis
    record = _record(file)
    case = load_case(path)
    progress = told_on_stderr()
    try:
        _same_inputs(record["problem"]["inputs"]["hashes"], input_hashes(case, effects), path, file)
        progress("drives and rig")
        problem, _ = problem_of(case, record["problem"]["recordings"])
        done = replay(record, problem, refit=refit, progress=progress)
        other = _other_versions(record["problem"]["inputs"]["versions"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{file}: its ledger cannot be read ({error!r}); diagnose anew") from error
    progress("")
    said = {"diagnosis": str(file), "reproduced": not done.mismatches, **asdict(done), "other_versions": other}
    click.echo(to_json(said) if as_json else _text(done, other, refit))
    return 1 if done.mismatches else 0


def _record(file: Path) -> Mapping[str, Any]:
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(record, dict) or not {"ledger", "fits", "problem"} <= set(record):
            raise ValueError("it has no ledger with hashes")
    except OSError as error:
        raise InputError(f"{file}: cannot be read ({error.strerror}); give the diagnosis.json of `diagnose`") from error
    except ValueError as error:
        raise InputError(f"{file}: cannot be replayed ({error}); give the diagnosis.json of `diagnose`") from error
    return record


def _same_inputs(recorded: Mapping[str, str], now: Mapping[str, str], case: Path, file: Path) -> None:
    for name, hashed in recorded.items():
        if name not in now:
            raise InputError(
                f"{case}: {name}, from which {file} was made, is not in this case; name the right one, and a "
                "file of effects with --effects"
            )
        if now[name] != hashed:
            raise InputError(
                f"{case}: {name} has changed since {file} was made (SHA-256 {now[name][:_SHOWN]}…, recorded "
                f"{hashed[:_SHOWN]}…); restore it, or diagnose anew"
            )
    added = [name for name in now if name not in recorded]
    if added:
        raise InputError(f"{case}: {added[0]} was not there when {file} was made; take it out, or diagnose anew")


def _other_versions(recorded: Mapping[str, str]) -> dict[str, str]:
    """Software that is not what it was: `then → now` by name."""
    now = versions()
    return {name: f"{then} → {now.get(name, 'absent')}" for name, then in recorded.items() if now.get(name) != then}


def _text(done: Replay, other: Mapping[str, str], refit: bool) -> str:
    how = "fitted on from their numbers" if refit else f"deviances to {done.largest:.1g}"
    lines = [f"{one.where}: {one.what}" for one in done.mismatches]
    lines += [f"note: {name} {change} since then" for name, change in other.items()]
    said = "nothing differs" if not done.mismatches else f"{len(done.mismatches)} do not come out again"
    return "\n".join([*lines, f"{done.attempts} attempts, {done.fits} fits replayed ({how}): {said}"])
