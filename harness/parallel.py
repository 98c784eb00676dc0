"""Jobs in several forked processes, which share the state of their parent; used only if a caller asks for it.

For work that holds Python's global lock; compiled code that releases it needs only threads. Processes that start fresh,
such as those of joblib, would import engines and compiled code for longer than most jobs last, and would lack effects
that the user added to the catalogue. Forking is unsafe in programs whose threads hold locks, such as notebooks, so the
default everywhere is a single process.
"""

import multiprocessing
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from multiprocessing.connection import wait
from queue import SimpleQueue
from typing import Any, TypeVar

from harness.errors import HarnessError
from harness.worker import Worker, WorkerEnded, signals_held_back

T = TypeVar("T")
Results = Callable[[], list[T]]
_Ended = tuple[int, Any, BaseException | None]  # number of a job, its result, or what it raised


def can_fork() -> bool:
    """Whether jobs can run in forked processes: on Linux, and not within one of several processes."""
    return sys.platform == "linux" and multiprocessing.parent_process() is None


def side_by_side(
    jobs: Sequence[Callable[[], T]], workers: int, on_done: Callable[[int], None] = lambda _: None
) -> list[T]:
    """Results of `jobs`, in their order.

    They run sequentially for one worker, within a worker process, and on systems without a safe fork (Windows, macOS).

    Args:
        jobs: functions whose results can be pickled; they need not be picklable themselves. They must not begin
            processes with `multiprocessing`.
        workers: largest number of processes.
        on_done: called after each job with the number of finished jobs.

    Raises:
        HarnessError: a process ended during a job, or none can be started. Exceptions of a job are passed on, those
            that no pickle carries as one of these.
    """
    with meanwhile(jobs, workers, on_done) as results:
        return results()


@contextmanager
def meanwhile(
    jobs: Sequence[Callable[[], T]], workers: int, on_done: Callable[[int], None] = lambda _: None
) -> Iterator[Results[T]]:
    """As `side_by_side`, but the jobs run while the block does; the function that it is given awaits the results.

    At the end of the block the processes are ended, whatever they do. No other process may be forked within it.

    Raises:
        HarnessError: no process can be started. The function raises what `side_by_side` does.
    """
    workers = min(workers, len(jobs))
    if workers < 2 or not can_fork():
        yield partial(_one_by_one, jobs, on_done)
        return
    # Not a future for each: its lock could stay closed for ever where an interrupt comes while it is taken.
    ended: SimpleQueue[_Ended] = SimpleQueue()
    began: list[Worker] = []
    hands_out = threading.Thread(target=_hand_out, args=(began, len(jobs), ended), daemon=True)

    def end() -> None:
        with signals_held_back():
            for worker in began:
                worker.process.kill()
            if hands_out.is_alive():  # it reads from the pipes until then
                hands_out.join()
            for worker in began:
                worker.end()

    try:
        with signals_held_back():
            for _ in range(workers):
                began.append(Worker.begun(lambda number: jobs[number](), fork=True))
            hands_out.start()
        yield partial(_awaited, len(jobs), ended, on_done, {})
    finally:
        try:
            end()
        except BaseException:  # a signal, before they were held back
            end()
            raise


def _one_by_one(jobs: Sequence[Callable[[], T]], on_done: Callable[[int], None]) -> list[T]:
    results = []
    for job in jobs:
        results.append(job())
        on_done(len(results))
    return results


def _hand_out(workers: Sequence[Worker], count: int, ended: SimpleQueue[_Ended]) -> None:
    """Give each worker the number of one job after another, and pass on what comes of it, until one worker has died."""
    numbers = iter(range(count))
    busy: dict[Any, tuple[int, Worker]] = {}

    def next_to(worker: Worker) -> None:
        number = next(numbers, None)
        if number is not None:
            busy[worker.pipe] = number, worker
            worker.pipe.send(number)

    try:
        for worker in workers:
            next_to(worker)
        while busy:
            for pipe in wait(list(busy)):
                number, worker = busy.pop(pipe)
                try:
                    ended.put((number, worker.answer(), None))
                except WorkerEnded:
                    raise
                except BaseException as error:
                    ended.put((number, None, error))
                next_to(worker)
    except (WorkerEnded, OSError):  # the latter where a number cannot be sent any more
        text = "a process ended during its work; check that there is enough memory"
        ended.put((-1, None, HarnessError(text)))
    except BaseException as error:  # whoever waits has to be told
        ended.put((-1, None, error))


def _awaited(
    count: int, ended: SimpleQueue[_Ended], on_done: Callable[[int], None], results: dict[int, Any]
) -> list[Any]:
    while len(results) < count:
        number, result, error = ended.get()
        if error is not None:
            ended.put((number, result, error))  # for who asks again
            raise error
        results[number] = result
        on_done(len(results))
    return [results[number] for number in range(count)]
