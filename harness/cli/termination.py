"""SIGTERM as an exception, so that a command that is terminated cleans up as one that is interrupted does.

Compiled modules that are being imported turn either into an `ImportError`: what is raised after a signal is the signal.
Python can pass nothing on that is raised in a callback of compiled code or in the finaliser of an object, and goes on:
the signal is then sent again.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

from harness.errors import INTERRUPTS, Terminated

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

_AGAIN = 0.02  # after which a signal that came to nothing is sent again [s]


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

    hook, again = sys.unraisablehook, list[threading.Timer]()

    def lost(args: UnraisableHookArgs) -> None:
        if not issubclass(args.exc_type, INTERRUPTS):
            hook(args)
            return
        number = signal.SIGTERM if issubclass(args.exc_type, Terminated) else signal.SIGINT
        again.append(threading.Timer(_AGAIN, os.kill, (os.getpid(), number)))
        again[-1].daemon = True
        again[-1].start()

    before = {number: signal.signal(number, handler) for number in (signal.SIGTERM, signal.SIGINT)}
    sys.unraisablehook = lost
    try:
        yield
    except Exception as error:
        if came:
            raise came[-1] from error
        raise
    finally:
        for timer in again:  # the command has come to its end
            timer.cancel()
        sys.unraisablehook = hook
        for number, one in before.items():
            signal.signal(number, one)
