"""MAT-files are read in a process of its own, which a crash cannot take down with the program.

A number type that does not exist, as in a damaged file, makes SciPy and mat-io follow a null pointer, and what a
damaged file makes the HDF5 library do is as little in our hands. The process is kept for further files, as to start it
takes half a second.
"""

from __future__ import annotations

import atexit
import os
import pickle
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

from harness.errors import InputError
from harness.importing.matlab import read_matlab
from harness.importing.signals import SourceFile

LONGEST = 600.0  # for one file [s]: a damaged one may announce any number of values
_SERVE = f"from {__name__} import serve; serve()"
_HOME = Path(__file__).parents[2]
_one_at_a_time = threading.Lock()
_started: tuple[int, subprocess.Popen[bytes]] | None = None  # by which process, as a forked one may not use it


def read_apart(path: Path) -> SourceFile:
    """What `read_matlab` returns or raises.

    Raises:
        InputError: also if reading crashes or does not end.
    """
    folder = os.getcwd()
    with _one_at_a_time:
        process = _process()
        assert process.stdin is not None
        assert process.stdout is not None
        alarm = threading.Timer(LONGEST, process.kill)
        alarm.start()
        try:
            pickle.dump((folder, path), process.stdin)  # messages name the path as it was given
            process.stdin.flush()
            outcome = pickle.load(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            _end()
            raise InputError(
                f"{path}: cannot be read as a MAT-file (its reader crashed, or took more than {LONGEST:g} s). Save it "
                "again from MATLAB."
            ) from None
        except BaseException:  # an interrupt, which leaves the process in the midst of a file
            _end()
            raise
        finally:
            alarm.cancel()
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def _process() -> subprocess.Popen[bytes]:
    global _started
    if _started is None or _started[0] != os.getpid() or _started[1].poll() is not None:
        path = os.pathsep.join(filter(None, (str(_HOME), os.environ.get("PYTHONPATH", ""))))
        command = [sys.executable, "-c", _SERVE]
        environment = os.environ | {"PYTHONPATH": path}
        _started = (
            os.getpid(),
            subprocess.Popen(
                command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment
            ),
        )
    return _started[1]


@atexit.register
def _end() -> None:
    global _started
    if _started is not None and _started[0] == os.getpid():
        # Its pipes are closed and its end awaited; what was not yet sent is lost with it.
        with suppress(OSError), _started[1] as process:
            process.kill()
    _started = None


def serve() -> None:
    """Read the files whose folders and paths come on standard input until it is closed, and write what they hold."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of the terminal, which the other process handles
    outcomes = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints is no outcome
    while True:
        try:
            folder, path = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        outcome: SourceFile | Exception
        try:
            os.chdir(folder)
            outcome = read_matlab(path)
        except Exception as error:  # raised again where it can be told
            outcome = error
        pickle.dump(outcome, outcomes)
        outcomes.flush()
