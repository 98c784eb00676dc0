"""Trials into rows, several side by side, on this machine or others."""

from __future__ import annotations

import tempfile
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from benchmarks.calibration.imperfect import READING
from benchmarks.calibration.pose import pose, sized
from benchmarks.calibration.rows import Named, Row
from benchmarks.calibration.store import Store
from benchmarks.calibration.trials import Trial
from harness.identify.verdict import Identification, identify
from harness.jobs import Executor, Lost

LONGEST = 3600.0
"""Of a trial, which takes a minute: beyond, it hangs [s]."""


def diagnosed(trial: Trial, source: str) -> Row:
    """Carry out one trial and search it blind; a failure is a row too, for a study must not hide it."""
    begin = time.monotonic()
    try:
        with tempfile.TemporaryDirectory(prefix="calibration-") as folder:
            acted = sized(trial, Path(folder) / "sizes") if trial.errors else {}
            posed = pose(replace(trial, hidden=acted or trial.hidden), Path(folder) / "case")
            problem = replace(posed, settings=trial.settings)
        begin = time.monotonic()
        return replace(_row(trial, source, identify(problem), time.monotonic() - begin), acted=acted)
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        text = f"{type(error).__name__}: {error} ({Path(last.filename).name}, line {last.lineno})"
        return Row(trial=trial, source=source, verdict="", seconds=round(time.monotonic() - begin, 1), error=text)


def _row(trial: Trial, source: str, said: Identification, seconds: float) -> Row:
    spline = said.found.terms.spline
    return Row(
        trial=trial,
        source=source,
        verdict=str(said.verdict),
        named=tuple(
            Named(
                one.name,
                {key: (float(e.value), float(e.low), float(e.high)) for key, e in one.parameters.items()},
                tuple(one.indistinguishable_from),
            )
            for one in said.effects
        ),
        depends_on=None if spline is None else READING if spline.sensor else str(spline.depends),
        seconds=round(seconds, 1),
    )


def run(
    trials: Sequence[Trial],
    store: Store,
    *,
    executor: Executor,
    time_limit: float = LONGEST,
    told: Callable[[Row], None] = lambda _: None,
) -> None:
    """Make the rows that are missing and keep each as soon as it is there; `told` is called with every one of them.

    Args:
        trials: of the study.
        store: of the rows.
        executor: runs the trials; one that it loses is a row with an error.
        time_limit: for one trial [s].
        told: is given every new row.
    """
    missing = store.missing(trials)
    work = partial(diagnosed, source=store.source)
    for index, made in executor.run(work, missing, time_limit=time_limit):
        if isinstance(made, Lost):
            made = Row(trial=missing[index], source=store.source, verdict="", seconds=0.0, error=made.message)
        store.append(made)
        told(made)
