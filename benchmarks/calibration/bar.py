"""Trials run with a progress bar, and a line for each that has ended."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from benchmarks.calibration.rows import Row
from benchmarks.calibration.run import run
from benchmarks.calibration.store import Store
from benchmarks.calibration.trials import Trial
from harness.jobs import executor_on


def run_with_bar(trials: Sequence[Trial], store: Store, *, jobs: int, on: str = "") -> None:
    """Make the rows that are missing and show on stderr how far that is: `jobs` side by side, or `on` a cluster."""
    missing = len(store.missing(trials))
    executor = executor_on(on, jobs)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, TimeRemainingColumn(), console=Console(stderr=True)) as bar:
        bar.console.print(f"{len(trials)} trials, {missing} of them to run (sources {store.source})", highlight=False)
        task = bar.add_task("trials", total=missing)

        def told(row: Row) -> None:
            bar.console.print(_line(row), markup=False, highlight=False, soft_wrap=True)
            bar.advance(task)

        run(trials, store, executor=executor, told=told)


def _line(row: Row) -> str:
    trial = row.trial
    what = f"{trial.study} {trial.name} {trial.size} #{trial.number} {trial.plant} {trial.encoder}"
    what += f" {trial.imperfection}" if trial.imperfection else ""
    setting = f" {trial.setting} × {trial.scale:g}" if trial.setting else ""
    names = " + ".join(one.name for one in row.named) or "nothing"
    spline = f" + a spline term of {row.depends_on}" if row.depends_on else ""
    return f"{what}{setting}: {row.error or names + spline} [{row.outcome}] {row.seconds:.0f} s"
