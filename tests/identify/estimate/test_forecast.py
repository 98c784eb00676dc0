"""Forecasts: positions from the angle alone, and a band that means what it says."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from harness.identify.estimate.fit import fit
from harness.identify.estimate.forecast import forecast
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import KNOWN, folds, horizon_spans
from harness.preparation.recordings import observe
from tests.posed import Posed


def test_a_forecast_follows_the_truth_within_its_band(plain: Posed) -> None:
    """Stay within a few deviations of the truth over 14.5 s without a position, and claim no more than that."""
    problem = plain.problem
    record = PreparedRecording.of(observe(plain.case.recordings["rec_03.csv"], plain.case.sensors, problem.rig))
    blank = np.isnan(record.reading)
    assert np.count_nonzero(blank) > 1400
    made = forecast(problem, fit(problem, Hypothesis(())), record, record.reading)
    error = np.abs(made.position - plain.truth[2].noiseless)[blank]
    assert np.all(error < 3.0 * made.deviation[blank])
    # Without new readings doubt can only grow from the known part to the end, and stays below a tenth of the travel.
    assert made.deviation[blank][-1] > made.deviation[~blank][-1]
    assert made.deviation.max() < 0.1 * np.ptp(plain.truth[2].noiseless)


def test_windows_tile_what_is_predicted() -> None:
    """Cut the time after the known part into windows that join and end within the recording."""
    time = np.arange(0.0, 16.005, 0.01)
    found = horizon_spans(time)
    assert found[-1] == ("whole", KNOWN, time[-1] + 1.0)
    for name in {name for name, *_ in found[:-1]}:
        each = [(first, last) for other, first, last in found if other == name]
        length = float(name.removesuffix(" s"))
        assert each[0][0] == KNOWN
        assert each[-1][1] <= time[-1] < each[-1][1] + length + 1e-6
        np.testing.assert_allclose(np.diff(each), length)
        assert all(before[1] == after[0] for before, after in pairwise(each))


def test_half_of_a_short_recording_is_known() -> None:
    """Predict the second half of a recording that is shorter than twice the known part."""
    time = np.arange(0.0, 3.005, 0.01)
    assert horizon_spans(time) == [("1 s", 1.5, 2.5), ("whole", 1.5, time[-1] + 1.0)]


def test_a_covariance_rounded_below_zero_widens_nothing(plain: Posed) -> None:
    """Give the band of certain values where a variance of a badly determined fit came out just below zero."""
    problem, record = plain.problem, plain.problem.recordings[0]
    found = fit(problem, Hypothesis(("level_error",)))
    certain, below = (
        forecast(problem, replace(found, covariance=np.array([[variance]])), record, record.reading)
        for variance in (0.0, -1e-12)
    )
    np.testing.assert_array_equal(below.deviation, certain.deviation)


def test_a_single_recording_is_split_where_half_is_known(plain: Posed) -> None:
    """Leave half of the positions in either part, also where none is known after the first seconds."""
    (one, *_) = plain.problem.recordings
    blank = replace(one, reading=np.where(one.time < one.time[0] + 3.0, one.reading, np.nan))
    fold, _ = folds(replace(plain.problem, recordings=(blank,)))
    (first,), (second,) = fold.problem.recordings, fold.left
    known = [int(np.isfinite(each.reading).sum()) for each in (first, second)]
    assert 0 <= known[1] - known[0] <= 1
    np.testing.assert_array_equal(np.concatenate((first.time, second.time)), one.time)
    assert second.origin == second.reading[0]
