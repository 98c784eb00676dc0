"""Jobs in processes: results in order, errors passed on, and nothing left to hang where a process dies."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from pickle import PicklingError

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

    with pytest.raises(InputError, match="rec_02") as raised:
        side_by_side([late(0), bad, late(1)], 2)
    assert "in bad\n" in "".join(raised.value.__notes__)  # where in the other process


@pytest.mark.parametrize("error", [EOFError("its own"), OSError(5, "its own")])
def test_an_error_as_of_a_pipe_is_one_of_the_job(error: Exception) -> None:
    """Take what a job raises for its own, even if a process that has died shows in the same way."""

    def bad() -> int:
        raise error

    with pytest.raises(type(error), match="its own"):
        side_by_side([bad, late(1)], 2)


def test_an_error_that_cannot_be_sent_is_told() -> None:
    """Pass on in words what no pickle can carry, of a result too."""

    class Own(Exception):
        pass

    def bad() -> int:
        raise Own("some words")

    with pytest.raises(HarnessError, match="Own: some words"):
        side_by_side([bad, late(1)], 2)
    with pytest.raises((AttributeError, TypeError, PicklingError), match="pickle"):
        side_by_side([lambda: lambda: 0, late(1)], 2)


def _bytes_read() -> int:
    """By this process since it began [bytes]."""
    return int(Path("/proc/self/io").read_text(encoding="utf-8").split()[1])


def _interrupted_in_a_result() -> None:
    with meanwhile([lambda: bytes(300_000_000)] * 2, 2):
        begin = _bytes_read()
        while _bytes_read() < begin + 1_000_000:
            time.sleep(1e-3)
        raise KeyboardInterrupt


@pytest.mark.skipif(sys.platform != "linux", reason="there are no forked processes elsewhere")
@pytest.mark.timeout(60)
def test_an_interrupt_in_the_middle_of_a_result_ends_all() -> None:
    """Wait for nothing that a killed process has begun to send, and leave no process and no thread."""
    before = set(multiprocessing.active_children()), threading.active_count()
    with pytest.raises(KeyboardInterrupt):
        _interrupted_in_a_result()
    assert (set(multiprocessing.active_children()), threading.active_count()) == before


def test_a_process_that_dies_is_told() -> None:
    """End with a message instead of waiting for ever."""
    with pytest.raises(HarnessError, match="a process ended"):
        side_by_side([late(0), lambda: os._exit(9)], 2)


def test_an_error_of_the_parent_ends_the_jobs() -> None:
    """End the jobs that run, and begin no other, when the block fails."""
    done = multiprocessing.RawValue("i", 0)  # without a lock, which a process that is ended would keep

    def job() -> None:
        time.sleep(0.2)
        done.value = 1

    with pytest.raises(InputError), meanwhile([job] * 20, 2):
        raise InputError("elsewhere")
    time.sleep(0.3)
    assert done.value == 0


@pytest.mark.skipif(sys.platform != "linux", reason="there are no forked processes elsewhere")
@pytest.mark.parametrize("beside", [False, True])
def test_an_interrupt_at_any_instant_leaves_no_process(beside: bool) -> None:
    """End all processes whenever Ctrl-C comes, also where the system gives it to another thread than the main one."""
    script = (
        "import os, signal, threading, time\n"
        "from harness.parallel import side_by_side\n"
        f"beside = {beside}\n"
        "if beside:\n    threading.Thread(target=time.sleep, args=(60,), daemon=True).start()\n"
        "me, left = os.getpid(), []\n"
        "children = lambda: open(f'/proc/{me}/task/{me}/children').read().split()\n"
        "for after in range(0, 30):\n"
        "    timer = threading.Timer(5e-4 * after, os.kill, (me, signal.SIGINT))\n"
        "    try:\n        timer.start()\n        side_by_side([lambda: time.sleep(60)] * 2, 2)\n"
        "    except KeyboardInterrupt as interrupt:\n        kept = interrupt\n"
        "    left += children()\n"
        "print(len(left))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=120)
    assert (done.stdout, done.stderr) == ("0\n", "")


@pytest.mark.parametrize("error", [SystemExit(3), MemoryError("full")])
def test_what_is_no_usual_exception_is_passed_on_too(error: BaseException) -> None:
    """Raise what ends the job, and take it for no death of its process."""

    def bad() -> int:
        raise error

    with pytest.raises(type(error)):
        side_by_side([bad, late(1)], 2)


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
