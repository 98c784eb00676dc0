"""Jobs in processes on this machine. A process that dies or takes too long is replaced, and its job begun again.

Processes start fresh instead of being forked: a caller may hold threads. `concurrent.futures` gives up all jobs when
one of its processes dies, and cannot end a job that hangs; hence a pipe to each process, and one job in it at a time.
"""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import wait
from typing import Any

from harness.jobs.interface import ATTEMPTS, DIED, TIME_LIMIT, A, Lost, T, lost
from harness.jobs.threads import single_threaded
from harness.worker import Worker, WorkerEnded, signals_held_back

_STARTING = 60.0  # for a new process to import what the function needs, beside the time limit of its first job [s]
_JOBS = 64  # of a process: what compiled code does not give back stays bounded (MuJoCo: some 35 kB a run)


@dataclass
class _Worker(Worker):
    """A process, and what it does."""

    index: int = -1  # of its job; -1 where it has none
    argument: Any = None
    attempt: int = 0
    deadline: float = float("inf")
    done: int = 0  # jobs

    @property
    def busy(self) -> bool:
        return self.index >= 0


class Local:
    """An `Executor` of `workers` processes on this machine."""

    def __init__(self, workers: int | None = None) -> None:
        self.workers = max(1, workers or os.cpu_count() or 1)

    def run(
        self, function: Callable[[A], T], arguments: Iterable[A], *, time_limit: float | None = None
    ) -> Iterator[tuple[int, T | Lost]]:
        """As of `Executor`."""
        coming = ((index, argument, 1) for index, argument in enumerate(arguments))
        again: deque[tuple[int, A, int]] = deque()
        workers: list[_Worker] = []
        try:
            while True:
                self._hand_out(function, workers, again, coming, time_limit)
                busy = [one for one in workers if one.busy]
                if not busy:
                    return
                for worker, result in self._ended(busy):
                    if isinstance(result, _Broken):
                        workers.remove(worker)
                        worker.end()
                        if worker.attempt < ATTEMPTS:
                            again.append((worker.index, worker.argument, worker.attempt + 1))
                            continue
                        result = lost(result.reason, time_limit)
                    index, worker.index, worker.argument = worker.index, -1, None
                    worker.done += 1
                    if worker.done == _JOBS and worker in workers:
                        workers.remove(worker)
                        worker.end()
                    yield index, result
        finally:
            with signals_held_back():
                for worker in workers:
                    worker.end()

    def _hand_out(
        self,
        function: Callable[[A], T],
        workers: list[_Worker],
        again: deque[tuple[int, A, int]],
        coming: Iterator[tuple[int, A, int]],
        time_limit: float | None,
    ) -> None:
        """Give every process without a job one, as long as there are any."""
        while sum(one.busy for one in workers) < self.workers:
            task = again.popleft() if again else next(coming, None)
            if task is None:
                return
            worker = next((one for one in workers if not one.busy), None)
            if worker is None:
                with single_threaded(), signals_held_back():
                    workers.append(worker := _Worker.begun(function))
            worker.index, worker.argument, worker.attempt = task
            if time_limit is not None:
                worker.deadline = time.monotonic() + time_limit + (0.0 if worker.done else _STARTING)
            with suppress(OSError):  # it has died, which the wait for its result tells
                worker.pipe.send(worker.argument)

    def _ended(self, busy: list[_Worker]) -> Iterator[tuple[_Worker, Any]]:
        """Jobs that have come to an end, after waiting for one."""
        left = min(one.deadline for one in busy) - time.monotonic()
        ready = wait([one.pipe for one in busy], None if left == float("inf") else max(left, 0.0))
        for worker in busy:
            if worker.pipe in ready:
                try:
                    result = worker.answer()
                except WorkerEnded:
                    result = _Broken(DIED)
                yield worker, result
            elif time.monotonic() > worker.deadline:
                yield worker, _Broken(TIME_LIMIT)


@dataclass(frozen=True)
class _Broken:
    """An attempt without a result."""

    reason: str
