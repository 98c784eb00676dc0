"""`harness sweep` as a user meets it: its files, what a kill leaves, what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from harness import Sweep, sweep
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "sweep.toml"
GRID = """cases = ["rig"]
sources = ["mujoco", "cam"]
time_step = [4e-3, 2e-3]
[mujoco]
friction = [0.5, 1e-5]
[rig]
mass_kg = [0.07, 0.071]
"""
TIMES = ["cpu_s"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short simulated case `rig` and a spec beside it."""
    made = tmp_path_factory.mktemp("sweep")
    write_short_case(made / "rig")
    (made / "sweep.toml").write_text(GRID, encoding="utf-8")
    return made


@pytest.fixture(scope="module")
def made(folder: Path) -> Sweep:
    """The sweep in this process."""
    return sweep(folder / "sweep.toml", out=folder / "here")


def same(left: Path, right: Path) -> None:
    """Rows are the same bit for bit, except their times."""
    one, other = (pd.read_parquet(path).drop(columns=TIMES) for path in (left, right))
    pd.testing.assert_frame_equal(one, other, check_exact=True)


def test_every_run_is_a_row(made: Sweep) -> None:
    """Have a row for each combination, with errors or the failure's name."""
    runs = made.runs
    assert len(runs) == 2 * 2 * 2 + 2
    assert set(runs.columns) >= {"time_step", "mujoco.friction", "rig.mass_kg", "error_cam_max_m", "failure", "message"}
    slippery = runs["mujoco.friction"] == 1e-5
    assert (runs[slippery]["failure"] == "slipped").all()
    good = runs[~slippery]
    assert good["failure"].isna().all()
    assert (good["error_measured_rms_m"] > 0.0).all()
    # 5 µm is the tolerance over 10 s at 1e-3 s (README); errors grow with the square of the step: 16 times at 4e-3.
    assert (good["error_cam_max_m"] < 16 * 5e-6).all()
    assert (good[good["source"] == "cam"]["error_cam_max_m"] == 0.0).all()


def test_the_time_of_a_run_is_that_of_its_windows(folder: Path) -> None:
    """Count the windows that restart, not what a recording has behind the last of them."""
    spec = 'cases = ["rig"]\nrecordings = ["rec_01.csv"]\nsources = ["cam"]\nwindow_s = 0.8\n'
    (folder / "windows.toml").write_text(spec, encoding="utf-8")
    (row,) = sweep(folder / "windows.toml", out=folder / "windows").runs.to_dict("records")
    assert row["motion_s"] == pytest.approx(3 * 0.8, abs=0.02)  # of 3 s


def test_results_say_what_rows_say(made: Sweep) -> None:
    """Name the failures, the combination closest to the measurement, and each step size with its errors."""
    runs, results = made.runs, made.results
    assert [(one.source, one.failure, one.runs) for one in results.failures] == [("mujoco", "slipped", 4)]
    best = results.best[0]
    mujoco = runs[(runs["source"] == "mujoco") & runs["failure"].isna()]
    assert best.error == mujoco["error_measured_rms_m"].min()
    assert best.candidates == 4
    assert best.values["mujoco.friction"] == 0.5
    steps = {one.time_step: one for one in results.work_precision if one.source == "mujoco"}
    assert set(steps) == {4e-3, 2e-3}
    assert steps[4e-3].error_cam > steps[2e-3].error_cam
    assert (steps[4e-3].runs, steps[4e-3].failed) == (4, 2)


@pytest.mark.slow
def test_several_processes_give_the_same_rows(folder: Path, made: Sweep, process: Harness) -> None:
    """Write the same by the command with two processes; print JSON; exit with 0 although some runs failed."""
    out = folder / "there"
    done = process("sweep", folder / "sweep.toml", "--out", out, "--jobs", 2, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert (told["runs"], told["failed"]) == (10, 4)
    assert told["failures"][0]["failure"] == "slipped"
    same(made.folder / "runs.parquet", out / "runs.parquet")
    assert sorted(path.name for path in out.iterdir()) == ["runs.parquet", "sweep.html", "sweep.json"]
    page = (out / "sweep.html").read_text(encoding="utf-8")
    assert "slipped" in page


def test_a_finished_sweep_is_not_repeated(folder: Path, made: Sweep, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read the rows that are there."""
    monkeypatch.setattr("harness.sweeps.carry_out.carry_out", None)
    before = (made.folder / "runs.parquet").read_bytes()
    assert sweep(folder / "sweep.toml", out=made.folder).results == made.results
    assert (made.folder / "runs.parquet").read_bytes() == before


def test_a_changed_spec_is_refused(folder: Path, made: Sweep, harness: Harness) -> None:
    """Say what has changed and what to do; leave the results alone."""
    other = folder / "other.toml"
    other.write_text(GRID.replace("[4e-3, 2e-3]", "[4e-3]"), encoding="utf-8")
    before = (made.folder / "runs.parquet").read_bytes()
    done = harness("sweep", other, "--out", made.folder)
    assert done.code == 2
    (message,) = done.errors
    assert "spec.time_step was [0.004,0.002] and is [0.004]" in message
    assert "--force" in message
    assert (made.folder / "runs.parquet").read_bytes() == before


def test_a_long_sweep_asks(folder: Path, harness: Harness) -> None:
    """Say how long it takes, end with 2, write nothing."""
    long = folder / "long.toml"
    long.write_text(
        GRID.replace("[4e-3, 2e-3]", "[1e-5]").replace("[0.5, 1e-5]", str([0.2 + 1e-3 * i for i in range(400)]))
    )
    done = harness("sweep", long, "--out", folder / "long")
    assert done.code == 2
    (message,) = done.errors
    assert "would take some" in message
    assert "--yes" in message
    assert not (folder / "long").exists()


@pytest.mark.slow
def test_the_documented_example_runs(process: Harness) -> None:
    """Run docs/examples/sweep.toml; no run fails, and PyBullet's error falls as the square of the step."""
    done = process("sweep", EXAMPLE)
    assert done.code == 0, done.err
    runs = pd.read_parquet(done.folder / "reports" / "sweep" / "runs.parquet")
    assert len(runs) == 3 * 3 + 3 + 1
    assert runs["failure"].isna().all()
    errors = runs[runs["source"] == "pybullet"].set_index("time_step")["error_cam_max_m"]
    # Second order: a factor of 4 for half the step; the remainder of third order is below a quarter of that here.
    assert 3.0 < errors[4e-3] / errors[2e-3] < 5.0
