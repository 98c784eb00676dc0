"""A sensor that is logged faster than it measures is noticed by its repeats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.recording import load_recording
from harness.recording.held import repeats

TIME = np.arange(0.0, 12.0, 0.02)


def ball(noise: float, step: float, seed: int = 1) -> FloatArray:
    """Positions of a ball that swings by 10 cm, read with noise and in steps, shape (n,) [m]."""
    read = 0.3 + 0.1 * np.sin(1.5 * TIME) + noise * np.random.default_rng(seed).standard_normal(TIME.size)
    rounded: FloatArray = np.round(read / step) * step
    return rounded


def held(position: FloatArray, times: int) -> FloatArray:
    """Each reading `times` rows long, shape (n,) [m]."""
    return position[np.arange(position.size) // times * times]


@pytest.mark.parametrize("times", [2, 4])
@pytest.mark.parametrize("step", [1e-4, 2e-3])
def test_a_held_sensor_is_noticed(tmp_path: Path, times: int, step: float) -> None:
    """Say how many positions are repeats and how often there is a new one, and change none."""
    position = held(ball(3.0 * step, step), times)
    rows = np.column_stack((TIME, 0.02 * np.sin(1.5 * TIME), position))
    np.savetxt(tmp_path / "rec.csv", rows, "%.3f,%.5f,%.5f", header="time_s,beam_angle_rad,position_m", comments="")
    recording = load_recording(tmp_path / "rec.csv")
    (note,) = (one for one in recording.findings if one.code == "held-position")
    counted = int(np.sum(np.diff(position) == 0.0))
    assert note.severity == "note"
    assert int(note.text.split()[0]) == counted
    every = float(note.text.split("about every ")[1].split(" s")[0])
    assert 0.02 * times <= every < 1.5 * 0.02 * times  # longer where a new reading is by chance the same
    assert np.allclose(recording.position, position)


@pytest.mark.parametrize(("noise", "step"), [(4e-4, 1e-4), (3e-3, 1e-3), (0.0, 1e-2), (1e-4, 1e-3)])
def test_a_coarse_sensor_and_a_resting_ball_are_not_held(noise: float, step: float) -> None:
    """Find nothing where equal readings are by chance, by a slow ball, or by one that rests for seconds."""
    moving = ball(noise, step)
    assert repeats(moving, resolution=step) == 0
    resting = np.where(np.sin(0.7 * TIME) > 0.0, np.round(0.35 / step) * step, moving)
    assert repeats(resting, resolution=step) == 0
