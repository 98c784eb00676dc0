"""Jobs on a Dask cluster of two workers that is shot at: the results are those of this machine, bit for bit."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from harness.engines.catalogue import engine_of
from harness.errors import HarnessError, InputError
from harness.identify.pose import problem_of
from harness.jobs import Executor, Local, Lost, executor_on
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from harness.tuning.tune import tune
from tests.jobs.functions import always_computes, always_fills, always_hangs, killed_once, raised, square

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.slow


@contextmanager
def _started(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """A command of Dask as users start it, ended with all that it has started."""
    process = subprocess.Popen([sys.executable, "-m", *arguments], start_new_session=True)
    try:
        yield process
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@contextmanager
def _cluster(folder: Path) -> Iterator[tuple[Executor, subprocess.Popen[bytes]]]:
    """A scheduler and two workers of 700 MB each, with nannies that start them anew; the nannies' process.

    Processes of their own, and killed in the end: a `LocalCluster` that is closed while one of its workers starts
    waits for ever.
    """
    file = folder / "scheduler.json"
    common = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(file)]
    with _started("distributed.cli.dask_scheduler", "--port", "0", *common):
        _wait(file.exists)
        workers = ["--nworkers", "2", "--nthreads", "1", "--memory-limit", "700MB", "--local-directory", str(folder)]
        with (
            _started("distributed.cli.dask_worker", *workers, *common) as nannies,
            distributed.Client(scheduler_file=str(file), set_as_default=False) as client,
        ):
            client.wait_for_workers(2, timeout=60)
            yield executor_on(client.scheduler.address.replace("tcp://", "dask://")), nannies


def _wait(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.1)


@pytest.fixture(scope="module")
def executor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Executor]:
    """Jobs on two workers."""
    with _cluster(tmp_path_factory.mktemp("dask")) as (found, _):
        yield found


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


def test_a_cluster_without_workers_ends_the_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Say after a while that nobody works there, and how to go on, instead of waiting for ever."""
    monkeypatch.setattr("harness.jobs.cluster._DESERTED", 1.0)
    with _cluster(tmp_path) as (executor, nannies):
        results = executor.run(always_hangs, range(4))
        next(results)
        os.killpg(nannies.pid, signal.SIGKILL)
        with pytest.raises(HarnessError, match="no workers for 1 s; start some"):
            list(results)


def test_a_tuning_is_that_of_this_machine(executor: Executor, tmp_path: Path) -> None:
    """Hand the fits of candidates and held-out blocks to the workers; every number is the same, bit for bit."""
    hidden = {"contact_slip": {"friction_coefficient": 0.0085}}
    experiment = Experiment(hidden=hidden, duration=9.0, rate=25.0, counts=4096, predict=0, seed=501)
    write_case(tmp_path / "case", experiment)
    problem, settings = problem_of(load_case(tmp_path / "case")), {"time_step": 3e-3}
    # Its processes have one thread for linear algebra, as commands and workers have: more of them round otherwise,
    # and a fit of a ball that slides now and then is sensitive to the last digit.
    here = tune(problem, engine_of("mujoco"), settings, ["friction"], executor=Local(2))
    there = tune(problem, engine_of("mujoco"), settings, ["friction"], executor=executor)
    assert here.selection.pays == ("friction",)
    assert there.settings == here.settings
    assert there.selection.attempts == here.selection.attempts
    assert np.array_equal(there.selection.found.covariance, here.selection.found.covariance)
    assert here.held_out is not None
    assert there.held_out is not None
    assert np.array_equal(there.held_out.after, here.held_out.after)
