"""Jobs on this machine: every job has its result, whatever happens to the processes."""

from __future__ import annotations

import itertools
import multiprocessing
import os
import signal
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from harness.errors import HarnessError, InputError
from harness.jobs import Executor, Local, Lost, OneProcess, executor_on, gathered
from tests.jobs.functions import always_dies, always_hangs, blocked_signals, killed_once, raised, square

BOTH = pytest.mark.parametrize("executor", [OneProcess(), Local(2)], ids=["one process", "two processes"])


@BOTH
def test_every_job_has_its_result_once(executor: Executor) -> None:
    """Yield the number of each job with its own result."""
    assert dict(executor.run(square, [3.0, 5.0, 7.0])) == {0: 3.0, 1: 25.0 / 3.0, 2: 49.0 / 3.0}
    assert list(executor.run(square, [])) == []


@BOTH
def test_arguments_are_taken_as_they_are_needed(executor: Executor) -> None:
    """Take no more of an endless generator than are under way."""
    taken: list[int] = []

    def endless() -> Iterator[float]:
        for value in itertools.count():
            taken.append(value)
            yield float(value)

    results = executor.run(square, endless())
    for _ in range(4):
        next(results)
    results.close()  # type: ignore[attr-defined]
    assert len(taken) <= 4 + executor.workers


@BOTH
def test_an_error_of_a_job_is_passed_on(executor: Executor) -> None:
    """Raise what the job raised."""
    with pytest.raises(ValueError, match="no 4"):
        list(executor.run(raised, [4]))


def test_an_interrupt_never_reaches_a_worker() -> None:
    """Begin processes with Ctrl-C held back, so that none prints a traceback of its imports, and only them."""
    ours = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    blocked = [result for _, result in Local(2).run(blocked_signals, [1.0, 2.0])]
    assert blocked == 2 * [[signal.SIGINT]]
    assert signal.pthread_sigmask(signal.SIG_BLOCK, []) == ours


def test_all_results_are_gathered_in_the_order_of_the_jobs() -> None:
    """Return them in that order, whichever ends first, and count them as they come."""
    counted: list[int] = []
    jobs = [partial(square, value) for value in (3.0, 5.0, 7.0)]
    assert gathered(Local(2), jobs, counted.append) == [3.0, 25.0 / 3.0, 49.0 / 3.0]
    assert counted == [1, 2, 3]


def test_a_lost_job_among_those_to_be_gathered_is_an_error() -> None:
    """Return nothing where one result is missing, and say why."""
    with pytest.raises(HarnessError, match="its process ended during the work"):
        gathered(Local(2), [partial(always_dies, 0), partial(always_dies, 1)])


def test_a_job_runs_elsewhere() -> None:
    """Use another process than this one, and leave none behind."""
    before = set(multiprocessing.active_children())
    assert os.getpid() not in dict(Local(1).run(_where, [0])).values()
    assert set(multiprocessing.active_children()) == before


def _where(_: int) -> int:
    return os.getpid()


def test_a_job_whose_process_was_killed_is_done_again(tmp_path: Path) -> None:
    """Give the same results as without the kill."""
    tasks = [(float(value), "kill" if value in (1, 4) else "", str(tmp_path)) for value in range(6)]
    assert dict(Local(2).run(killed_once, tasks)) == {value: square(float(value)) for value in range(6)}


def test_a_job_that_always_dies_is_lost_by_name() -> None:
    """Say which job has no result and why; the others have theirs."""
    results = dict(Local(2).run(always_dies, range(4)))
    lost = results.pop(1)
    assert isinstance(lost, Lost)
    assert lost.reason == "process_died"
    assert results == {0: 0, 2: 2, 3: 3}


@pytest.mark.slow
@BOTH
def test_a_job_that_always_hangs_is_lost_by_name(executor: Executor, monkeypatch: pytest.MonkeyPatch) -> None:
    """End it when its time is over; the others have their results."""
    monkeypatch.setattr("harness.jobs.local._STARTING", 20.0)
    results = dict(executor.run(always_hangs, range(4), time_limit=1.0))
    lost = results.pop(1)
    assert isinstance(lost, Lost)
    assert lost.reason == "time_limit"
    assert "more than 1 s" in lost.message
    assert results == {0: 0, 2: 2, 3: 3}


@pytest.mark.parametrize("place", ["dask://", "dask://host", "ray://host:1", "host:8786", "dask://a b:x"])
def test_a_place_that_is_none_is_refused(place: str) -> None:
    """Say how an address is written."""
    with pytest.raises(InputError, match="dask://host:port"):
        executor_on(place)
