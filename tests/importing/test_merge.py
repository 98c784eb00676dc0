"""Angle and position with stamps of their own on the rows of one recording."""

from __future__ import annotations

import numpy as np

from harness.importing.merge import on_common_rows


def test_shared_stamps_are_left_alone() -> None:
    """Change nothing where both have the same stamps."""
    time = np.arange(5.0)
    *made, text = on_common_rows(time, time + 1.0, time.copy(), time + 2.0)
    np.testing.assert_array_equal(made, [time, time + 1.0, time + 2.0])
    assert text == ""


def test_a_slower_position_keeps_all_angles() -> None:
    """Keep every angle and every position; positions are blank between their stamps, and never interpolated."""
    fast, slow = np.arange(0.0, 1.0, 0.01), np.arange(0.004, 0.9, 0.05)
    time, angle, position, text = on_common_rows(fast, 2.0 * fast, slow, 3.0 * slow)
    assert len(time) == len(fast) + len(slow)
    assert np.all(np.diff(time) > 0.0)
    np.testing.assert_allclose(angle, 2.0 * time, atol=1e-15)
    np.testing.assert_array_equal(time[np.isfinite(position)], slow)
    assert "interpolated" in text


def test_a_faster_position_takes_interpolated_angles() -> None:
    """Put rows at the positions that lie within the angle's time."""
    fast, slow = np.arange(0.0, 1.0, 0.01), np.arange(0.1, 0.9, 0.02)
    time, angle, position, _ = on_common_rows(slow, 2.0 * slow, fast, 3.0 * fast)
    assert slow[0] <= time[0] < time[-1] <= slow[-1]
    np.testing.assert_allclose(angle, 2.0 * time, atol=1e-15)
    np.testing.assert_allclose(position, 3.0 * time, atol=1e-15)


def test_gaps_of_the_angle_are_not_bridged() -> None:
    """Leave the angle unknown at positions within a gap."""
    slow = np.concatenate((np.arange(0.0, 1.0, 0.02), np.arange(2.0, 3.0, 0.02)))
    fast = np.arange(0.0, 3.0, 0.01)
    time, angle, _, _ = on_common_rows(slow, slow, fast, fast)
    assert np.isnan(angle[(time > 0.99) & (time < 1.99)]).all()
    assert np.isfinite(angle[time < 0.97]).all()
