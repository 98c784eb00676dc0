"""Work in threads gives what work one by one gives."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import time

import pytest

from harness.parallel import side_by_side
from harness.threads import BLAS_THREADS, in_threads

SEVERAL = pytest.mark.skipif(os.cpu_count() == 1, reason="there is one thread on one processor anyway")


def test_results_are_in_the_order_of_the_arguments() -> None:
    """Give as many results as arguments, in their order, of a generator too."""
    assert in_threads(lambda x: x * x, (x for x in range(50))) == [x * x for x in range(50)]
    assert in_threads(abs, []) == []


def test_no_more_threads_work_than_there_are_processors() -> None:
    """Have as many calls at work at once as processors, in threads within threads too."""
    lock, at_work, most = threading.Lock(), 0, 0

    def inner(_: int) -> None:
        nonlocal at_work, most
        with lock:
            at_work += 1
            most = max(most, at_work)
        time.sleep(1e-3)
        with lock:
            at_work -= 1

    in_threads(lambda _: in_threads(inner, range(20)), range(4))
    assert most <= (os.cpu_count() or 1)


@SEVERAL
def test_what_ends_last_gets_the_processors_of_the_others() -> None:
    """Map in several threads within a thread, as soon as the others have ended."""

    def inner(last: bool) -> int:
        if not last:
            return 0
        end = time.monotonic() + 60.0  # on a busy machine; threads are counted anew in every call
        while (count := len(set(in_threads(lambda _: time.sleep(1e-3) or threading.get_ident(), range(20))))) == 1:
            assert time.monotonic() < end
        return count

    assert in_threads(inner, [True, *[False] * 10])[0] > 1


def test_one_process_of_several_begins_no_threads() -> None:
    """Work one by one in a process of several: together they have no more threads than processors."""

    def alone() -> bool:
        return set(in_threads(lambda _: threading.get_ident(), range(20))) == {threading.get_ident()}

    assert side_by_side([alone, alone], 2) == [True, True]


def test_an_exception_is_passed_on() -> None:
    """Raise what an argument raises, of several the first, and begin no further arguments."""
    with pytest.raises(ZeroDivisionError):
        in_threads(lambda x: 1 // x, [1, 0, 2])
    begun = []

    def fail(number: int) -> None:
        begun.append(number)
        time.sleep(1e-2)
        raise ValueError(number)

    with pytest.raises(ValueError, match=r"\A0\Z"):
        in_threads(fail, range(1000))
    assert len(begun) <= (os.cpu_count() or 1)
    assert in_threads(abs, [-1, 1]) == [1, 1]  # which has the processors again


# NumPy is loaded before, SciPy within; a pool of processes begins within as well.
BLAS = """
import json, multiprocessing, numpy
from threadpoolctl import threadpool_info
from harness.threads import one_blas_thread

def threads():
    return [each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"]

@one_blas_thread()
def within():
    import scipy.linalg
    with multiprocessing.get_context("fork").Pool(1) as pool:
        return [threads(), pool.apply(threads)]

before = threads()
print(json.dumps({"before": before, "within": within(), "after": threads()}))
"""


def blas_threads(**environment: str) -> dict[str, list[int]]:
    """Threads of each library for linear algebra before, within and after, in a process that has a wish or none."""
    usual = {name: value for name, value in os.environ.items() if name != BLAS_THREADS}
    done = subprocess.run(
        [sys.executable, "-c", BLAS], env={**usual, **environment}, capture_output=True, text=True, check=True
    )
    told: dict[str, list[int]] = json.loads(done.stdout)
    return told


@SEVERAL
def test_linear_algebra_has_one_thread_within_a_call_and_as_many_as_before_after_it() -> None:
    """Limit libraries that are loaded already, one loaded meanwhile and processes begun meanwhile; then free them."""
    told = blas_threads()
    assert told["before"] == [os.cpu_count()]
    assert told["within"] == [[1, 1], [1, 1]]
    assert told["after"] == [os.cpu_count()] * 2


@SEVERAL
def test_threads_of_linear_algebra_that_the_user_asked_for_stay() -> None:
    """Leave alone what the environment says, if the user has set it."""
    told = blas_threads(**{BLAS_THREADS: "2"})
    assert told["within"] == [[2, 2], [2, 2]] == [told["after"]] * 2
