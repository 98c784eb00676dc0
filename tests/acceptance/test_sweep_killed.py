"""A long sweep under SIGKILL, which no handler sees."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
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
# From before the first row, while modules are still imported, to some seconds of runs; all twenty are less than the
# sweep's minute.
DELAYS = (0.2, 4.5)  # [s]


def begun(folder: Path, out: str) -> subprocess.Popen[bytes]:
    """`harness sweep` on two processes, in a process group of its own."""
    command = [sys.executable, "-m", "harness", "sweep", "sweep.toml", "--out", out, "--jobs", "2"]
    return subprocess.Popen(
        command, cwd=folder, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


@pytest.mark.slow
def test_a_sweep_killed_at_random_comes_out_whole(tmp_path: Path) -> None:
    """Have each of 4096 runs once, and all as of a sweep nobody disturbed, after 20 kills at random instants."""
    write_short_case(tmp_path / "rig", duration=1.5)
    (tmp_path / "sweep.toml").write_text(SPEC, encoding="utf-8")
    generator = np.random.default_rng(2026)
    amid = 0
    for _ in range(KILLS):
        sweep = begun(tmp_path, "killed")
        with pytest.raises(subprocess.TimeoutExpired):
            sweep.wait(timeout=generator.uniform(*DELAYS))
        os.killpg(sweep.pid, signal.SIGKILL)
        sweep.wait()
        amid += any((tmp_path / "killed").glob("unfinished_runs/*"))
    assert amid >= KILLS // 2  # most kills came when there was something to lose

    for out in ("killed", "whole"):
        assert begun(tmp_path, out).wait(timeout=500.0) == 0
    killed, whole = (pd.read_parquet(tmp_path / out / "runs.parquet") for out in ("killed", "whole"))
    assert killed["run"].tolist() == list(range(RUNS))
    pd.testing.assert_frame_equal(killed.drop(columns="cpu_s"), whole.drop(columns="cpu_s"), check_exact=True)
    assert sorted(path.name for path in (tmp_path / "killed").iterdir()) == ["runs.parquet", "sweep.html", "sweep.json"]
