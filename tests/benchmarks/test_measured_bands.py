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


def test_a_rig_is_told_by_means_over_its_windows() -> None:
    """Give the mean share of readings, and roots of mean squares."""
    made = [Window(1.0, 9e-6, 1e-6), Window(0.5, 16e-6, 49e-6)]
    assert line("rig", "nothing", made).endswith("| 2 | 75% (50%–100%) | 3.5 | 5.0 |")  # √12.5 and √25 mm


@pytest.mark.slow
def test_what_is_predicted_was_not_seen(tmp_path: Path) -> None:
    """Fit to the first two thirds of a single recording, and predict windows of the rest alone."""
    case = load_case(MEASURED)
    problem, rest = parted(case, tmp_path)
    (name,) = case.identify
    time = case.recordings[name].time
    ((_, since),) = rest
    assert since == pytest.approx(time[0] + 2.0 / 3.0 * (time[-1] - time[0]), abs=0.1)
    assert problem.recordings[0].time[-1] <= since
    made = list(windows(case, problem, fit(problem, Hypothesis(())), rest))
    assert len(made) == np.floor((time[-1] - since - 5.0) / 3.0) + 1
    assert all(0.0 <= one.inside <= 1.0 and one.deviation > 0.0 for one in made)
