"""`python -m benchmarks.faults`: what is left when a command is interrupted, killed, or failed by disk or engine.

Writes the section "Faults survived" of `docs/reliability.md`, and ends with exit code 1 if anything was not survived.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import click
import numpy as np

from benchmarks.faults.scene import Scene
from benchmarks.faults.trials import Trial, disk, parts, signals
from benchmarks.sections import put

DOCS = Path("docs/reliability.md")


def section(trials: Sequence[Trial], seed: int) -> str:
    """The section of `docs/reliability.md`."""
    rows = []
    for fault, command in dict.fromkeys((one.fault, one.command) for one in trials):
        group = [one for one in trials if (one.fault, one.command) == (fault, command)]
        codes = Counter(one.code for one in group)
        said = ", ".join(f"{code}: {count}" for code, count in sorted(codes.items()))
        survived = sum(not one.wrong for one in group)
        rows.append(f"| {fault} | `{command}` | {len(group)} | {said} | {survived} |")
    failed = [
        f"- {one.fault}, `{one.command}`, {one.place}: {one.wrong.splitlines()[0]}" for one in trials if one.wrong
    ]
    survived = sum(not one.wrong for one in trials)
    return _TEXT.format(
        seed=seed,
        instants=sum(one.fault.startswith("SIG") for one in trials),
        rows="\n".join(rows),
        survived=survived,
        count=len(trials),
        failed="\n".join(["", "Not survived:", "", *failed, ""]) if failed else "",
    )


@click.command()
@click.option("--instants", default=200, show_default=True, help="Signals sent, over all commands.")
@click.option("--full", "each", default=8, show_default=True, help="Times that the disk is full, for each command.")
@click.option("--parts/--no-parts", "failing", default=True, help="Whether a worker is killed and engines fail, too.")
@click.option("--seed", default=0, show_default=True, help="Seed of the instants.")
@click.option("--out", type=click.Path(path_type=Path), default=DOCS, show_default=True, help="Page to write into.")
def main(instants: int, each: int, failing: bool, seed: int, out: Path) -> None:
    """Put faults into every command and write what came out."""
    trials = []
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        scene, generator = Scene.of(Path(name)), np.random.default_rng(seed)
        chosen = [
            signals(scene, instants, generator),
            disk(scene, each, generator),
            *([parts(scene)] if failing else []),
        ]
        for one in chain(*chosen):
            trials.append(one)
            outcome = f"NOT SURVIVED: {one.wrong}" if one.wrong else "survived"
            click.echo(f"{one.fault}, {one.command}, {one.place}: exit code {one.code}, {outcome}", err=True)
            # After each of them: what has been measured in an hour is not lost where it is stopped.
            page = out.read_text(encoding="utf-8") if out.exists() else ""
            out.write_text(put("faults", section(trials, seed), page, title="Reliability"), encoding="utf-8")
    sys.exit(1 if any(one.wrong for one in trials) else 0)


_TEXT = """\
## Faults survived

Made by `python -m benchmarks.faults` (seed {seed}, {instants} signals). Each command writes into a folder with an
earlier result of the same command and a file of the user's. Half of the signals come at a random time of the command,
counted from when Python has started; half at a random one of its file operations, the moves of finished files into
place among them. The disk is full from a random file operation on, or a file cannot grow beyond a random size. A
fault is survived if the user's file and all inputs are as they were, the folder holds the earlier result or the new
one, whole (after a kill, or where the disk lets no file be moved back: once the next command has come to the folder),
nothing else is left (but hidden folders after these two, and the runs that a sweep goes on from), no process goes on,
the exit code is right, and there is no traceback; every fourth time the next command is tried, and works (of a sweep
the same one, which goes on). Exit code 0, and 1 of `tune`, which finds nothing to tune in this case: the command had
come to its end before. An engine that hangs is not told by the command itself; it ends at the first signal.

| fault | command | tried | exit codes | survived |
|---|---|---|---|---|
{rows}

{survived} of {count} were survived.
{failed}"""


if __name__ == "__main__":
    main()
