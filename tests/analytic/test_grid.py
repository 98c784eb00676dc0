"""A grid cuts the gaps between stamps into equal steps and loses nothing, whatever the stamps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.kernel import Grid
from analytic.motion import FloatArray
from tests.motions import ClosedForm

EPS = np.finfo(float).eps


# A motion whose angle is the time itself, so that a table shows when it was evaluated.
CLOCK = ClosedForm(lambda time: time, lambda time: -time, lambda time: 2.0 * time)


@st.composite
def stamps(draw: st.DrawFn) -> FloatArray:
    """Up to 30 stamps, microseconds to a second apart, starting anywhere within an hour."""
    gaps = draw(st.lists(st.floats(1e-6, 1.0), max_size=29))
    return draw(st.floats(-10.0, 3600.0)) + np.concatenate(([0.0], np.cumsum(gaps)))


LONGEST = st.floats(1e-3, 2.0)


@given(time=stamps(), longest=LONGEST)
def test_steps_fill_the_gaps_equally(time: FloatArray, longest: float) -> None:
    """Cut every gap into equal steps that add up to it."""
    grid = Grid.over(time, longest)
    for gap, begin, end in zip(np.diff(time), grid.marks[:-1], grid.marks[1:], strict=True):
        steps = grid.steps[begin:end]
        assert np.all(steps == steps[0])
        # one division and as many additions, each rounded by half an ulp of the gap
        assert np.sum(steps) == pytest.approx(gap, rel=len(steps) * EPS, abs=0.0)


@given(time=stamps(), longest=LONGEST)
def test_steps_are_short_enough_and_no_shorter(time: FloatArray, longest: float) -> None:
    """Take the fewest steps that respect the longest one, up to a part in 1e9."""
    grid = Grid.over(time, longest)
    count = np.diff(grid.marks)
    # 1e-9 of a *count* is given away so that 10 ms of 2.5 ms are four steps however the stamps round
    assert np.all(grid.steps <= longest * (1.0 + 2e-9))
    assert np.all((count == 1) | (np.diff(time) > longest * (count - 1)))


@given(time=stamps(), longest=LONGEST)
def test_marks_lead_from_stamps_to_steps(time: FloatArray, longest: float) -> None:
    """Mark where each stamp's steps begin, the last stamp after the last step."""
    grid = Grid.over(time, longest)
    assert len(grid.marks) == len(time)
    assert grid.marks[0] == 0
    assert grid.marks[-1] == len(grid.steps)
    assert np.all(np.diff(grid.marks) >= 1)


@given(time=stamps(), longest=LONGEST)
def test_table_asks_the_motion_at_both_ends_and_middle_of_each_step(time: FloatArray, longest: float) -> None:
    """Ask exactly at the stamps, never outside them, and in between where the steps lie."""
    grid = Grid.over(time, longest)
    table = grid.tabulate(CLOCK)
    asked = table[:, 0]
    assert table.shape == (2 * len(grid.steps) + 1, 3)
    np.testing.assert_array_equal(table[:, :2], np.outer(asked, [1.0, -1.0]))
    np.testing.assert_array_equal(table[::2, 2], 2.0 * asked[::2])
    # The clock's α̈ has nothing to do with its α̇; the middle's is what makes Simpson's rule give the change of α̇.
    simpson = (table[:-2:2, 2] + 4.0 * table[1::2, 2] + table[2::2, 2]) / 6.0 * grid.steps
    scale = (1.0 + np.abs(asked[1::2])) * EPS
    assert np.all(np.abs(simpson - np.diff(table[::2, 1])) <= 20.0 * scale)
    np.testing.assert_array_equal(asked[2 * grid.marks], time)
    assert asked.min() == time[0]
    assert asked.max() == time[-1]
    # times near 3600 s are rounded to half an ulp on each side; a running sum would drift with the number of steps
    rounding = 2.0 * EPS * max(np.abs(time).max(), 1.0)
    np.testing.assert_allclose(np.diff(asked[::2]), grid.steps, rtol=1e-14, atol=rounding)
    np.testing.assert_allclose(asked[1::2], 0.5 * (asked[:-2:2] + asked[2::2]), rtol=0.0, atol=rounding)


def test_even_recording_gets_even_steps() -> None:
    """Give a recording of 100 Hz four steps of 2.5 ms a stamp over an hour, despite rounded stamps."""
    grid = Grid.over(np.arange(0, 360_001) * 0.01)
    assert set(np.diff(grid.marks)) == {4}


@pytest.mark.parametrize(
    "time",
    [[], [0.0, 0.0], [0.0, 1.0, 0.5], [0.0, np.nan, 1.0], [[0.0, 1.0], [2.0, 3.0]]],
    ids=["empty", "repeated", "backward", "NaN", "table"],
)
def test_stamps_that_do_not_increase_are_refused(time: list[float]) -> None:
    """Refuse stamps between which nothing can be integrated."""
    with pytest.raises(ValueError, match="strictly increasing"):
        Grid.over(np.array(time))
