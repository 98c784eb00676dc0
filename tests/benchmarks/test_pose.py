"""A trial on disk: what its owner would know, and nothing of what is hidden."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.calibration.pose import PIVOT, pose, sized
from benchmarks.calibration.sizes import SCALES
from benchmarks.calibration.trials import Trial, plan
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.selection.candidates import candidates
from harness.recording import load_case


def first(name: str) -> Trial:
    """The first trial that hides this, at the middle size."""
    return next(one for one in plan(["confusion"], only=[name]) if one.size == "middle")


def test_the_truth_is_not_in_the_rig_file(tmp_path: Path) -> None:
    """Declare what is declared and keep silent on what is hidden."""
    one = replace(first("viscous_damping"), declared={"level_error": {"angle": 0.002}})
    problem = pose(one, tmp_path / "case")
    assert [each.text() for each in problem.declared] == ["level_error (angle = 0.002 rad)"]
    assert "viscous" not in (tmp_path / "case" / "rig.toml").read_text(encoding="utf-8")


def test_the_pivot_is_left_to_be_found(tmp_path: Path) -> None:
    """Take for the baseline what CAM is without its α̈ term, so that the pivot is a candidate."""
    problem = pose(first(PIVOT), tmp_path / "case")
    assert PIVOT in candidates(problem)
    assert (problem.model.eccentric, problem.model.inertia_radius, problem.model.centrifugal) == (False, "r", True)
    assert problem.rig.eccentricity == first(PIVOT).hidden[PIVOT]["eccentricity"]


@pytest.mark.slow
def test_spikes_are_there_and_set_aside(tmp_path: Path) -> None:
    """Spoil the share of readings that the trial says, by a centimetre or more; the problem leaves them out."""
    clean = replace(first("level_error"), plant="virtual_rig", spikes=0.0)
    spoilt = replace(clean, spikes=0.02)
    pose(clean, tmp_path / "clean")
    problem = pose(spoilt, tmp_path / "spoilt")
    before, after = (load_case(tmp_path / name).recordings for name in ("clean", "spoilt"))
    for record in problem.recordings:
        change = np.abs(after[record.name].position - before[record.name].position)
        spikes = change > 0.0
        # binomial of 1601 readings: 2 % ± four times 0.35 %
        assert spikes.mean() == pytest.approx(0.02, abs=0.014)
        assert change[spikes].min() > 0.009
        # a spike next to another may be taken for the ball; most stand alone
        assert np.isnan(record.reading[spikes]).mean() > 0.8


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rolling_radius", "channel_delay"])
def test_sizes_in_standard_errors_are_those_of_a_fit(name: str, tmp_path: Path) -> None:
    """Hide as many standard errors as the trial says: a fit of the law to what is recorded has these."""
    one = next(one for one in plan(["power"], only=[name]) if one.plant == "virtual_rig" and one.errors == 6.0)
    hidden = sized(one, tmp_path / "sizes")
    problem = pose(replace(one, hidden=hidden), tmp_path / "case")
    error = fit(problem, Hypothesis((name,))).deviations()[name, next(iter(SCALES[name].middle))]
    ((parameter, value),) = hidden[name].items()
    # the standard error is taken at a size that is not yet the last one: a tenth
    assert abs(value - SCALES[name].neutral) / error == pytest.approx(6.0, rel=0.1)
    assert np.sign(value - SCALES[name].neutral) == np.sign(one.hidden[name][parameter] - SCALES[name].neutral)
