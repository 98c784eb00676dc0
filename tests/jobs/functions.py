"""Jobs that misbehave at their first attempt: a file says that there was one."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path


def square(value: float) -> float:
    """A job."""
    return value * value / 3.0


def raised(value: int) -> int:
    """A job with an error of its own."""
    raise ValueError(f"no {value}")


def _first(marker: Path) -> bool:
    try:
        marker.touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


def killed_once(task: tuple[float, str, str]) -> float:
    """A number, `kill` or nothing, a folder; the kill happens once."""
    value, kind, folder = task
    if kind and _first(Path(folder) / f"{kind}_{value}"):
        os.kill(os.getpid(), 9)
    time.sleep(0.02)
    return square(value)


def always_hangs(value: int) -> int:
    """Never ends where the number is 1."""
    if value == 1:
        time.sleep(3600.0)
    return value


def always_dies(value: int) -> int:
    """Ends its process where the number is 1."""
    if value == 1:
        os._exit(7)
    return value


def always_computes(value: int) -> int:
    """Computes in Python for ever where the number is 1."""
    while value == 1:
        pass
    return value


def always_fills(value: int) -> int:
    """Takes 50 MB every 50 ms, up to 3 GB, where the number is 1."""
    held = []
    while value == 1 and len(held) < 60:
        held.append(bytearray(os.urandom(1024)) * (50 * 1024))
        time.sleep(0.05)
    return value


def blocked_signals(_: float) -> list[int]:
    """Numbers of the signals that do not reach this process."""
    return sorted(signal.pthread_sigmask(signal.SIG_BLOCK, []))
