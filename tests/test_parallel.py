"""Jobs in processes: results in order, errors passed on, and nothing left to hang where a process dies."""

from __future__ import annotations

import multiprocessing
import os
import time
from collections.abc import Callable

import pytest

from harness.errors import HarnessError, InputError
from harness.parallel import meanwhile, side_by_side


def late(value: int) -> Callable[[], int]:
    """A job whose function no pickle could carry, the sooner done the larger its value."""
    return lambda: time.sleep(0.02 * (4 - value)) or value


def test_results_come_in_the_order_of_jobs() -> None:
    """Sort by job, not by when each was done, and count what is done."""
    told: list[int] = []
    assert side_by_side([late(value) for value in range(4)], 2, told.append) == [0, 1, 2, 3]
    assert told == [1, 2, 3, 4]


def test_nothing_to_do_is_done() -> None:
    """Return no results of no jobs."""
    assert side_by_side([], 2) == []


def test_jobs_run_beside_this_process_and_see_what_it_has() -> None:
    """Run in another process that has the parent's objects, while the parent goes on."""
    here = os.getpid()
    with meanwhile([os.getpid, lambda: here], 2) as results:
        assert here not in results()[:1]
        assert results()[1] == here


def test_one_worker_is_this_process() -> None:
    """Start no process unless asked for more than one."""
    assert side_by_side([os.getpid, os.getpid], 1) == [os.getpid()] * 2


def test_an_error_of_a_job_is_passed_on() -> None:
    """Raise what the job raised."""

    def bad() -> int:
        raise InputError("rec_02.csv: no positions")

    with pytest.raises(InputError, match="rec_02"):
        side_by_side([late(0), bad, late(1)], 2)


def test_a_process_that_dies_is_told() -> None:
    """End with a message instead of waiting for ever."""
    with pytest.raises(HarnessError, match="a process ended"):
        side_by_side([late(0), lambda: os._exit(9)], 2)


def test_an_error_of_the_parent_ends_the_jobs() -> None:
    """Wait for no job that has not begun when the block fails."""
    done = multiprocessing.Value("i", 0)

    def job() -> None:
        time.sleep(0.2)
        with done.get_lock():
            done.value += 1

    with pytest.raises(InputError), meanwhile([job] * 20, 2):
        raise InputError("elsewhere")
    # Two that run and, in their queue, three more; twice as many would mean that the queue is longer than that.
    assert done.value < 10


def _within(results: multiprocessing.SimpleQueue[bool]) -> None:
    pids = side_by_side([os.getpid, os.getpid], 2)
    results.put(pids == [os.getpid()] * 2)


def test_one_of_several_processes_starts_no_more() -> None:
    """Stay in this process where it shares the cores with others already."""
    context = multiprocessing.get_context("fork")
    results: multiprocessing.SimpleQueue[bool] = context.SimpleQueue()
    process = context.Process(target=_within, args=(results,))
    process.start()
    assert results.get()
    process.join()
