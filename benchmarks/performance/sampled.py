"""`python -m benchmarks.performance.sampled CASE OUT`: a diagnosis, and which functions take its processor time.

A profiler would slow down what is written in Python and not what is compiled, and the one of the standard library sees
a single thread. So every few milliseconds the processor time that each thread took since is counted for the function
that it is in; of forked processes, which run the engines and draw pictures, it is known as a whole. On Linux only.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from contextlib import suppress
from types import FrameType

_EVERY = 0.005  # [s]
_LISTED = 8


def sampled(function: Callable[[], object]) -> dict[str, float]:
    """Processor time that threads took in each function, innermost ones, while this one ran [s]."""
    taken: dict[str, float] = defaultdict(float)
    last: dict[int, float] = {}
    done = threading.Event()

    def look() -> None:
        while not done.wait(_EVERY):
            for thread, frame in sys._current_frames().items():
                with suppress(OSError):  # it has ended since
                    now = time.clock_gettime(time.pthread_getcpuclockid(thread))
                    taken[_name(frame)] += now - last.get(thread, now)
                    last[thread] = now
            last.pop(threading.get_ident(), None)  # its own time is none of the function's

    looking = threading.Thread(target=look, daemon=True)
    looking.start()
    try:
        function()
    finally:
        done.set()
        looking.join()
    return taken


def _name(frame: FrameType) -> str:
    """`ekf.extended_kalman_filter`; imports, of which there are hundreds of modules, are one."""
    if frame.f_code.co_filename.startswith("<frozen importlib"):
        return "imports"
    return f"{frame.f_globals.get('__name__', '').rsplit('.', 1)[-1]}.{frame.f_code.co_name}"


def shares(taken: Mapping[str, float], own: float, others: float) -> str:
    """Largest shares in the processor time of all processes, in words.

    Args:
        taken: in each function of the process itself [s].
        own, others: processor time of it, and of the processes that it forked [s].
    """
    total = own + others
    largest = sorted(taken.items(), key=lambda one: -one[1])[:_LISTED]
    told = [f"{100.0 * others / total:.0f} % in processes of engines and pictures"]
    told += [f"{100.0 * seconds / total:.0f} % in `{name}`" for name, seconds in largest]
    return ", ".join(told)


def main() -> None:
    """Diagnose, and print the shares as the last line of stdout."""
    case, out = sys.argv[1:]

    def diagnose() -> None:
        from harness.cli.main import main as command

        with suppress(SystemExit):
            command(["diagnose", case, "--out", out, "--yes", "--force", "--quiet"], standalone_mode=False)

    taken = sampled(diagnose)
    used = os.times()
    print(json.dumps(shares(taken, used.user + used.system, used.children_user + used.children_system)))


if __name__ == "__main__":
    main()
