"""CPU and wall time of a process and of those it starts."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

_DONE = (0, 3)  # exit codes of a diagnosis that was written; 3 where an engine failed


@dataclass(frozen=True)
class Time:
    """Of one run [s]: of all processors together, and by the clock on the wall; and what it wrote to stderr."""

    cpu: float
    wall: float
    told: str = ""


def diagnosis_time(case: Path, out: Path) -> Time:
    """Time of `harness diagnose` on a case, whose result is written into `out`.

    Raises:
        RuntimeError: it did not come to a result.
    """
    return run([sys.executable, "-m", "harness", "diagnose", str(case), "--out", str(out), "--yes", "--force"])


def run(command: Sequence[str], environment: Mapping[str, str] | None = None) -> Time:
    """Time of a command with the processes that it starts and awaits.

    Args:
        command: the words.
        environment: variables beside those of this process.

    Raises:
        RuntimeError: it failed.
    """
    begin = time.monotonic()
    variables = os.environ | dict(environment or {})
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=variables)
    assert process.stderr is not None
    told = process.stderr.read()
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in _DONE:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}: {told[-2000:]}")
    return Time(used.ru_utime + used.ru_stime, time.monotonic() - begin, told)
