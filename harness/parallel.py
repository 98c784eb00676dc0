"""Jobs in several processes that share what their parent has imported and computed; only where a caller asks for it.

For work that holds Python's global lock; compiled code that lets go of it needs threads only. A forked process has
everything its parent had, while a fresh one, as those of joblib are, would import engines and compiled code for longer
than most jobs last, and would lack the effects that have joined the catalogue. Forking is not safe for every program
(one whose threads hold locks, as a notebook's may), so the default everywhere is this process alone.
"""

from __future__ import annotations

import multiprocessing
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import partial
from typing import Any, TypeVar

from harness.errors import HarnessError

T = TypeVar("T")
Results = Callable[[], list[T]]

_jobs: Sequence[Callable[[], Any]] = ()  # of a forked process


def side_by_side(
    jobs: Sequence[Callable[[], T]], workers: int, told: Callable[[int], None] = lambda _: None
) -> list[T]:
    """The results of `jobs`, in their order.

    They run one after another for a single one of `workers`, where this process is itself one of several that share the
    work, and where processes cannot be forked safely (Windows has no fork, and macOS's own libraries do not survive
    one).

    Args:
        jobs: functions whose results can be pickled; they need not be picklable themselves.
        workers: how many processes may run.
        told: called with the number of jobs done, after each.

    Raises:
        HarnessError: a process ended in the middle of a job. What a job raises is passed on.
    """
    with meanwhile(jobs, workers, told) as results:
        return results()


@contextmanager
def meanwhile(
    jobs: Sequence[Callable[[], T]], workers: int, told: Callable[[int], None] = lambda _: None
) -> Iterator[Results[T]]:
    """As `side_by_side`, but the jobs go on while the block does; the function that it is given waits for the results.

    No other process may be forked within the block.
    """
    workers = min(workers, len(jobs))
    if workers < 2 or sys.platform != "linux" or multiprocessing.parent_process() is not None:
        yield partial(_one_by_one, jobs, told)
        return
    pool = ProcessPoolExecutor(workers, multiprocessing.get_context("fork"), _begin, (jobs,))
    try:
        pending = [pool.submit(_do, index) for index in range(len(jobs))]
        yield partial(_awaited, pending, told)
    finally:
        pool.shutdown(cancel_futures=True)


def _one_by_one(jobs: Sequence[Callable[[], T]], told: Callable[[int], None]) -> list[T]:
    results = []
    for job in jobs:
        results.append(job())
        told(len(results))
    return results


def _awaited(pending: Sequence[Future[T]], told: Callable[[int], None]) -> list[T]:
    try:
        for done, each in enumerate(as_completed(pending), start=1):
            each.result()
            told(done)
    except BrokenProcessPool as error:
        raise HarnessError("a process ended in the middle of its work; is there memory enough?") from error
    return [each.result() for each in pending]


def _begin(jobs: Sequence[Callable[[], Any]]) -> None:
    global _jobs
    _jobs = jobs
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt is the parent's to tell


def _do(index: int) -> Any:
    return _jobs[index]()
