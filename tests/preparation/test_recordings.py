"""A recording is prepared once, for comparison and identification alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.comparison import Choices, prepare
from harness.errors import InputError
from harness.identify.pose import problem_of
from harness.preparation.recordings import observe
from tests.posed import pose


def test_comparison_and_identification_use_the_same_readings(tmp_path: Path) -> None:
    """Give both the same drive, trusted readings and noise."""
    case = pose(tmp_path / "case", 0).case
    setting, problem = prepare(case, Choices()), problem_of(case)
    one, other = setting.recording.name, problem.recordings[0]
    observed = observe(case.recordings[one], case.sensors, setting.rig)
    assert other.name == one
    np.testing.assert_array_equal(other.drive.states, setting.drive.states)
    np.testing.assert_array_equal(other.reading, observed.reading)
    np.testing.assert_array_equal(np.isfinite(other.reading), setting.ball.trusted)
    assert setting.reading_noise == observed.noise


def test_too_few_positions_are_refused(tmp_path: Path) -> None:
    """Name the file, how many positions there are, and what to do."""
    case = pose(tmp_path / "case", 0).case
    recording = next(iter(case.recordings.values()))
    position = np.full_like(recording.position, np.nan)
    position[:2] = recording.position[:2]
    with pytest.raises(InputError, match=rf"{recording.path.name}: 3 known ball positions .* 2 are known"):
        observe(replace(recording, position=position), case.sensors, problem_of(case).rig)
