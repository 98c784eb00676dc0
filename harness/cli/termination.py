"""SIGTERM as an exception, so that a command that is terminated cleans up as one that is interrupted does.

Compiled modules that are being imported turn either into an `ImportError`: what is raised after a signal is the signal.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from harness.errors import Terminated


@contextmanager
def terminable() -> Iterator[None]:
    """SIGTERM raises `Terminated` and SIGINT `KeyboardInterrupt` out of the context, whatever others make of them.

    Signals come to the main thread alone.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[type[BaseException]] = []

    def handler(number: int, frame: FrameType | None) -> None:
        came.append(Terminated if number == signal.SIGTERM else KeyboardInterrupt)
        raise came[-1]

    before = {number: signal.signal(number, handler) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        yield
    except Exception as error:
        if came:
            raise came[-1] from error
        raise
    finally:
        for number, one in before.items():
            signal.signal(number, one)
