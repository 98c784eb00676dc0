"""Horizons: the whole recording and windows that tile it, left out for declared reasons only."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.comparison import Choices, prepare, study
from harness.comparison.horizons import horizons
from harness.recording import load_case


@given(
    gaps=st.lists(st.floats(0.004, 0.03), min_size=150, max_size=600),
    length=st.floats(0.2, 2.0),
    offset=st.floats(-5.0, 5.0),
)
def test_windows_tile_the_recording(gaps: list[float], length: float, offset: float) -> None:
    """Lay windows end to end from the first stamp, each as long as asked for, up to less than one from the end."""
    time = offset + np.concatenate(([0.0], np.cumsum(gaps)))
    known = np.ones(len(time), bool)
    whole, *others = horizons(time, known, [length])
    assert (whole.first.tolist(), whole.last.tolist(), whole.name) == ([0], [len(time) - 1], "whole")
    # An edge moves to the next stamp, by at most one gap; the last may besides lie one median gap short of its place.
    longest = 2.0 * max(gaps)
    if others:
        (windows,) = others
        assert windows.first[0] == 0
        np.testing.assert_array_equal(windows.first[1:], windows.last[:-1])
        np.testing.assert_allclose(time[windows.last] - time[windows.first], length, atol=longest)
        assert time[-1] - time[windows.last[-1]] < length + longest
    else:
        assert time[-1] - time[0] < length


def test_a_last_stamp_short_by_one_interval_completes_a_window() -> None:
    """Cut 16 s at 100 Hz, whose last stamp is 15.99 s, into eight windows of 2 s."""
    time = np.arange(1600) * 0.01
    found = horizons(time, np.ones(1600, bool), (2.0, 5.0))
    assert [(one.name, len(one.first)) for one in found] == [("whole", 1), ("2 s", 8), ("5 s", 3)]


def test_only_windows_that_are_mostly_blank_are_left_out() -> None:
    """Leave out a window of which less than half of the positions are known, wherever the blanks lie in it."""
    time = np.arange(601) * 0.01
    known = np.ones(601, bool)
    known[100] = False  # a window's first reading is a spike
    known[200:249] = False  # 49 of 101
    known[300:352] = False  # 52 of 101
    (_, windows) = horizons(time, known, [1.0])
    assert windows.first.tolist() == [0, 100, 200, 400, 500]


def test_the_whole_recording_begins_with_the_first_known_position() -> None:
    """Start at the first known position."""
    time = np.arange(501) * 0.01
    known = time >= 0.995
    whole, windows = horizons(time, known, [2.0])
    assert (time[whole.first[0]], time[whole.last[0]]) == pytest.approx((1.0, 5.0))
    assert time[windows.first] == pytest.approx([1.0, 3.0])


def test_lengths_are_cleaned_up() -> None:
    """Take lengths in any order, each once, and none that is longer than the recording."""
    time = np.arange(501) * 0.01
    found = horizons(time, np.ones(501, bool), (2.0, 60.0, 1.0, 2.0))
    assert [one.name for one in found] == ["whole", "1 s", "2 s"]


@pytest.mark.slow
def test_a_recording_to_predict_runs_to_its_end(shared: Path) -> None:
    """Give trajectories for the whole recording where positions are known for the first 1.5 s only."""
    case = load_case(shared / "cases" / "null_plain")
    setting = prepare(case, Choices(recording="rec_03.csv"))
    known = setting.recording.known
    assert setting.time[known][-1] == 1.5
    assert known.mean() < 0.2
    result = study(setting, [])
    for source in result.sources:
        assert np.isfinite(result.run_of(source, setting.horizons[0]).position).all(), source
    # Scored where the ball is known, and there alone.
    assert result.score_of("cam", setting.horizons[0]).samples == int((setting.ball.trusted & known).sum())
    truth = np.genfromtxt(case.recordings["rec_03.csv"].path.with_name("rec_03_true.csv"), delimiter=",", names=True)
    cam, u_val = result.run_of("cam", setting.horizons[0]).position, result.u_val[0]
    off = np.interp(setting.time, truth["time_s"], truth[truth.dtype.names[-1]]) - cam
    # Nothing acts here that CAM lacks, so that it predicts as well as start and angle are known: 3 u_val, everywhere.
    assert np.all(np.abs(off) < 3.0 * u_val)
