"""False alarms and power of the checks of a recording are measured, and written into their own section."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.detectors import FAULTS, Sample, false_alarms, noticed
from harness.recording import Sensors
from harness.recording.known_rig import known_rig_of
from tests.recording.simulated import ANGLE_STEP, NOISE, PAPER, POSITION_STEP, simulated

SENSORS = Sensors(angle_resolution=ANGLE_STEP, position_noise=NOISE, position_resolution=POSITION_STEP)


@pytest.fixture(scope="module")
def samples() -> list[Sample]:
    """Three sound recordings."""
    return [Sample("made", *simulated(seed=seed), known_rig_of(PAPER), SENSORS) for seed in (1, 2, 3)]


def test_sound_recordings_raise_no_alarm(samples: list[Sample], tmp_path: Path) -> None:
    """Count the recordings of each source and of all, and bound the share of alarms: 1 − 0.05^(1/3)."""
    rows = false_alarms(samples, tmp_path)
    assert rows == ["| made | 3 | 0 | 63.16% | – |", "| all | 3 | 0 | 63.16% | – |"]


@pytest.mark.parametrize("fault", ["position 0 for 0.6 s", "jump of 50 mm, lasting", "sign of the angle", "time in ms"])
def test_a_fault_is_noticed(samples: list[Sample], tmp_path: Path, fault: str) -> None:
    """Notice what no place in a recording hides."""
    assert noticed(fault, samples, tmp_path) == (3, 3)


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_changes_the_recording(samples: list[Sample], fault: str) -> None:
    """Put something into a recording under every name."""
    one = samples[0]
    changed = FAULTS[fault][0](one, np.random.default_rng(1))
    same = [np.array_equal(getattr(one, name), getattr(changed, name)) for name in ("time", "angle", "position")]
    assert not all(same) or changed.sensors != one.sensors
