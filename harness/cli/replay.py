"""`harness replay`: does the ledger of a diagnosis come out again?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import click

from harness.api.outputs import to_json
from harness.api.replay import Replayed, replay


def replay_case(diagnosis: Path, path: Path, *, refit: bool, effects: Sequence[Path], as_json: bool) -> int:
    """Replay a diagnosis on its case, say what does not come out again; return the exit code.

    Raises:
        InputError: the diagnosis cannot be used, or the case is not the one that it was made from.
    """
    done = replay(diagnosis, path, refit=refit, effects=effects, progress=True)
    content = asdict(done)
    said = {"diagnosis": str(content.pop("origin")), "reproduced": done.reproduced, **content}
    click.echo(to_json(said) if as_json else _text(done, refit))
    return 0 if done.reproduced else 1


def _text(done: Replayed, refit: bool) -> str:
    how = "fitted on from their numbers" if refit else f"deviances to {done.largest:.1g}"
    lines = [f"{one.where}: {one.what}" for one in done.mismatches]
    lines += [f"note: {name} {change} since then" for name, change in done.other_versions.items()]
    said = "nothing differs" if done.reproduced else f"{len(done.mismatches)} do not come out again"
    return "\n".join([*lines, f"{done.attempts} attempts, {done.fits} fits replayed ({how}): {said}"])
