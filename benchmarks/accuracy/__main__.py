"""`python -m benchmarks.accuracy`: errors on random motions, in `docs/accuracy.md`, `.json` and the README."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np

from analytic.rig import Rig
from benchmarks.accuracy.motions import Drawn, drawn
from benchmarks.accuracy.page import SCHEME, in_readme, page, summary, table
from benchmarks.accuracy.scheme import leapfrog
from benchmarks.calibration.store import sources_digest
from benchmarks.kept_rows import KeptRows
from harness.engines.catalogue import engine_of, parameters_of
from harness.errors import EngineFailure
from harness.parallel import side_by_side

_STEPS = (1e-3, 1e-4)  # [s]
_DOCS, _README = Path("docs"), Path("README.md")
_ROWS = Path("build/accuracy/errors.jsonl")

Errors = dict[tuple[str, float], float | None]


@click.command()
@click.option("--motions", type=click.IntRange(10), default=100, show_default=True, help="How many motions.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of the motions.")
@click.option(
    "--engine",
    "engines",
    multiple=True,
    default=("mujoco", "pybullet"),
    show_default=True,
    type=click.Choice(["mujoco", "pybullet", "dart"]),
    help="Engine to measure; repeatable.",
)
@click.option("--jobs", type=click.IntRange(1), default=2, show_default=True, help="Processes.")
@click.option("--docs", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Folder of the page.")
@click.option(
    "--readme", type=click.Path(path_type=Path), default=_README, show_default=True, help="File with the section."
)
def main(motions: int, seed: int, engines: tuple[str, ...], jobs: int, docs: Path, readme: Path) -> None:
    """Measure how far the engines are from CAM over random beam motions, and write the tables.

    What has been measured from the same sources is not measured again.

    Example: python -m benchmarks.accuracy --motions 20 --seed 5 --docs build --readme build/README.md
    """
    rows, source = KeptRows(_ROWS, sources_digest()), sources_digest()
    kept = {(row["number"], row["seed"]): row for row in rows.current() if set(engines) <= set(row["engines"])}
    missing = [number for number in range(motions) if (number, seed) not in kept]
    work = [partial(_kept, number, seed, engines, rows) for number in missing]
    told_of = len(missing)
    done = side_by_side(work, jobs, lambda count: click.echo(f"motion {count} of {told_of}", err=True))
    kept |= {(row["number"], row["seed"]): row for row in done}
    found = [kept[number, seed] for number in range(motions)]
    errors = {
        (name, step): [row["errors"][f"{name} {step:g}"] for row in found]
        for name in (*engines, SCHEME)
        for step in _STEPS
    }
    told = summary(errors, max(row["farthest"] for row in found), seed, source)
    text = readme.read_text(encoding="utf-8") if readme.exists() else ""
    (docs / "accuracy.json").write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    (docs / "accuracy.md").write_text(page(told), encoding="utf-8")
    readme.write_text(in_readme(told, text), encoding="utf-8")
    click.echo(table(told))


def _kept(number: int, seed: int, engines: Sequence[str], rows: KeptRows) -> dict[str, Any]:
    """What is found on a motion, written down at once: a measurement that is stopped goes on where it was."""
    farthest, errors = errors_on(number, seed, engines)
    row = {"source": rows.source, "number": number, "seed": seed, "engines": [*engines], "farthest": farthest}
    row["errors"] = {f"{name} {step:g}": error for (name, step), error in errors.items()}
    rows.append(row)
    return row


def errors_on(number: int, seed: int, engines: Sequence[str]) -> tuple[float, Errors]:
    """How far the ball gets from the pivot on a motion [m], and max |s − s_CAM| by engine and time step [µm]."""
    rig = Rig()
    given = drawn(number, rig, seed)
    errors: Errors = {(name, step): _error(name, step, given, rig) for name in engines for step in _STEPS}
    for step in _STEPS:
        errors[SCHEME, step] = 1e6 * float(np.max(np.abs(leapfrog(given, rig, step) - given.position)))
    return float(np.max(np.abs(given.position))), errors


def _error(name: str, time_step: float, given: Drawn, rig: Rig) -> float | None:
    """`None` where the engine found its run invalid."""
    engine = engine_of(name)
    settings = parameters_of(engine, {"time_step": time_step})
    try:
        run = engine.run(rig, given.motion, given.start, given.time, parameters=settings)
    except EngineFailure as failure:
        click.echo(f"motion {given.number}, {time_step:g} s: {failure}", err=True)
        return None
    return 1e6 * float(np.max(np.abs(run.trajectory.position - given.position)))


if __name__ == "__main__":
    main()
