"""Work in threads gives what work one by one gives."""

from __future__ import annotations

import threading

import pytest

from harness.parallel import side_by_side
from harness.threads import in_threads


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
