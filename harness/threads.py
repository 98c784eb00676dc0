"""Work in threads, for compiled code that releases Python's global lock."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

_S = TypeVar("_S")
_T = TypeVar("_T")

_here = threading.local()


def in_threads(function: Callable[[_S], _T], arguments: Iterable[_S]) -> list[_T]:
    """`map` in threads, one a processor, results in order.

    One by one within such a thread, for a single argument, and in one process of several, which have the processors for
    themselves. Nothing depends on how many threads there are: each argument's result is computed by itself.
    """
    every = list(arguments)
    if getattr(_here, "inside", False) or multiprocessing.parent_process() is not None or len(every) < 2:
        return [function(each) for each in every]

    def inside(argument: _S) -> _T:
        _here.inside = True
        return function(argument)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(inside, every))
