"""Spikes are marked and kept; what a real ball does is no spike."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import load_recording
from harness.recording.outliers import spikes
from tests.recording.simulated import NOISE, contract_columns, simulated, write

ACCELERATION = 9.81 * 0.07  # g α of the simulated motion with a degree to spare


def test_noise_is_no_spike() -> None:
    """Mark none of 1e5 normal samples: beyond six sigma lie 2e-4 of them on average."""
    time = np.arange(100_000) * 0.01
    position = 0.3 + 0.1 * np.sin(1.5 * time) + np.random.default_rng(0).normal(0, NOISE, len(time))
    assert not spikes(time, position, resolution=0.0, acceleration=ACCELERATION).any()


@pytest.mark.parametrize("side", [(-1.0,), (1.0,), (-1.0, 1.0)], ids=("below", "above", "both"))
@pytest.mark.parametrize("share", [0.01, 0.1])
def test_spikes_are_found(side: tuple[float, ...], share: float) -> None:
    """Find isolated spikes of 20 sigma, on one side or both, and nothing else.

    With a tenth of the samples spoilt a window of 11 holds five or more, more than half of a line's points, with
    probability 3e-3 (binomial); such windows may hide a spike or, if their neighbours fail too, blame a sound sample.
    """
    time, _, clean = simulated()
    rng = np.random.default_rng(3)
    spoilt = rng.random(len(time)) < share
    position = clean + 20 * NOISE * spoilt * rng.choice(side, len(time))
    mask = spikes(time, position, resolution=1e-4, acceleration=ACCELERATION)
    assert np.mean(mask[spoilt]) > 0.95
    assert np.mean(mask[~spoilt]) < 3e-3


def test_ends_are_guarded() -> None:
    """Find a spike in the very first and the very last sample."""
    time, _, clean = simulated()
    position = clean.copy()
    position[[0, -1]] += 0.02
    mask = spikes(time, position, resolution=1e-4, acceleration=ACCELERATION)
    assert list(np.flatnonzero(mask)) == [0, len(time) - 1]


def test_impact_and_step_are_no_spikes() -> None:
    """Mark neither a ball that bounces off an end stop nor a lasting step."""
    time = np.arange(600) * 0.01
    noise = np.random.default_rng(4).normal(0, NOISE, len(time))
    bounce = 0.4 - 0.3 * np.abs(time - 3.0)
    step = 0.3 + 0.05 * (time > 3.0)
    for path in (bounce, step):
        assert not spikes(time, path + noise, resolution=0.0, acceleration=ACCELERATION).any()


def test_noise_that_grows_with_distance() -> None:
    """Estimate the noise locally: the paper's laser has 0.3 mm below 400 mm and 0.8 mm above."""
    time = np.arange(4000) * 0.01
    path = 0.4 + 0.15 * np.sin(0.5 * time)
    sigma = np.where(path < 0.4, 3e-4, 8e-4)
    position = path + sigma * np.random.default_rng(5).normal(size=len(time))
    assert not spikes(time, position, resolution=0.0, acceleration=ACCELERATION).any()


def test_resting_ball_without_noise() -> None:
    """Mark nothing when a ball that rested starts to move, although the record before it has no scatter at all."""
    time = np.arange(1000) * 0.01
    position = 0.3 + 0.5 * 0.3 * np.maximum(time - 8.0, 0.0) ** 2
    assert not spikes(time, position, resolution=0.0, acceleration=ACCELERATION).any()


def test_recording_keeps_its_spikes(tmp_path: Path) -> None:
    """Keep the spike in the position, mark it, and name its row in a warning."""
    columns = contract_columns()
    columns["ball_position_m"] = columns["ball_position_m"].copy()
    columns["ball_position_m"][400] -= 0.05
    recording = load_recording(write(tmp_path / "rec.csv", columns))
    np.testing.assert_array_equal(recording.position, columns["ball_position_m"])
    assert list(np.flatnonzero(recording.outlier)) == [400]
    (finding,) = recording.findings
    assert finding.severity == "warning"
    assert "row 402" in finding.text


def test_glitch_of_the_angle(tmp_path: Path) -> None:
    """Warn of a spike in the angle, which drives every model, and name its row."""
    columns = contract_columns()
    columns["beam_angle_rad"] = columns["beam_angle_rad"].copy()
    columns["beam_angle_rad"][700] += 0.1
    recording = load_recording(write(tmp_path / "rec.csv", columns))
    np.testing.assert_array_equal(recording.angle, columns["beam_angle_rad"])
    (finding,) = recording.findings
    assert "angles are outliers" in finding.text
    assert "row 702" in finding.text


def test_unknown_positions_are_no_spikes() -> None:
    """Mark no unknown position, and detect spikes beside unknown positions."""
    time, _, clean = simulated()
    position = clean.copy()
    position[300:500] = np.nan
    position[500] += 0.03
    mask = spikes(time, position, resolution=1e-4, acceleration=ACCELERATION)
    assert list(np.flatnonzero(mask)) == [500]
