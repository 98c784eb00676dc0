"""A long sweep under SIGKILL, which no handler sees."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.acceptance.short import write_short_case

RUNS, KILLS = 4096, 20
SPEC = f"""cases = ["rig"]
sources = ["mujoco"]
design = "latin_hypercube"
size = {RUNS}
time_step = 4e-3
[mujoco]
friction = {{ low = 0.2, high = 0.5 }}
"""
# Half of the kills come before the first row, while modules are still imported, the others while rows are written: some
# seconds of them altogether, less than the sweep's minute.
AMID = 0.8  # at most, after a row of its own [s]; ten times this leaves runs to do on a fast machine
LONGEST = 120.0  # to the first row, on a busy machine [s]


def begun(folder: Path, out: str) -> subprocess.Popen[bytes]:
    """`harness sweep` on two processes, in a process group of its own."""
    command = [sys.executable, "-m", "harness", "sweep", "sweep.toml", "--out", out, "--jobs", "2"]
    return subprocess.Popen(
        command, cwd=folder, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def kill(sweep: subprocess.Popen[bytes]) -> None:
    """Kill a sweep with all of its processes."""
    os.killpg(sweep.pid, signal.SIGKILL)
    sweep.wait()


def rows(folder: Path, out: str) -> tuple[int, int]:
    """Number of a sweep's newest journal, and of the whole rows in it; a pair that grows with every row kept."""
    newest = (0, 0)
    for journal in (folder / out).glob("unfinished_runs/*.jsonl"):
        with contextlib.suppress(FileNotFoundError):  # the sweep deletes a journal that is full
            newest = max(newest, (int(journal.stem), journal.read_bytes().count(b"\n")))
    return newest


def wait_for_a_row(sweep: subprocess.Popen[bytes], folder: Path, out: str) -> float:
    """Wait until the sweep that was just begun keeps a row, or has none left and ends; how long that took [s]."""
    begin, before = time.monotonic(), rows(folder, out)
    while rows(folder, out) <= before and sweep.poll() is None:
        assert time.monotonic() < begin + LONGEST
        time.sleep(0.01)
    return time.monotonic() - begin


@pytest.mark.slow
def test_a_sweep_killed_at_random_comes_out_whole(tmp_path: Path) -> None:
    """Have each of 4096 runs once, and all as of a sweep nobody disturbed, after 20 kills at random instants."""
    write_short_case(tmp_path / "rig", duration=1.5)
    (tmp_path / "sweep.toml").write_text(SPEC, encoding="utf-8")
    generator = np.random.default_rng(2026)
    first = LONGEST
    for number in range(KILLS):
        sweep = begun(tmp_path, "killed")
        if number % 2 == 0:
            first = min(first, wait_for_a_row(sweep, tmp_path, "killed"))
        with pytest.raises(subprocess.TimeoutExpired):
            sweep.wait(timeout=generator.uniform(0.0, first if number % 2 else AMID))
        kill(sweep)

    for out in ("killed", "whole"):
        assert begun(tmp_path, out).wait(timeout=500.0) == 0
    killed, whole = (pd.read_parquet(tmp_path / out / "runs.parquet") for out in ("killed", "whole"))
    assert killed["run"].tolist() == list(range(RUNS))
    pd.testing.assert_frame_equal(killed.drop(columns="cpu_s"), whole.drop(columns="cpu_s"), check_exact=True)
    assert sorted(path.name for path in (tmp_path / "killed").iterdir()) == ["runs.parquet", "sweep.html", "sweep.json"]
