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
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
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
        process: a daemon, so that it starts none with `multiprocessing` itself. Ctrl-C does not end it; on Linux the
            system kills it as soon as the thread ends in which it was begun.
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
            with signals_held_back():
                if not fork:
                    ensure_running()  # would be started meanwhile, and lets signals through at the end of that
                process.start()
        except OSError as error:
            raise HarnessError(f"no further process can be started ({error.strerror}); use fewer of them") from error
        finally:
            theirs.close()
        return cls(process, ours)

    def answer(self) -> Any:
        """The result of a job, once `pipe` is ready.

        Raises:
            WorkerEnded: the process has ended. An exception of the job is passed on, with its place in the process in a
                note; as a `HarnessError` if no pickle carries it.
        """
        try:
            answer = self.pipe.recv_bytes()
        except (EOFError, OSError) as gone:
            raise WorkerEnded from gone
        result, error, place = pickle.loads(answer)
        if error is not None:
            error.add_note(place)
            raise error
        return result

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.join()
        self.pipe.close()


@contextmanager
def signals_held_back() -> Iterator[None]:
    """Hold SIGINT and SIGTERM back; what came meanwhile comes at the end. Processes begun meanwhile block both.

    Nothing on Windows. A mask holds them back from its own thread only, and the system then gives them to another one,
    for which Python would call the handler in the main thread all the same; there a handler notes them instead.
    """
    if sys.platform == "win32":
        yield
        return
    came: list[int] = []
    both = (signal.SIGINT, signal.SIGTERM)
    with ExitStack() as at_end:  # backwards; each is entered before what it undoes, as a signal may come between
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, ())
        at_end.callback(signal.pthread_sigmask, signal.SIG_SETMASK, mask)
        signal.pthread_sigmask(signal.SIG_BLOCK, both)
        if threading.current_thread() is threading.main_thread():
            at_end.callback(_raise_all, came)
            for number in both:
                if (handler := signal.getsignal(number)) is not None:
                    at_end.callback(signal.signal, number, handler)
                    signal.signal(number, lambda received, _: came.append(received))
        at_end.callback(signal.pthread_sigmask, signal.SIG_SETMASK, mask)  # while what comes is noted
        yield


def _raise_all(numbers: list[int]) -> None:
    for number in numbers:
        signal.raise_signal(number)


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
            argument = pipe.recv_bytes()
        except EOFError:
            return
        try:
            answer = pickle.dumps((function(pickle.loads(argument)), None, ""))
        except BaseException as error:  # an exit, too, is the parent's to make
            answer = _as_answer(error)
        with suppress(AttributeError, OSError, ValueError):  # there is none, or nobody reads it any more
            sys.stdout.flush()  # the process may be killed from here on
        pipe.send_bytes(answer)


def _as_answer(error: BaseException) -> bytes:
    """The error, and its place here, which the parent could not tell."""
    place = "".join(traceback.format_exception(error))
    try:
        answer = pickle.dumps((None, error, place))
        pickle.loads(answer)
    except Exception:
        return pickle.dumps((None, HarnessError(f"{type(error).__name__}: {error}"), place))
    return answer


def _end_with(parent: int) -> None:
    """Have the system kill this process when its parent is killed, which else leaves it waiting for work for ever."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it was killed before that
        os._exit(1)
