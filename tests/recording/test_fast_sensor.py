"""Of a fast sensor, neighbouring readings are used as one."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from analytic.motion import FloatArray
from harness.recording import Recording, load_recording
from harness.recording.fast_sensor import neighbours_in_mean


def recorded(folder: Path, time: FloatArray, known: NDArray[np.bool_]) -> Recording:
    """A recording with positions where they are known, which swing with the beam."""
    position = np.where(known, 0.3 * np.sin(np.pi * time), np.nan)
    lines = ["" if np.isnan(one) else f"{one:.9f}" for one in position]
    rows = [f"{t:.6f},{0.05 * math.sin(t):.9f},{one}" for t, one in zip(time, lines, strict=True)]
    file = folder / "rec.csv"
    file.write_text("\n".join(["time_s,beam_angle_rad,ball_position_m", *rows]) + "\n")
    return load_recording(file)


@pytest.mark.parametrize(("rate", "every"), [(10, 1), (100, 1), (200, 1), (329, 1), (331, 5), (500, 7), (1000, 15)])
def test_as_many_neighbours_as_leave_enough_readings(tmp_path: Path, rate: int, every: int) -> None:
    """An odd number from five on, with a mean at the stamp in the middle, and at least 66 means a second."""
    time = np.arange(5 * rate + 1) / rate
    assert neighbours_in_mean(recorded(tmp_path, time, np.ones(len(time), dtype=bool))) == every
    assert rate / every >= 66 or every == 1


def test_a_slow_sensor_in_a_fast_log_is_used_as_it_is(tmp_path: Path) -> None:
    """It is the rate of the readings that counts, not that of the rows."""
    time = np.arange(5001) / 1000
    assert neighbours_in_mean(recorded(tmp_path, time, np.arange(5001) % 20 == 0)) == 1


def test_readings_of_the_first_second_are_as_fast_as_those_of_all(tmp_path: Path) -> None:
    """Where the rest is to be predicted, the same means are made: a model states the noise of these."""
    time = np.arange(5001) / 1000
    assert neighbours_in_mean(recorded(tmp_path, time, time < 1.0)) == 15
