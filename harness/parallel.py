"""Jobs on all cores, in processes that share what their parent has imported and computed.

For work that holds Python's global lock; compiled code that lets go of it needs threads only. A forked process has
everything its parent had, while a fresh one would import for longer than most jobs last.
"""

from __future__ import annotations

import multiprocessing
import os
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


def on_all_cores(jobs: Sequence[Callable[[], T]], told: Callable[[int], None] = lambda _: None) -> list[T]:
    """The results of `jobs`, in their order.

    They run one after another where there is one core, where this process is itself one of several that share the work,
    and where processes cannot be forked safely (Windows has no fork, and macOS's own libraries do not survive one).

    Args:
        jobs: functions whose results can be pickled; they need not be picklable themselves.
        told: called with the number of jobs done, after each.

    Raises:
        HarnessError: a process ended in the middle of a job. What a job raises is passed on.
    """
    with meanwhile(jobs, told) as results:
        return results()


@contextmanager
def meanwhile(jobs: Sequence[Callable[[], T]], told: Callable[[int], None] = lambda _: None) -> Iterator[Results[T]]:
    """As `on_all_cores`, but the jobs go on while the block does; the function that it is given waits for the results.

    No other process may be forked within the block.
    """
    workers = min(os.cpu_count() or 1, len(jobs))
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
