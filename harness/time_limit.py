"""A limit on the time that a piece of somebody else's Python may take."""

from __future__ import annotations

import ctypes
import signal
import sys
import threading
import time
from contextlib import AbstractContextManager
from types import CodeType, FrameType, TracebackType

_AGAIN = 0.1  # from one exception to the next, where a handler swallows them [s]


class TimeLimit(BaseException):
    """The limit has passed; no handler of `Exception` catches it.

    Attributes:
        seconds: the limit [s].
    """

    def __init__(self, seconds: float = 0.0) -> None:
        self.seconds = seconds
        super().__init__(f"takes more than {seconds:g} s")


def time_limit(seconds: float) -> AbstractContextManager[None]:
    """Raise `TimeLimit` where the context lasts longer; a limit around it holds on.

    In the main thread a signal ends waiting, too; in others, and where there are no signals, Python code only. A single
    call of compiled code is not ended before it returns.

    Raises:
        TimeLimit: it lasts longer.
    """
    main = threading.current_thread() is threading.main_thread() and hasattr(signal, "setitimer")
    return _BySignal(seconds) if main else _ByThread(seconds)


# Both are classes and no generators: an exception on the way out of a generator's context would come before the context
# is told of its end, on a busy machine more than `_AGAIN` after the first, and the next ones would never cease.


class _BySignal:
    def __init__(self, seconds: float) -> None:
        self._seconds, self._over, self._within_shorter = seconds, False, False

    def __enter__(self) -> None:
        self._begin, self._handler = time.monotonic(), signal.getsignal(signal.SIGALRM)
        self._left, _ = signal.getitimer(signal.ITIMER_REAL)
        self._within_shorter = 0.0 < self._left <= self._seconds  # the limit around this one comes first
        if not self._within_shorter:
            signal.signal(signal.SIGALRM, self._stop)
            signal.setitimer(signal.ITIMER_REAL, self._seconds, _AGAIN)

    def __exit__(self, *raised: object) -> None:
        self._over = True  # a signal that comes now does not leave the timer running
        if self._within_shorter:
            return
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, self._handler)
        if self._left:
            left = self._left - (time.monotonic() - self._begin)
            signal.setitimer(signal.ITIMER_REAL, max(left, 1e-3), _AGAIN)

    def _stop(self, number: int, frame: FrameType | None) -> None:
        if not self._over and not _runs_in(frame, _BORDERS):
            raise TimeLimit(self._seconds)


class _ByThread:
    def __init__(self, seconds: float) -> None:
        self._seconds, self._over, self._lock = seconds, threading.Event(), threading.Lock()
        self._thread = threading.get_ident()

    def __enter__(self) -> None:
        threading.Thread(target=self._watch, daemon=True).start()

    def __exit__(self, kind: type[BaseException] | None, raised: BaseException | None, _: TracebackType | None) -> None:
        with self._lock:
            self._over.set()
        if isinstance(raised, TimeLimit):
            raised.seconds = raised.seconds or self._seconds

    def _watch(self) -> None:
        wait = self._seconds
        while not self._over.wait(wait):
            with self._lock:  # nothing is raised in the thread once the context has ended
                if not self._over.is_set() and not _runs_in(sys._current_frames().get(self._thread), _BORDERS):
                    thread, raised = ctypes.c_ulong(self._thread), ctypes.py_object(TimeLimit)
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(thread, raised)
            wait = _AGAIN


_BORDERS = frozenset(
    border.__code__ for limit in (_BySignal, _ByThread) for border in (limit.__enter__, limit.__exit__)
)


def _runs_in(frame: FrameType | None, codes: frozenset[CodeType]) -> bool:
    """Whether one of these functions is being called where a thread is: an exception there would not be its body's."""
    while frame is not None:
        if frame.f_code in codes:
            return True
        frame = frame.f_back
    return False
