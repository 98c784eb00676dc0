"""Jobs on the workers of a Dask cluster (extra `dask`).

A worker that dies is Dask's own affair: the scheduler gives its jobs to others, its nanny starts it anew. A job over
its time limit is ended by an exception. Where it hangs in a call that no exception ends, the worker says so and ends
itself; where that call even holds Python's global lock, it ends without a word, and Dask tries some more workers.
"""

from __future__ import annotations

import faulthandler
import os
import threading
import time
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

from distributed import Client, Future, as_completed
from distributed.client import FutureCancelledError
from distributed.comm.core import CommClosedError
from distributed.scheduler import KilledWorker

from harness.errors import HarnessError, InputError
from harness.jobs.interface import ATTEMPTS, DIED, TIME_LIMIT, A, Lost, T, lost
from harness.provenance import versions
from harness.time_limit import TimeLimit
from harness.time_limit import time_limit as limited

_CONNECT = 15.0  # [s]
_DESERTED = 60.0  # without any worker, after which a run ends; a nanny starts a worker anew within seconds [s]
_POLL = 0.05  # [s]
_GRACE = 2.0  # from the exception to the end of the process [s]
_ALONE = threading.Lock()  # engines have state of the process: one job at a time, however many threads a worker has


class Dask:
    """An `Executor` of the workers of a Dask cluster."""

    def __init__(self, address: str) -> None:
        """Connect to the scheduler at `address`, as in `tcp://host:8786`.

        Raises:
            InputError: nobody answers there, it has no workers, or a worker has another version of this product.
        """
        self.address = address
        try:
            self._client = Client(address, timeout=_CONNECT, set_as_default=False)
        except OSError as error:
            raise InputError(
                f"{address}: no Dask scheduler answers; start one with `dask scheduler`, and workers with "
                f"`dask worker {address} --nworkers 2 --nthreads 1`"
            ) from error
        self._check()

    def _check(self) -> None:
        if not self.workers:
            raise InputError(
                f"{self.address}: has no workers; start some with `dask worker {self.address} --nthreads 1`"
            )
        try:
            theirs: dict[str, dict[str, str]] = self._client.run(_versions)
        except Exception as error:  # whatever its import raises there
            raise InputError(
                f"{self.address}: its workers cannot import this product ({type(error).__name__}: {error}); "
                "install it there"
            ) from error
        ours = _versions()
        for worker, found in theirs.items():
            differing = [
                f"{name} {found.get(name)}, here {ours[name]}" for name in ours if found.get(name) != ours[name]
            ]
            if differing:
                raise InputError(f"{worker}: has other versions ({'; '.join(differing)}); install the same ones there")

    @property
    def workers(self) -> int:
        """How many there are now."""
        return len(self._client.scheduler_info(n_workers=-1)["workers"])

    def run(
        self, function: Callable[[A], T], arguments: Iterable[A], *, time_limit: float | None = None
    ) -> Iterator[tuple[int, T | Lost]]:
        """As of `Executor`."""
        coming = enumerate(arguments)
        pending: dict[str, _Job] = {}
        done = as_completed(loop=self._client.loop)
        try:
            while True:
                # As many as there are workers, and some more that wait there, so that none of them waits for us.
                while len(pending) < max(2, 2 * self.workers):
                    task = next(coming, None)
                    if task is None:
                        break
                    self._submit(function, _Job(*task), time_limit, pending, done)
                if not pending:
                    return
                future = self._next(done)
                job = pending.pop(str(future.key))
                result = self._result(future, job, time_limit)
                if result is _AGAIN:
                    self._submit(function, job, time_limit, pending, done)
                    continue
                yield job.index, result
        finally:
            self._client.cancel([job.future for job in pending.values()], force=True)

    def _next(self, done: as_completed) -> Future:
        """The next job that ends; see `_Watch`."""
        watch = _Watch(self)
        while not done.has_ready():
            time.sleep(_POLL)
            watch.look()
        return next(done)

    def _fetched(self, future: Future) -> Any:
        """The result of a job that has ended. It lies on a worker: where that is lost, Dask does the job anew."""
        watch = _Watch(self)
        while True:
            try:
                return future.result(timeout=min(_DESERTED, 15.0))
            except TimeoutError:
                watch.look()

    def _submit(
        self,
        function: Callable[[A], T],
        job: _Job,
        time_limit: float | None,
        pending: dict[str, _Job],
        done: as_completed,
    ) -> None:
        job.attempt += 1
        job.begin = time.monotonic()
        key = f"harness-{uuid.uuid4().hex}"
        job.future = self._client.submit(_work, function, job.argument, time_limit, key=key, pure=False)
        pending[key] = job
        done.add(job.future)

    def _result(self, future: Future, job: _Job, time_limit: float | None) -> Any:
        """What came of a job; `_AGAIN` if it is to be begun again."""
        try:
            result = self._fetched(future)
            if isinstance(result, _Raised):
                raise result.error
            if not isinstance(result, Lost):
                return result
            reason = result.reason
        except KilledWorker as error:  # Dask has tried it on so many workers that we do not
            # Where every worker that died of it had worked on it for the whole limit, the job hung.
            longest = (error.allowed_failures + 1) * (time_limit or float("inf"))
            return lost(TIME_LIMIT if time.monotonic() - job.begin > longest else DIED, time_limit)
        except (FutureCancelledError, CommClosedError) as error:
            raise HarnessError(
                f"{self.address}: the connection was lost; the same command goes on when the scheduler is there again"
            ) from error
        return _AGAIN if job.attempt < ATTEMPTS else lost(reason, time_limit)


class _Watch:
    """Ends a wait for a cluster without workers, where Dask itself would wait for ever."""

    def __init__(self, cluster: Dask) -> None:
        self._cluster = cluster
        self._peopled = self._looked = time.monotonic()

    def look(self) -> None:
        """Look whether there are workers, unless that was done a moment ago.

        Raises:
            HarnessError: there has been none for a minute.
        """
        now = time.monotonic()
        if now - self._looked < 0.25 * min(_DESERTED, 20.0):
            return
        self._looked = now
        if self._cluster.workers:
            self._peopled = now
        elif now - self._peopled > _DESERTED:
            address = self._cluster.address
            raise HarnessError(
                f"{address}: has had no workers for {_DESERTED:.0f} s; start some with "
                f"`dask worker {address} --nthreads 1`, and the same command goes on"
            )


@cache
def _versions() -> dict[str, str]:
    """Versions in this process; to read all modules takes a second."""
    return versions()


@dataclass
class _Job:
    """A job that is under way."""

    index: int
    argument: Any
    attempt: int = 0
    begin: float = 0.0
    future: Future | None = None


_AGAIN = object()


@dataclass(frozen=True)
class _Raised:
    """What the job's function raised, told from what Dask itself raises."""

    error: Exception


def _work(function: Callable[[A], T], argument: A, time_limit: float | None) -> T | Lost | _Raised:
    """On a worker: one job."""
    with _ALONE:
        if time_limit is None:
            return _result(function, argument)
        made: list[T | _Raised] = []
        job = threading.Thread(target=_within, args=(made, function, argument, time_limit), daemon=True)
        # A thread in C, which also ends a process whose compiled code holds Python's global lock.
        with open(os.devnull, "w") as nowhere:
            faulthandler.dump_traceback_later(time_limit + 3.0 * _GRACE, exit=True, file=nowhere)
            try:
                job.start()
                job.join(time_limit + _GRACE)
            finally:
                faulthandler.cancel_dump_traceback_later()
    if job.is_alive():  # what it left of the process is of no use; the answer has left when that ends
        threading.Timer(_GRACE, os._exit, (1,)).start()
    return made[0] if made else lost(TIME_LIMIT, time_limit)


def _within(made: list[T | _Raised], function: Callable[[A], T], argument: A, time_limit: float) -> None:
    """Append the result of a job that ends in time."""
    with suppress(TimeLimit), limited(time_limit):
        made.append(_result(function, argument))


def _result(function: Callable[[A], T], argument: A) -> T | _Raised:
    try:
        return function(argument)
    except Exception as error:
        return _Raised(error)
