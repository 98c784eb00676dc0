"""`python -m benchmarks.accuracy`: errors on random motions, in `docs/accuracy.md`, `.json` and the README."""

from __future__ import annotations

import importlib.util
import json
from functools import partial
from pathlib import Path

import click
import numpy as np

from analytic.rig import Rig
from benchmarks.accuracy.motions import Drawn, drawn
from benchmarks.accuracy.page import SCHEME, in_readme, page, summary, table
from benchmarks.accuracy.scheme import leapfrog
from benchmarks.calibration.store import sources_digest
from harness.engines.catalogue import engine_of, parameters_of
from harness.errors import EngineFailure
from harness.parallel import side_by_side

_STEPS = (1e-3, 1e-4)  # [s]
_DOCS, _README = Path("docs"), Path("README.md")

Errors = dict[tuple[str, float], float | None]


@click.command()
@click.option("--motions", type=click.IntRange(10), default=100, show_default=True, help="How many motions.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of the motions.")
@click.option("--jobs", type=click.IntRange(1), default=2, show_default=True, help="Processes.")
@click.option("--docs", type=click.Path(path_type=Path), default=_DOCS, show_default=True, help="Folder of the page.")
@click.option(
    "--readme", type=click.Path(path_type=Path), default=_README, show_default=True, help="File with the section."
)
def main(motions: int, seed: int, jobs: int, docs: Path, readme: Path) -> None:
    """Measure how far the engines are from CAM over random beam motions, and write the tables.

    Example: python -m benchmarks.accuracy --motions 20 --seed 5 --docs build --readme build/README.md
    """
    engines = ["mujoco", "pybullet", *(["dart"] if importlib.util.find_spec("dartpy") is not None else [])]
    work = [partial(errors_on, number, seed, engines) for number in range(motions)]
    done = side_by_side(work, jobs, lambda count: click.echo(f"motion {count} of {motions}", err=True))
    errors = {key: [of[key] for _, of in done] for key in done[0][1]}
    told = summary(errors, max(farthest for farthest, _ in done), seed, sources_digest())
    text = readme.read_text(encoding="utf-8") if readme.exists() else ""
    (docs / "accuracy.json").write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    (docs / "accuracy.md").write_text(page(told), encoding="utf-8")
    readme.write_text(in_readme(told, text), encoding="utf-8")
    click.echo(table(told))


def errors_on(number: int, seed: int, engines: list[str]) -> tuple[float, Errors]:
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
