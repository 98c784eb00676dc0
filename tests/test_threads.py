"""Work in threads gives what work one by one gives."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading

import pytest

from harness.parallel import side_by_side
from harness.threads import BLAS_THREADS, in_threads


def test_results_are_in_the_order_of_the_arguments() -> None:
    """Give as many results as arguments, in their order, of a generator too."""
    assert in_threads(lambda x: x * x, (x for x in range(50))) == [x * x for x in range(50)]
    assert in_threads(abs, []) == []


def test_threads_begin_no_threads() -> None:
    """Work one by one within a thread: there are no more threads than processors."""

    def inner(_: int) -> set[int]:
        return set(in_threads(lambda _: threading.get_ident(), range(20)))

    assert all(len(each) == 1 for each in in_threads(inner, range(4)))
    assert threading.get_ident() not in in_threads(lambda _: threading.get_ident(), range(4))


def test_one_process_of_several_begins_no_threads() -> None:
    """Work one by one in a process of several: together they have no more threads than processors."""

    def alone() -> bool:
        return set(in_threads(lambda _: threading.get_ident(), range(20))) == {threading.get_ident()}

    assert side_by_side([alone, alone], 2) == [True, True]


def test_an_exception_is_passed_on() -> None:
    """Raise what an argument raises."""
    with pytest.raises(ZeroDivisionError):
        in_threads(lambda x: 1 // x, [1, 0, 2])


SEVERAL = pytest.mark.skipif(os.cpu_count() == 1, reason="linear algebra has one thread on one processor anyway")

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
