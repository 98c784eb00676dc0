"""A limit on the time that a piece of somebody else's Python may take."""

from __future__ import annotations

import ctypes
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_AGAIN = 0.1  # from one exception to the next, where a handler swallows them [s]


class TimeLimit(BaseException):
    """The limit has passed; no handler of `Exception` catches it.

    Attributes:
        seconds: the limit [s].
    """

    def __init__(self, seconds: float = 0.0) -> None:
        self.seconds = seconds
        super().__init__(f"takes more than {seconds:g} s")


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `TimeLimit` where the context lasts longer; a limit around it holds on.

    In the main thread a signal ends waiting, too; in others, and where there are no signals, Python code only. A single
    call of compiled code is not ended before it returns.

    Raises:
        TimeLimit: it lasts longer.
    """
    main = threading.current_thread() is threading.main_thread() and hasattr(signal, "setitimer")
    with _by_signal(seconds) if main else _by_thread(seconds):
        yield


@contextmanager
def _by_signal(seconds: float) -> Iterator[None]:
    over = False

    def stop(number: int, frame: FrameType | None) -> None:
        if not over:
            raise TimeLimit(seconds)

    begin = time.monotonic()
    handler, (left, _) = signal.getsignal(signal.SIGALRM), signal.getitimer(signal.ITIMER_REAL)
    if 0.0 < left <= seconds:  # the limit around this one comes first
        yield
        return
    signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds, _AGAIN)
    try:
        yield
    finally:
        over = True  # a signal that comes now does not leave the timer running
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, handler)
        if left:
            signal.setitimer(signal.ITIMER_REAL, max(left - (time.monotonic() - begin), 1e-3), _AGAIN)


@contextmanager
def _by_thread(seconds: float) -> Iterator[None]:
    thread, over, lock = threading.get_ident(), threading.Event(), threading.Lock()

    def watch() -> None:
        wait = seconds
        while not over.wait(wait):
            with lock:  # nothing is raised in the thread once the context has ended
                if not over.is_set():
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(TimeLimit))
            wait = _AGAIN

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    except TimeLimit as error:
        error.seconds = error.seconds or seconds
        raise
    finally:
        with lock:
            over.set()
