"""A process that does one job after another: each comes through a pipe of its own, its result goes back there.

Killed at any instant, it can neither keep others waiting nor its parent: the pipe has no other end then. A process of
`concurrent.futures` shares a pipe with the others, and one that is killed while it writes there leaves its parent
reading for ever.
"""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import pickle
import signal
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from multiprocessing.resource_tracker import ensure_running
from typing import Any, Self

from harness.errors import HarnessError

_PR_SET_PDEATHSIG = 1  # <linux/prctl.h>


class WorkerEnded(Exception):
    """A process has ended without an answer."""


@dataclass
class Worker:
    """A process, and the pipe to it.

    Attributes:
        process: ends with its parent, on Linux even if that is killed; signals for the parent do not reach it.
        pipe: takes the argument of a job; `answer` says what came of it.
    """

    process: BaseProcess
    pipe: Connection

    @classmethod
    def begun(cls, function: Callable[[Any], Any], *, fork: bool = False) -> Self:
        """Begin a process that calls `function` with whatever is sent to it.

        Args:
            function: of one argument; without `fork` it has to be picklable, as arguments and results always have.
            fork: whether the process has all that its parent has; it starts fresh otherwise.

        Raises:
            HarnessError: there can be no further process.
        """
        context = multiprocessing.get_context("fork") if fork else multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(
            target=_work, args=(function, theirs, os.getpid(), ours if fork else None), daemon=True
        )
        try:
            with _signals_held_back():
                process.start()
        except OSError as error:
            raise HarnessError(f"no further process can be started ({error.strerror}); use fewer of them") from error
        finally:
            theirs.close()
        return cls(process, ours)

    def answer(self) -> Any:
        """The result of a job, once `pipe` is ready.

        Raises:
            WorkerEnded: the process has ended. An exception of the job is passed on.
        """
        try:
            result, error = self.pipe.recv()
        except (EOFError, OSError) as gone:
            raise WorkerEnded from gone
        if error is not None:
            raise error
        return result

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


@contextmanager
def _signals_held_back() -> Iterator[None]:
    """Hold signals back; a process that starts meanwhile never gets Ctrl-C, not even while it imports what it needs.

    The parent handles interrupts, and gets one that came meanwhile at the end.
    """
    if sys.platform == "win32":
        yield
        return
    ensure_running()  # which else would be started meanwhile, and lets signals through at the end of that
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(function: Callable[[Any], Any], pipe: Connection, parent: int, others_end: Connection | None) -> None:
    """In the process: do jobs until the pipe is closed.

    Args:
        function: of one argument.
        pipe: to the parent.
        parent: its number.
        others_end: the parent's end of the pipe, which a forked process has, too.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles interrupts
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # the parent's handler is none of this process
    if sys.platform != "win32":
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    if sys.platform == "linux":
        _end_with(parent)
    if others_end is not None:
        others_end.close()
    while True:
        try:
            argument = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send((function(argument), None))  # pickled as a whole before the first byte is sent
        except Exception as error:
            pipe.send((None, _picklable(error)))


def _picklable(error: Exception) -> Exception:
    """The error with its place here in a note, which a process cannot send otherwise."""
    error.add_note("".join(traceback.format_exception(error)))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return HarnessError(f"{type(error).__name__}: {error}")
    return error


def _end_with(parent: int) -> None:
    """Have the system kill this process when its parent is killed, which else leaves it waiting for work for ever."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it was killed before that
        os._exit(1)
