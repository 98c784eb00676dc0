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


@pytest.mark.slow
def test_the_search_by_held_out_errors_is_the_same_in_any_number_of_processes() -> None:
    """Write the same digits of the bundled measured rig, whose effects held-out blocks decide, with one and two.

    They predict held-out blocks surely better than every baseline.
    """
    case = ROOT / "harness" / "data" / "open_ball_beam"
    one, two = (diagnosed(case, jobs=jobs, threads=1) for jobs in (1, 2))
    assert {line["rule"] for line in one["ledger"]} >= {"joint", "exchange"}
    assert json.dumps(one) == json.dumps(two)
    margins = one["baselines"]["better_by_m"]
    assert len(margins) == 5
    assert all(margin["sure"] for margin in margins.values()), margins
