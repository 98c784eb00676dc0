"""Time stamps: what can be mended is mended and said, what is uneven is measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from harness.recording import Recording, load_recording
from tests.recording.simulated import contract_columns, simulated, write

TIME, ANGLE, POSITION = simulated()


def load(folder: Path, **columns: np.ndarray) -> Recording:
    """The default recording with columns replaced."""
    return load_recording(write(folder / "rec.csv", {**contract_columns(), **columns}))


def texts(recording: Recording, severity: str) -> list[str]:
    """Findings of one severity."""
    return [finding.text for finding in recording.findings if finding.severity == severity]


def test_even_sampling_is_not_mentioned(tmp_path: Path) -> None:
    """Report nothing for an even recording."""
    assert load(tmp_path).findings == ()


def test_duplicates_are_averaged(tmp_path: Path) -> None:
    """Merge rows of the same time into their mean, warn and name the row."""
    time = TIME.copy()
    time[50] = time[49]
    recording = load(tmp_path, time_s=time)
    assert np.all(np.diff(recording.time) > 0)
    assert len(recording.time) == len(TIME) - 1
    np.testing.assert_allclose(recording.angle[49], (ANGLE[49] + ANGLE[50]) / 2, rtol=1e-15)
    np.testing.assert_allclose(recording.position[49], (POSITION[49] + POSITION[50]) / 2, rtol=1e-15)
    (warning,) = texts(recording, "warning")
    assert "repeat" in warning
    assert "row 52" in warning  # index 50, after the header, counted from 1


def test_duplicate_with_one_unknown_position(tmp_path: Path) -> None:
    """Average only known values of rows with the same time."""
    time, position = TIME.copy(), POSITION.copy()
    time[50], position[50] = time[49], np.nan
    assert load(tmp_path, time_s=time, ball_position_m=position).position[49] == POSITION[49]


def test_coarse_stamps_are_explained(tmp_path: Path) -> None:
    """Say that time stamps have too few digits if many coincide."""
    (warning,) = texts(load(tmp_path, time_s=np.floor(TIME / 0.02) * 0.02), "warning")
    assert "coarse clock" in warning
    assert "with enough digits" in warning


def test_short_angle_dropout_is_bridged(tmp_path: Path) -> None:
    """Fill three blank angles by a straight line, which stays within the curve's own sagitta, and warn."""
    angle = ANGLE.copy()
    angle[300:303] = np.nan
    recording = load(tmp_path, beam_angle_rad=angle)
    # Chord of 4 steps: sagitta max|α̈| T²/8 with max|α̈| = 0.03·1.3² + 0.02·2.9² = 0.22 rad/s², plus one count.
    sagitta = 0.22 * 0.04**2 / 8 + 2 * np.pi / 40_000
    assert np.max(np.abs(recording.angle - ANGLE)) < sagitta
    (warning,) = texts(recording, "warning")
    assert "rows 302-304" in warning


def test_gap_in_time_is_placed(tmp_path: Path) -> None:
    """Warn of missing samples with their place and length."""
    keep = np.r_[0:400, 450 : len(TIME)]
    recording = load(tmp_path, **{name: values[keep] for name, values in contract_columns().items()})
    (warning,) = texts(recording, "warning")
    assert "0.51 s after row 401 (t = 3.99 s)" in warning
    assert texts(recording, "note") == []


def test_jitter_is_measured(tmp_path: Path) -> None:
    """Note uneven sampling with its size, and keep the stamps."""
    time = TIME + np.random.default_rng(2).uniform(-1e-3, 1e-3, len(TIME))
    recording = load(tmp_path, time_s=time)
    np.testing.assert_array_equal(recording.time, time)
    (note,) = texts(recording, "note")
    assert "uneven" in note
    assert texts(recording, "warning") == []


def test_start_of_clock_does_not_matter(tmp_path: Path) -> None:
    """Accept stamps with a large offset."""
    recording = load(tmp_path, time_s=TIME + 86_400.0)
    assert recording.time[0] == 86_400.0
    assert texts(recording, "warning") == []
