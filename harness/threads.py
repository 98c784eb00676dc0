"""Work in threads, for compiled code that releases Python's global lock, and linear algebra in one thread meanwhile.

Matrices are so small here that the threads of a linear algebra library only wait for each other, busily: on two busy
cores, a recording took fourteen times as long to read.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, TypeVar

_S = TypeVar("_S")
_T = TypeVar("_T")

BLAS_THREADS = "OPENBLAS_NUM_THREADS"  # read by OpenBLAS when it is loaded

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


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Linear algebra in one thread, here and in processes begun here; afterwards as before. Decorates functions too.

    What `OPENBLAS_NUM_THREADS` says in the environment stays; the command line sets it before NumPy is loaded.
    """
    if BLAS_THREADS in os.environ:
        yield
        return
    from threadpoolctl import ThreadpoolController

    def libraries() -> dict[str, Any]:
        found = ThreadpoolController().select(user_api="blas").lib_controllers
        return {library.filepath: library for library in found}

    before = {path: library.num_threads for path, library in libraries().items()}
    usual = max(before.values(), default=os.cpu_count() or 1)
    os.environ[BLAS_THREADS] = "1"  # for a library loaded meanwhile, as SciPy brings one of its own
    for library in libraries().values():
        library.set_num_threads(1)
    try:
        yield
    finally:
        os.environ.pop(BLAS_THREADS, None)
        for path, library in libraries().items():
            library.set_num_threads(before.get(path, usual))
