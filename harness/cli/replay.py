"""`harness replay`: check that the ledger of a diagnosis is reproduced."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import click

from harness.api.outputs import to_json
from harness.api.replay import Replayed, replay


def replay_case(diagnosis: Path, path: Path, *, refit: bool, effects: Sequence[Path], as_json: bool) -> int:
    """Replay a diagnosis on its case, print the differences; return the exit code.

    Raises:
        InputError: the diagnosis cannot be used, or the case is not the one that it was made from.
    """
    done = replay(diagnosis, path, refit=refit, effects=effects, progress=True)
    content = asdict(done)
    summary = {"diagnosis": str(content.pop("origin")), "reproduced": done.reproduced, **content}
    click.echo(to_json(summary) if as_json else _text(done, refit))
    return 0 if done.reproduced else 1


def _text(done: Replayed, refit: bool) -> str:
    how = "re-optimised from their parameters" if refit else f"deviances within {done.largest:.1g}"
    lines = [f"{mismatch.where}: {mismatch.what}" for mismatch in done.mismatches]
    lines += [f"note: {name} has changed since: {change}" for name, change in done.other_versions.items()]
    result = "nothing differs" if done.reproduced else f"{len(done.mismatches)} differ"
    return "\n".join([*lines, f"{done.attempts} decisions, {done.fits} fits replayed ({how}): {result}"])
