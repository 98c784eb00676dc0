"""Results of a few long jobs, all of them or none: in the order of the jobs, whoever carries them out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from harness.errors import HarnessError
from harness.jobs.interface import Executor, Lost, T


def gathered(
    executor: Executor, jobs: Sequence[Callable[[], T]], on_done: Callable[[int], None] = lambda _: None
) -> list[T]:
    """Results of `jobs`, in their order.

    Args:
        executor: that carries them out.
        jobs: functions without arguments that can be pickled, as well as their results.
        on_done: called after each job with the number of finished jobs.

    Raises:
        HarnessError: a job had no result. Exceptions of a job are passed on.
    """
    found: dict[int, Any] = {}
    for index, result in executor.run(_called, jobs):
        if isinstance(result, Lost):
            raise HarnessError(f"a part of the work was lost: {result.message}")
        found[index] = result
        on_done(len(found))
    return [found[index] for index in range(len(jobs))]


def _called(job: Callable[[], T]) -> T:
    return job()
