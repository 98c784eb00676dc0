"""Trials into rows, several side by side, each in a process with one thread for linear algebra."""

from __future__ import annotations

import multiprocessing
import os
import tempfile
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from benchmarks.calibration.pose import pose
from benchmarks.calibration.rows import Named, Row
from benchmarks.calibration.store import Store
from benchmarks.calibration.trials import Trial
from harness.identify.verdict import Identification, identify

# Read by the libraries when they are loaded, hence before a process begins.
_ALONE = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")


def diagnosed(trial: Trial, source: str) -> Row:
    """Carry out one trial and search it blind; a failure is a row too, for a study must not hide it."""
    begin = time.monotonic()
    try:
        with tempfile.TemporaryDirectory(prefix="calibration-") as folder:
            problem = replace(pose(trial, Path(folder) / "case"), settings=trial.settings)
        begin = time.monotonic()
        return _row(trial, source, identify(problem), time.monotonic() - begin)
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
        depends_on=None if spline is None else str(spline.depends),
        seconds=round(seconds, 1),
    )


def run(trials: Sequence[Trial], store: Store, *, jobs: int, told: Callable[[Row], None] = lambda _: None) -> None:
    """Make the rows that are missing and keep each as soon as it is there; `told` is called with every one of them."""
    missing = store.missing(trials)
    if not missing:
        return
    with _alone(), ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
        pending = [pool.submit(diagnosed, one, store.source) for one in missing]
        try:
            for each in as_completed(pending):
                row = each.result()
                store.append(row)
                told(row)
        except BaseException:  # also when the user stops it: what has not begun need not begin
            pool.shutdown(wait=False, cancel_futures=True)
            raise


@contextmanager
def _alone() -> Iterator[None]:
    """An environment in which processes begin with one thread for linear algebra."""
    before = {name: os.environ.get(name) for name in _ALONE}
    os.environ.update(_ALONE)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
