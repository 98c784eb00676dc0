"""Carries out a plan: batches to an executor, rows to the store; a run that gives nothing is a row, too."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Any

from harness.jobs import Executor, Lost
from harness.progress import Progress
from harness.recording import Case
from harness.recording.case import load_case
from harness.sweeps.factors import TIME_STEP
from harness.sweeps.plan import Plan, Run
from harness.sweeps.store import Store
from harness.sweeps.work import Batch, Row, do_batch, failed_row, lean

_BATCH = 1.0  # work that is handed out at a time: much longer than the way to a worker and back [s]
_LARGEST = 32  # runs of a batch: what a kill may cost
# Measured on two cores: time of a step [s], PyBullet's being the slowest engine; only for sizes and estimates.
_STEP = {"mujoco": 3e-5, "cam": 5e-7}
_STEP_OTHER = 9e-5
_CAM_STEP = 2.5e-3


def run_seconds(plan: Plan, run: Run) -> float:
    """About what a run takes [s]."""
    duration = max(plan.durations)
    step = float(run.values.get(TIME_STEP, _CAM_STEP))
    return duration / step * _STEP.get(run.source, _STEP_OTHER) + 0.01


def total_seconds(plan: Plan) -> float:
    """About what all runs take in one process [s], from evenly chosen ones."""
    some = range(0, len(plan), max(1, len(plan) // 500))
    return len(plan) * sum(run_seconds(plan, plan.run(one)) for one in some) / len(some)


def most_steps(plan: Plan) -> float:
    """The most steps that an engine makes in a run of the plan, from evenly chosen ones and those at the ends."""
    some = sorted({*range(0, len(plan), max(1, len(plan) // 500)), len(plan) - 1})
    steps = [float(plan.run(one).values.get(TIME_STEP, _CAM_STEP)) for one in some]
    return min(max(plan.durations), plan.spec.window or math.inf) / min(steps)


def carry_out(plan: Plan, store: Store, executor: Executor, progress: Progress) -> None:
    """Make the rows that are missing.

    Raises:
        HarnessError: no job can be run any more; what has been done is kept.
    """
    told = _Told(len(plan), len(store.missing), progress)
    alone: list[Run] = []  # of batches that gave nothing: one of their runs may cost the others theirs
    if (missing := store.missing).size:
        most = max(1, min(_LARGEST, round(_BATCH / run_seconds(plan, plan.run(int(missing[0]))))))
        sent: dict[int, list[Run]] = {}
        batches = plan.batches((int(one) for one in missing), most)
        for index, rows in executor.run(do_batch, _jobs(plan, batches, sent), time_limit=most * plan.spec.time_limit):
            runs = sent.pop(index)
            if not isinstance(rows, Lost):
                _keep(plan, store, runs, rows, told)
            elif len(runs) > 1:
                alone += runs
            else:
                _keep(plan, store, runs, [failed_row(runs[0], rows.reason, rows.message)], told)
    sent = {}
    for index, rows in executor.run(
        do_batch, _jobs(plan, ([one] for one in alone), sent), time_limit=plan.spec.time_limit
    ):
        runs = sent.pop(index)
        lost = [failed_row(runs[0], rows.reason, rows.message)] if isinstance(rows, Lost) else rows
        _keep(plan, store, runs, lost, told)


def _jobs(plan: Plan, batches: Iterable[list[Run]], sent: dict[int, list[Run]]) -> Iterator[Batch]:
    """Batches as they are sent; `sent` gets the runs of each by its number."""

    @lru_cache(maxsize=1)
    def case_of(number: int) -> Case:
        return load_case(plan.spec.cases[number])

    for index, runs in enumerate(batches):
        sent[index] = runs
        case = lean(case_of(runs[0].case), runs[0].recording)
        yield Batch(case, f"{runs[0].case} {plan.spec.cases[runs[0].case].resolve()}", plan.spec.window, runs)


def _keep(plan: Plan, store: Store, runs: list[Run], rows: list[Row], told: _Told) -> None:
    made = [{**_facts(plan, run), **row} for run, row in zip(runs, rows, strict=True)]
    store.append(made)
    told.add(len(made), sum(one["failure"] is not None for one in made))


def _facts(plan: Plan, run: Run) -> dict[str, Any]:
    at = run.number // plan.per_recording
    return {
        "run": run.number,
        "case": plan.spec.case_names[run.case],
        "recording": run.recording,
        "source": run.source,
        "point": run.point,
        "motion_s": plan.durations[at],  # of a run that gives nothing, as it has none of its own
        **run.values,
    }


class _Told:
    """Tells how far it is, and how long it will take."""

    def __init__(self, runs: int, missing: int, progress: Progress) -> None:
        self.runs, self.missing, self.progress = runs, missing, progress
        self.done = self.failed = 0
        self.begin = self.last = time.monotonic()
        if missing < runs:
            progress(f"{runs - missing} of {runs} runs were done before", share=1.0 - missing / runs)

    def add(self, done: int, failed: int) -> None:
        """So many more."""
        self.done += done
        self.failed += failed
        now = time.monotonic()
        if now - self.last < 1.0 and self.done < self.missing:
            return
        self.last = now
        left = (now - self.begin) / self.done * (self.missing - self.done)
        all_done = self.runs - self.missing + self.done
        text = f"{all_done} of {self.runs} runs, {self.failed} failed, {_duration(left)} left"
        self.progress(text, share=all_done / self.runs)


def _duration(seconds: float) -> str:
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"
