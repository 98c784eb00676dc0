"""Jobs in several forked processes, which share the state of their parent; used only if a caller asks for it.

For work that holds Python's global lock; compiled code that releases it needs only threads. Processes that start fresh,
such as those of joblib, would import engines and compiled code for longer than most jobs last, and would lack effects
that the user added to the catalogue. Forking is unsafe in programs whose threads hold locks, such as notebooks, so the
default everywhere is a single process.
"""

import ctypes
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

_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>

T = TypeVar("T")
Results = Callable[[], list[T]]

_jobs: Sequence[Callable[[], Any]] = ()  # in a forked process


def can_fork() -> bool:
    """Whether jobs can run in forked processes: on Linux, and not within one of several processes."""
    return sys.platform == "linux" and multiprocessing.parent_process() is None


def side_by_side(
    jobs: Sequence[Callable[[], T]], workers: int, on_done: Callable[[int], None] = lambda _: None
) -> list[T]:
    """Results of `jobs`, in their order.

    They run sequentially for one worker, within a worker process, and on systems without a safe fork (Windows, macOS).

    Args:
        jobs: functions whose results can be pickled; they need not be picklable themselves.
        workers: largest number of processes.
        on_done: called after each job with the number of finished jobs.

    Raises:
        HarnessError: a process ended during a job. Exceptions of a job are passed on.
    """
    with meanwhile(jobs, workers, on_done) as results:
        return results()


@contextmanager
def meanwhile(
    jobs: Sequence[Callable[[], T]], workers: int, on_done: Callable[[int], None] = lambda _: None
) -> Iterator[Results[T]]:
    """As `side_by_side`, but the jobs run while the block does; the function that it is given awaits the results.

    No other process may be forked within the block.
    """
    workers = min(workers, len(jobs))
    if workers < 2 or not can_fork():
        yield partial(_one_by_one, jobs, on_done)
        return
    others = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(workers, multiprocessing.get_context("fork"), _begin, (jobs, os.getpid()))
    try:
        pending = [pool.submit(_do, index) for index in range(len(jobs))]
        yield partial(_awaited, pending, on_done)
    except Exception:
        raise
    except BaseException:  # an interrupt waits for no job, which may be an engine that never returns
        for process in set(multiprocessing.active_children()) - others:
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _one_by_one(jobs: Sequence[Callable[[], T]], on_done: Callable[[int], None]) -> list[T]:
    results = []
    for job in jobs:
        results.append(job())
        on_done(len(results))
    return results


def _awaited(pending: Sequence[Future[T]], on_done: Callable[[int], None]) -> list[T]:
    try:
        for done, future in enumerate(as_completed(pending), start=1):
            future.result()
            on_done(done)
    except BrokenProcessPool as error:
        raise HarnessError("a process ended during its work; check that there is enough memory") from error
    return [future.result() for future in pending]


def _begin(jobs: Sequence[Callable[[], Any]], parent: int) -> None:
    global _jobs
    _jobs = jobs
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles interrupts
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # the parent's handler is none of this process
    end_with(parent)


def end_with(parent: int) -> None:
    """Have the system kill this process when its parent is killed, which else leaves it waiting for work for ever."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it was killed before that
        os._exit(1)


def _do(index: int) -> Any:
    return _jobs[index]()
