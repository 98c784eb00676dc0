"""What every executor does: it calls one function with many arguments and yields each result as it comes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Protocol, TypeVar

A = TypeVar("A")
T = TypeVar("T")

ATTEMPTS = 2
"""How often a job is begun at most: a worker may die of what another job did."""
TIME_LIMIT, DIED = "time_limit", "process_died"


@dataclass(frozen=True)
class Lost:
    """In place of a result: the job had none in `ATTEMPTS` attempts.

    Attributes:
        reason: `time_limit`, or `process_died` (killed, crashed, out of memory).
        message: what happened, in words.
    """

    reason: str
    message: str


class Executor(Protocol):
    """Runs jobs. A job must not depend on which process runs it, nor on what ran there before."""

    @property
    def workers(self) -> int:
        """How many jobs run side by side."""
        ...

    def run(
        self, function: Callable[[A], T], arguments: Iterable[A], *, time_limit: float | None = None
    ) -> Iterator[tuple[int, T | Lost]]:
        """Call `function` with each of `arguments`.

        `arguments` are taken as workers become free, so that they may come from a generator and need no memory. What is
        under way is given up when the iterator is closed.

        Args:
            function: of one argument; a function of a module, which can be pickled, as well as arguments and results.
            arguments: one a job.
            time_limit: for one job [s]; `None` for none.

        Yields:
            The number of a job, counted from 0, and its result, in the order in which jobs end.

        Raises:
            HarnessError: no job can be run (any more). An exception of a job is passed on.
        """
        ...


def lost(reason: str, time_limit: float | None) -> Lost:
    """A lost job, in words."""
    if reason == TIME_LIMIT:
        return Lost(reason, f"it took more than {time_limit:g} s")
    return Lost(reason, "its process ended during the work, as it does where memory is short")
