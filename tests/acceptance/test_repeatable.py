"""A diagnosis is the same, bit for bit, however many processes and threads compute it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from harness.simulator import Experiment, write_case

ROOT = Path(__file__).parents[2]
SCRIPT = "import sys, harness; print(harness.diagnose(sys.argv[1], jobs=int(sys.argv[2])).record.text())"


def diagnosed(case: Path, *, jobs: int, threads: int) -> dict[str, Any]:
    """diagnosis.json of a new process, without the time that it took and the seal, which covers it."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": str(threads)}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(case), str(jobs)],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    content: dict[str, Any] = json.loads(done.stdout)
    assert content.pop("wall_time_s") > 0.0
    assert len(content.pop("sealed")) == 64
    return content


@pytest.mark.slow
@pytest.mark.parametrize("hidden", [{}, {"level_error": {"angle": 0.004}}], ids=["nothing", "level_error"])
def test_the_result_is_the_same_for_any_number_of_processes_and_threads(
    hidden: dict[str, dict[str, float]], tmp_path: Path
) -> None:
    """Write the same digits with one process and two, and with one thread of the linear algebra and two."""
    declared = {"rolling_resistance": {"coefficient": 0.002}}
    write_case(
        tmp_path / "case", Experiment(declared=declared, hidden=hidden, duration=8.0, identify=1, predict=0, seed=3)
    )
    first, *others = [
        diagnosed(tmp_path / "case", jobs=jobs, threads=threads) for jobs, threads in ((1, 1), (2, 1), (1, 2))
    ]
    assert first["verdict"] == ("effect" if hidden else "none")
    assert [json.dumps(one) for one in others] == [json.dumps(first)] * 2
