"""Jobs on a Dask cluster of two workers that is shot at: the results are those of this machine, bit for bit."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from harness.errors import InputError
from harness.jobs import Executor, Local, Lost, executor_on
from tests.jobs.functions import always_computes, always_fills, always_hangs, killed_once, raised, square

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def executor() -> Iterator[Executor]:
    """Two workers of 700 MB each, with nannies that start them anew."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, memory_limit="700MB", dashboard_address=None
    ) as cluster:
        yield executor_on(cluster.scheduler_address.replace("tcp://", "dask://"))


@pytest.mark.parametrize("kind", ["", "kill"])
def test_results_are_those_of_this_machine(executor: Executor, kind: str, tmp_path: Path) -> None:
    """Shoot at the workers once in each of two jobs; no result is missing or another."""
    folders = [tmp_path / "dask", tmp_path / "local"]
    for folder in folders:
        folder.mkdir()
    tasks = [(0.1 * value, kind if value in (2, 7) else "", str(folders[0])) for value in range(12)]
    made = dict(executor.run(killed_once, tasks, time_limit=120.0))
    plain = [(value, "", str(folders[1])) for value, _, _ in tasks]
    assert made == dict(Local(2).run(killed_once, plain))
    assert len(list(folders[0].iterdir())) == (2 if kind else 0)  # the shots were fired


@pytest.mark.parametrize("job", [always_hangs, always_computes])
def test_a_job_that_hangs_is_lost_by_name(executor: Executor, job: Callable[[int], int]) -> None:
    """End it, whether it waits or computes; the others have their results."""
    results = dict(executor.run(job, range(4), time_limit=5.0))
    lost = results.pop(1)
    assert isinstance(lost, Lost)
    assert lost.reason == "time_limit"
    assert results == {0: 0, 2: 2, 3: 3}


def test_a_job_that_runs_out_of_memory_is_lost_by_name(executor: Executor) -> None:
    """Have its worker ended by its nanny; the others have their results."""
    results = dict(executor.run(always_fills, range(4), time_limit=120.0))
    lost = results.pop(1)
    assert isinstance(lost, Lost)
    assert lost.reason == "process_died"
    assert results == {0: 0, 2: 2, 3: 3}


def test_an_error_of_a_job_is_passed_on(executor: Executor) -> None:
    """Raise what the job raised, and go on with other jobs then."""
    with pytest.raises(ValueError, match="no 4"):
        list(executor.run(raised, [4]))
    assert dict(executor.run(square, [2.0])) == {0: 4.0 / 3.0}


def test_an_address_where_nobody_answers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Say how a scheduler and workers are started."""
    monkeypatch.setattr("harness.jobs.cluster._CONNECT", 1.0)
    with pytest.raises(InputError, match="dask scheduler"):
        executor_on("dask://127.0.0.1:9")
