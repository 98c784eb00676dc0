"""`python -m benchmarks.faults`: what is left when a command is interrupted, killed, or failed by disk or engine.

Writes the section "Faults survived" of `docs/reliability.md`, and ends with exit code 1 if anything was not survived.
"""

from __future__ import annotations

import math
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import click

from benchmarks.calibration.store import sources_digest
from benchmarks.faults.scene import Scene
from benchmarks.faults.trials import COMMANDS, Trial, carried_out, disk, parts, signals
from benchmarks.kept_rows import KeptRows
from benchmarks.sections import put

DOCS = Path("docs/reliability.md")
_ROWS = Path("build/faults/trials.jsonl")


def _kept(rows: KeptRows) -> dict[str, Trial]:
    return {row["spec"]: Trial(**row["result"]) for row in rows.current()}


def section(trials: Sequence[Trial], seed: int, planned: int, source: str) -> str:
    """The section of `docs/reliability.md`.

    Args:
        trials: that were made.
        seed: of their instants.
        planned: how many trials there are to make.
        source: digest of the sources that they were made with.
    """
    rows = []
    kinds = sorted({(one.fault, one.command) for one in trials}, key=lambda kind: (kind[0], COMMANDS.index(kind[1])))
    for fault, command in kinds:
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
        source=source,
        instants=sum(one.fault.startswith("SIG") for one in trials),
        rows="\n".join(rows),
        survived=survived,
        count=len(trials),
        missing=f" {planned - len(trials)} more were planned and not made." if planned > len(trials) else "",
        failed="\n".join(["", "Not survived:", "", *failed, ""]) if failed else "",
    )


@click.command()
@click.option("--instants", default=200, show_default=True, help="Signals sent, over all commands.")
@click.option("--full", "each", default=8, show_default=True, help="Times that the disk is full, for each command.")
@click.option("--parts/--no-parts", "failing", default=True, help="Whether a worker is killed and engines fail, too.")
@click.option("--seed", default=0, show_default=True, help="Seed of the instants.")
@click.option("--command", "chosen", multiple=True, type=click.Choice(COMMANDS), help="Repeatable [default: all].")
@click.option("--minutes", default=math.inf, help="Begin no trial after this time; the next call goes on.")
@click.option("--rows", type=click.Path(path_type=Path), default=_ROWS, show_default=True, help="Trials so far.")
@click.option("--out", type=click.Path(path_type=Path), default=DOCS, show_default=True, help="Page to write into.")
def main(
    instants: int, each: int, failing: bool, seed: int, chosen: tuple[str, ...], minutes: float, rows: Path, out: Path
) -> None:
    """Put faults into every command and write what came out.

    Trials that were made before, of the same sources, are not made again.

    \b
    Examples:
      python -m benchmarks.faults --minutes 9
      python -m benchmarks.faults --command export --command import
      python -m benchmarks.faults --instants 20 --full 1 --no-parts
    """
    until = time.monotonic() + 60.0 * minutes
    kept = KeptRows(rows, sources_digest())
    # Trials of one command after each other: each command is prepared once.
    planned = [*signals(instants, seed), *disk(each, seed), *(parts() if failing else ())]
    planned.sort(key=lambda one: COMMANDS.index(one.command))
    wanted = [one for one in planned if one.command in (chosen or COMMANDS)]
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        before = _kept(kept)
        scene = Scene.of(Path(name)) if any(one.spec not in before for one in wanted) else Scene(Path(name))
        for one, trial, new in carried_out(scene, wanted, before, until):
            if new:
                kept.append({"source": kept.source, "spec": one.spec, "result": asdict(trial)})
                outcome = f"NOT SURVIVED: {trial.wrong}" if trial.wrong else "survived"
                where = f"{trial.fault}, {trial.command}, {trial.place}"
                click.echo(f"{where}: exit code {trial.code}, {outcome}", err=True)
    made = _kept(kept)
    trials = [made[one.spec] for one in planned if one.spec in made]
    click.echo(f"{len(trials)} of {len(planned)} trials are made", err=True)
    page = out.read_text(encoding="utf-8") if out.exists() else ""
    out.write_text(
        put("faults", section(trials, seed, len(planned), kept.source), page, title="Reliability"), encoding="utf-8"
    )
    sys.exit(1 if any(one.wrong for one in trials) else 0)


_TEXT = """\
## Faults survived

Made by `python -m benchmarks.faults` (seed {seed}, {instants} signals, digest of the sources `{source}`). Each
command writes into a folder with an earlier result of the same command and a file of the user's. Half of the signals
come at a random time of the command, counted from when Python has started; half at a random one of its file
operations, the moves of finished files into place among them. The disk is full from a random file operation on, or a
file cannot grow beyond a random size. A fault is survived if the user's file and all inputs are as they were, the
folder holds the earlier result or the new one, whole (after a kill, or where the disk lets no file be moved back:
once the next command has come to the folder), nothing else is left (but hidden folders after these two, and the runs
that a sweep goes on from), no process goes on, the exit code is right, and there is no traceback; every fourth time
the next command is tried, and works (of a sweep the same one, which goes on). Exit code 0, and 1 of `tune`, which
finds nothing to tune in this case: the command had come to its end before. An engine that hangs is not told by the
command itself; it ends at the first signal.

| fault | command | tried | exit codes | survived |
|---|---|---|---|---|
{rows}

{survived} of {count} were survived.{missing}
{failed}"""


if __name__ == "__main__":
    main()
