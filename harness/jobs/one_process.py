"""Jobs one after another in this process, for calls from scripts and notebooks that ask for no more."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import nullcontext

from harness.jobs.interface import TIME_LIMIT, A, Lost, T, lost
from harness.time_limit import TimeLimit
from harness.time_limit import time_limit as limited


class OneProcess:
    """An `Executor` without processes of its own; a single call of compiled code is not ended by a time limit."""

    workers = 1

    def run(
        self, function: Callable[[A], T], arguments: Iterable[A], *, time_limit: float | None = None
    ) -> Iterator[tuple[int, T | Lost]]:
        """As of `Executor`."""
        for index, argument in enumerate(arguments):
            result: T | Lost
            try:
                with nullcontext() if time_limit is None else limited(time_limit):
                    result = function(argument)
            except TimeLimit:
                result = lost(TIME_LIMIT, time_limit)
            yield index, result
