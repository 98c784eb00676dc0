"""What rows say where runs of some recordings fail."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from harness import Sweep, sweep
from harness.sweeps.results import results_of
from tests.sweeps.made import spec_file

SPEC = """recordings = ["rec_01.csv", "rec_02.csv"]
sources = ["mujoco", "cam"]
[mujoco]
time_step = [4e-3, 2e-3]
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    """A sweep of two recordings, of which no run fails."""
    folder = tmp_path_factory.mktemp("sweep")
    return sweep(spec_file(folder, SPEC), out=folder / "out")


def with_failures(made: Sweep, failing: pd.Series, file: Path) -> Sweep:
    """The same sweep, in which these runs failed."""
    rows = made.runs
    rows.loc[failing, ["error_measured_rms_m", "error_cam_max_m"]] = float("nan")
    rows.loc[failing, ["failure", "message"]] = "slipped", "the contact slips"
    rows.to_parquet(file)
    return Sweep(file.parent, results_of(made.plan, file), made.plan)


def test_a_recording_on_which_every_run_fails_costs_only_itself(made: Sweep, tmp_path: Path) -> None:
    """Judge combinations on the other recordings, say on how many, and call no source failed."""
    runs = made.runs
    bad = (runs["source"] == "mujoco") & (runs["recording"] == "rec_01.csv")
    left = with_failures(made, bad, tmp_path / "runs.parquet")
    mujoco, cam = left.results.best
    assert (mujoco.recordings, mujoco.candidates, cam.recordings) == (1, 2, 2)
    good = runs[(runs["source"] == "mujoco") & ~bad]
    assert mujoco.error == pytest.approx(good["error_measured_rms_m"].min(), rel=1e-12)
    assert not bad[runs["run"] == mujoco.run].any()
    assert left.failed_sources == ()


def test_a_combination_that_fails_on_one_recording_is_no_candidate(made: Sweep, tmp_path: Path) -> None:
    """Leave out what ran on the easier recordings only."""
    runs = made.runs
    bad = (runs["source"] == "mujoco") & (runs["recording"] == "rec_02.csv") & (runs["time_step"] == 2e-3)
    best = with_failures(made, bad, tmp_path / "runs.parquet").results.best[0]
    assert (best.recordings, best.candidates, best.values["time_step"]) == (2, 1, 4e-3)


def test_a_source_of_which_every_run_fails_is_named(made: Sweep, tmp_path: Path) -> None:
    """Tell it from one that ran somewhere."""
    left = with_failures(made, made.runs["source"] == "mujoco", tmp_path / "runs.parquet")
    assert left.failed_sources == ("mujoco",)
    assert [one.source for one in left.results.best] == ["cam"]
