"""Many runs over settings, step sizes, rig quantities, effects and recordings: rows, what they say, report."""

from __future__ import annotations

import json
import shutil
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from harness.api.effort import ask
from harness.api.memory import sweep_memory
from harness.api.outputs import sealed_json, to_json
from harness.api.progress import shown
from harness.api.writing import all_or_nothing, hashes_of, settle, sha256_of, written
from harness.errors import InputError
from harness.failures import Failed, Failures
from harness.progress import Progress
from harness.report.tables import Summarised, Summary
from harness.threads import one_blas_thread

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from harness.sweeps.plan import Plan
    from harness.sweeps.results import Results

RECORD, ROWS, REPORT = "sweep.json", "runs.parquet", "sweep.html"
FILES = (ROWS, REPORT, RECORD)
UNFINISHED = "unfinished_runs"
"""Folder of the rows of a sweep that is not finished, inside the folder of its results."""


@dataclass(frozen=True, repr=False)
class Sweep(Summarised):
    """What `sweep` found.

    Attributes:
        folder: where its files are.
        results: work and precision, best fits, Sobol' indices, failures (`harness.sweeps.results.Results`).
        plan: every run by its number (`harness.sweeps.plan.Plan`).
        report_failures: sections of the report that failed.
    """

    folder: Path
    results: Results
    plan: Plan
    report_failures: tuple[Failed, ...] = field(default=(), compare=False)

    @property
    def runs(self) -> pd.DataFrame:
        """One row a run: its factors, errors [m], time [s] and failure; docs/sweeps.md has the columns."""
        import pandas as pd

        return pd.read_parquet(self.folder / ROWS)

    @property
    def failed_sources(self) -> tuple[str, ...]:
        """Models and engines of which no run succeeded."""
        failed = Counter[str]()
        for one in self.results.failures:
            failed[one.source] += one.runs
        runs = {name: len(self.plan.recordings) * len(self.plan.designs[name]) for name in self.plan.spec.sources}
        return tuple(name for name, count in runs.items() if failed[name] == count)

    def summary(self) -> Summary:
        """Number of runs, best fits, work and precision, failures."""
        from harness.report.sweep import summary_of

        return summary_of(self.plan, self.results)

    def plot(self) -> Figure:
        """Error against time of each engine and step size."""
        from harness.report.sweep.work_precision import drawn

        return drawn(self.results)

    def content(self) -> Mapping[str, Any]:
        """What `--json` prints: files, numbers of runs, results."""
        files = {"rows": str(self.folder / ROWS), "report": str(self.folder / REPORT)}
        plain: dict[str, Any] = json.loads(to_json(asdict(self.results)))
        return {"out": str(self.folder), **files, **plain, "report_failures": list(map(str, self.report_failures))}


@one_blas_thread()
def sweep(
    spec: str | Path,
    *,
    out: str | Path | None = None,
    jobs: int = 0,
    on: str = "",
    force: bool = False,
    yes: bool = False,
    command: str = "",
    progress: bool | Progress = False,
) -> Sweep:
    """Carry out all runs of a `sweep.toml`, or those that are missing where it was interrupted before.

    Args:
        spec: the `sweep.toml` (docs/sweeps.md).
        out: folder to write into; `reports/<name of the spec>` if none is given. A finished sweep in it is read again.
        jobs: processes on this machine; 0 for none but this one. They start fresh, so that a script that asks for some
            has to protect its entry point by `if __name__ == "__main__":`.
        on: `dask://host:port`, to run on a Dask cluster instead.
        force: discard runs of another sweep in `out`, and replace files that no sweep wrote.
        yes: begin although it takes longer than ten minutes or more than 4 GB of memory.
        command: what repeats the sweep, for the record.
        progress: show a bar on stderr, or a function to be told.

    Raises:
        InputError: the spec, a case or `out` cannot be used; nothing has been written then. A run that fails raises
            nothing: it is a row with the failure's name.
        HarnessError: no job can be run (any more); runs that are done are kept.
    """
    from harness.jobs import executor_on
    from harness.provenance import versions
    from harness.sweeps import Store, plan_of, read_spec
    from harness.sweeps.carry_out import carry_out, total_seconds
    from harness.sweeps.store import begun, differences, refusal, schema_of

    begin = time.monotonic()
    path = Path(spec)
    folder = Path("reports") / path.stem if out is None else Path(out)
    with shown(progress) as tell:
        tell("reading the cases", share=0.0)
        plan = plan_of(read_spec(path))
        about = json.loads(
            to_json({"spec": plan.spec.content, "inputs": plan.inputs, "versions": versions() | _engine_versions(plan)})
        )
        settle(folder)
        kept = _kept(folder)
        changed = [] if kept is None else list(differences(about, kept["about"]))
        if changed and not force:
            raise InputError(refusal(folder, changed))
        if kept is not None and not changed:
            tell("all runs were done before", share=1.0)
            shutil.rmtree(folder / UNFINISHED, ignore_errors=True)
            return _read_again(plan, folder)
        executor = executor_on(on, jobs)
        unfinished = folder / UNFINISHED
        workers = max(1, executor.workers)
        # Workers of a cluster have memory of their own, of which nothing is known but that each makes one run.
        memory = sweep_memory(plan, 1 if on else workers)
        remedy = "sweep fewer points, longer time steps, or with fewer --jobs"
        ask(total_seconds(plan) / workers, memory, remedy, yes=yes or unfinished.is_dir())
        with all_or_nothing(folder, record=RECORD, names=FILES, inputs=(path, *plan.files), force=force) as scratch:
            begun(unfinished, about, anew=force)
            store = Store(unfinished, schema_of(_columns(plan)), len(plan))
            try:
                carry_out(plan, store, executor, tell)
                tell("report", share=1.0)
                store.write(scratch / ROWS)
            finally:
                store.close()
            made = _written(plan, scratch, folder, about, command, time.monotonic() - begin)
        shutil.rmtree(unfinished, ignore_errors=True)
    return made


def _written(plan: Plan, scratch: Path, folder: Path, about: Mapping[str, Any], command: str, seconds: float) -> Sweep:
    """Report and record of rows that are written."""
    from harness.report.sweep import render_sweep
    from harness.sweeps.results import results_of

    results = results_of(plan, scratch / ROWS)
    failures = Failures()
    page = render_sweep(plan, results, scratch / ROWS, command=command, failures=failures)
    (scratch / REPORT).write_text(page, encoding="utf-8")
    record = {
        "schema": 1,
        "command": command,
        "about": about,
        "results": asdict(results),
        "wall_time_s": round(seconds, 3),
        "report_failures": list(map(str, failures.all)),
        "files": hashes_of(scratch),
    }
    (scratch / RECORD).write_text(sealed_json(record), encoding="utf-8")
    return Sweep(folder, results, plan, failures.all)


def _kept(folder: Path) -> Mapping[str, Any] | None:
    """The record of a finished sweep in this folder whose rows are as it wrote them; `None` if there is none."""
    hashes = written(folder / RECORD)
    rows = folder / ROWS
    if ROWS not in hashes or not rows.is_file() or sha256_of(rows) != hashes[ROWS]:
        return None
    content: Mapping[str, Any] = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    return content


def _read_again(plan: Plan, folder: Path) -> Sweep:
    from harness.sweeps.results import results_of

    return Sweep(folder, results_of(plan, folder / ROWS), plan)


def _engine_versions(plan: Plan) -> dict[str, str]:
    from harness.engines.catalogue import ENGINES, engine_of

    return {name: engine_of(name).version() for name in plan.spec.sources if name in ENGINES}


def _columns(plan: Plan) -> dict[str, list[Any]]:
    """Every factor with the values that decide its type."""
    columns: dict[str, list[Any]] = {name: [] for name in plan.names}
    for factors in plan.spec.factors.values():
        for one in factors:
            columns[one.name] += [float(value) for value in one.extremes] if one.range else list(one.values)
    return columns
