"""`python -m benchmarks.performance.sampled CASE OUT`: a diagnosis, and which functions take its processor time.

A profiler would slow down what is written in Python and not what is compiled, and the one of the standard library sees
a single thread. So the functions that threads are in are looked at every few milliseconds; of forked processes, which
run the engines and draw pictures, the processor time is known as a whole.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from types import FrameType

_EVERY = 0.005  # [s]
_LISTED = 8
# Where a thread waits for others, for a pipe or for work, and takes no processor time.
_WAITING = ("threading.py", "selectors.py", "queue.py", "concurrent/futures/thread.py", "multiprocessing/connection.py")


def sampled(function: Callable[[], object]) -> Counter[str]:
    """How often each function was the innermost one of a thread that worked, while this one ran."""
    counts: Counter[str] = Counter()
    done = threading.Event()

    def look() -> None:
        while not done.wait(_EVERY):
            for thread, frame in sys._current_frames().items():
                if thread != threading.get_ident() and not _waits(frame):
                    counts[_name(frame)] += 1

    looking = threading.Thread(target=look, daemon=True)
    looking.start()
    try:
        function()
    finally:
        done.set()
        looking.join()
    return counts


def _waits(frame: FrameType) -> bool:
    return frame.f_code.co_filename.replace(os.sep, "/").endswith(_WAITING)


def _name(frame: FrameType) -> str:
    """`ekf.extended_kalman_filter`; imports, of which there are hundreds of modules, are one."""
    if frame.f_code.co_filename.startswith("<frozen importlib"):
        return "imports"
    return f"{frame.f_globals.get('__name__', '').rsplit('.', 1)[-1]}.{frame.f_code.co_name}"


def shares(counts: Counter[str], own: float, others: float) -> str:
    """Largest shares in the processor time of all processes, in words.

    Args:
        counts: of the process itself.
        own, others: processor time of it, and of the processes that it forked [s].
    """
    total, samples = own + others, max(sum(counts.values()), 1)
    told = [f"{100.0 * others / total:.0f} % in processes of engines and pictures"]
    told += [
        f"{100.0 * own / total * count / samples:.0f} % in `{name}`" for name, count in counts.most_common(_LISTED)
    ]
    return ", ".join(told)


def main() -> None:
    """Diagnose, and print the shares as the last line of stdout."""
    case, out = sys.argv[1:]

    def diagnose() -> None:
        from harness.cli.main import main as command

        with suppress(SystemExit):
            command(["diagnose", case, "--out", out, "--yes", "--force", "--quiet"], standalone_mode=False)

    counts = sampled(diagnose)
    used = os.times()
    print(json.dumps(shares(counts, used.user + used.system, used.children_user + used.children_system)))


if __name__ == "__main__":
    main()
