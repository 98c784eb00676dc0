"""Work in threads, for compiled code that releases Python's global lock, and linear algebra in one thread meanwhile.

Matrices are so small here that the threads of a linear algebra library only wait for each other, busily: on two busy
cores, a recording took fourteen times as long to read.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from queue import Empty, SimpleQueue
from typing import Any, TypeVar

_S = TypeVar("_S")
_T = TypeVar("_T")

BLAS_THREADS = "OPENBLAS_NUM_THREADS"  # read by OpenBLAS when it is loaded

# One for each processor without a thread of `in_threads`. Not a semaphore: an interrupt that comes while its lock is
# taken would leave it so, and threads waiting for ever.
_idle: SimpleQueue[None] = SimpleQueue()
for _ in range((os.cpu_count() or 1) - 1):
    _idle.put(None)


def in_threads(function: Callable[[_S], _T], arguments: Iterable[_S]) -> list[_T]:
    """`map` in this thread and one more for each idle processor, results in order.

    Within such a thread, too: it gets the processors of those that have ended before it. One by one in one process of
    several, which have the processors for themselves. Nothing depends on how many threads there are: each argument's
    result is computed by itself. Of several exceptions, that of the first argument is raised.
    """
    every = list(arguments)
    if multiprocessing.parent_process() is not None or len(every) < 2:
        return [function(each) for each in every]
    left = deque(enumerate(every))
    results: dict[int, _T] = {}
    raised: dict[int, BaseException] = {}

    def work() -> None:
        while left:
            try:
                number, argument = left.popleft()
            except IndexError:  # another thread took the last one
                return
            try:
                results[number] = function(argument)
            except BaseException as error:
                raised[number] = error
                left.clear()

    def help_out() -> None:
        try:
            work()
        finally:
            _idle.put(None)

    helpers: list[threading.Thread] = []
    try:
        while len(helpers) < len(every) - 1 and _one_is_idle():
            helper = threading.Thread(target=help_out, daemon=True)
            helper.start()
            helpers.append(helper)
        work()
    finally:
        left.clear()
        if helpers:
            _idle.put(None)  # while this thread waits, others have its processor
            for helper in helpers:
                helper.join()
            _idle.get()
    if raised:
        raise min(raised.items(), key=lambda each: (isinstance(each[1], Exception), each[0]))[1]
    return [results[number] for number in range(len(every))]


def _one_is_idle() -> bool:
    """Whether there is an idle processor; it is taken then."""
    try:
        _idle.get(block=False)
    except Empty:
        return False
    return True


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
