"""Stamps that come in bunches are spread where the readings were taken evenly, and are left where they were not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.recording import load_recording

RATE = 100.0
TIME = np.arange(0.0, 10.0, 1.0 / RATE)
TICK = 1e-4  # of the clock, as files have it [s]


def written(path: Path, stamps: FloatArray, taken: FloatArray = TIME, noise: float = 2e-4) -> Path:
    """A recording of a swinging beam and a ball, read at the times `taken` and stamped otherwise, shape (n,) [s]."""
    generator = np.random.default_rng(3)
    angle = np.round(0.05 * np.sin(3.0 * taken), 5)
    position = 0.3 - 0.05 * np.sin(3.0 * taken) + noise * generator.standard_normal(taken.size)
    rows = np.column_stack((stamps, angle, position))
    np.savetxt(path, rows, "%.4f,%.5f,%.5f", header="time_s,beam_angle_rad,ball_position_m", comments="")
    return path


def in_bunches(size: int, tick: float = TICK, taken: FloatArray = TIME) -> FloatArray:
    """Stamps of readings that are fetched `size` at once, a tick apart, when the last of them is there, shape (n,)."""
    order = np.arange(taken.size)
    last = np.minimum((order // size + 1) * size, taken.size) - 1
    stamps: FloatArray = taken[last] - (last - order) * tick
    return stamps


@pytest.mark.parametrize("size", [2, 3, 5])
@pytest.mark.parametrize("tick", [TICK, 0.0])
def test_readings_that_were_stamped_together_get_the_times_at_which_they_were_taken(
    tmp_path: Path, size: int, tick: float
) -> None:
    """Place each reading within the clock's ticks of the time at which it was taken, and say so."""
    recording = load_recording(written(tmp_path / "rec.csv", in_bunches(size, tick)))
    assert len(recording.time) == TIME.size
    assert np.abs(recording.time - TIME).max() < 2.0 * TICK
    said = {one.code: one for one in recording.findings}
    assert f"bunches of {size} readings" in said["bunched-stamps"].text
    assert "0.01 s a reading" in said["bunched-stamps"].text
    assert "gaps" not in said
    assert "equal-stamps" not in said


@pytest.mark.parametrize("seed", range(12))
def test_bunches_are_told_by_the_few_readings_of_a_slow_rig(tmp_path: Path, seed: int) -> None:
    """Spread three readings each at 10 Hz, of a ball that rests, and then moves a few centimetres at once."""
    generator = np.random.default_rng(seed)
    taken = 0.1 * np.arange(159)
    angle = 0.02 * np.sin(3.0 * taken) + 0.02 * np.sin(1.1 * taken + seed)
    moved = np.cumsum(generator.uniform(size=taken.size) < 0.1)  # and rests between
    position = 0.3 + 0.05 * np.sin(0.6 * moved) + 5e-4 * generator.standard_normal(taken.size)
    rows = np.column_stack((in_bunches(3, taken=taken), angle, position))
    path = tmp_path / "rec.csv"
    np.savetxt(path, rows, "%.4f,%.5f,%.5f", header="time_s,beam_angle_rad,ball_position_m", comments="")
    assert np.abs(load_recording(path).time - taken).max() < 2.0 * TICK


def test_a_gap_between_bunches_stays(tmp_path: Path) -> None:
    """Spread no bunch over a second in which nothing was recorded."""
    kept = np.abs(np.arange(TIME.size) // 4 - 125) > 12  # whole bunches
    recording = load_recording(written(tmp_path / "rec.csv", in_bunches(4)[kept], TIME[kept]))
    assert np.abs(recording.time - TIME[kept]).max() < 0.5 / RATE
    assert "gaps" in {one.code for one in recording.findings}


def test_readings_that_were_taken_together_keep_their_stamps(tmp_path: Path) -> None:
    """Believe the stamps of a rig that takes four readings in a row and then pauses: its readings say so too."""
    stamps = in_bunches(4)
    recording = load_recording(written(tmp_path / "rec.csv", stamps, stamps, noise=1e-5))
    assert np.allclose(recording.time, stamps, atol=TICK)
    assert "bunched-stamps" not in {one.code for one in recording.findings}


def test_uneven_stamps_are_no_bunches(tmp_path: Path) -> None:
    """Leave stamps that are true but uneven by a third as they are."""
    uneven = 0.33 / RATE * np.random.default_rng(5).standard_normal(TIME.size - 1)
    steps: FloatArray = np.clip(1.0 / RATE + uneven, 0.001, None).astype(np.float64)
    stamps: FloatArray = np.round(np.append(0.0, np.cumsum(steps)), 4)
    recording = load_recording(written(tmp_path / "rec.csv", stamps, stamps))
    assert np.array_equal(recording.time, stamps)
    assert "bunched-stamps" not in {one.code for one in recording.findings}
