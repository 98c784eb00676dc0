"""How recordings of a measured rig are parted, and the line of the table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.measured_bands import Window, line, parted, windows
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.recording import load_case
from harness.recording.case import MEASURED
from harness.simulator import Experiment, write_case


def test_a_rig_is_told_by_means_over_its_windows() -> None:
    """Give the mean share of readings, and roots of mean squares."""
    made = [Window(1.0, 9e-6, 1e-6), Window(0.5, 16e-6, 49e-6)]
    assert line("rig", "first third", "nothing", made).endswith(
        "| 2 | 75% (50%–100%) | 3.5 | 5.0 |"
    )  # √12.5 and √25 mm


@pytest.mark.slow
def test_what_is_predicted_was_not_seen(tmp_path: Path) -> None:
    """Fit to a single recording without its first or last third, and predict windows of that third alone."""
    case = load_case(MEASURED)
    (name,) = case.identify
    begin, end = case.recordings[name].time[[0, -1]]
    third = (end - begin) / 3.0
    for part, problem, rest in parted(case, tmp_path):
        ((_, since, until),) = rest
        assert until - since == pytest.approx(third, abs=0.1)
        seen = problem.recordings[0].time
        assert seen[0] >= until - 0.1 if part == "first third" else seen[-1] <= since
        made = list(windows(case, problem, fit(problem, Hypothesis(())), rest))
        assert len(made) == np.floor((third - 5.0) / 3.0) + 1
        assert all(0.0 <= one.inside <= 1.0 and one.deviation > 0.0 for one in made)


def test_recordings_are_left_out_in_turn(tmp_path: Path) -> None:
    """Leave every recording out once where there are three or more."""
    write_case(tmp_path / "case", Experiment(duration=4.0, identify=4, predict=0, seed=1))
    parts = list(parted(load_case(tmp_path / "case"), tmp_path))
    left_out = [name for _, _, rest in parts for name, _, _ in rest]
    assert sorted(left_out) == [f"rec_0{number}.csv" for number in range(1, 5)]
    for _, problem, rest in parts:
        assert not {one.name for one in problem.recordings} & {name for name, _, _ in rest}
