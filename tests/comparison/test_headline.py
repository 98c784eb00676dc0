"""The headline is the longest horizon on which a run still says something of a model."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.comparison import Choices, Setting, prepare
from harness.comparison.study import headline_of
from harness.comparison.uncertainty import displacements, uncertainty
from harness.recording import load_case
from harness.simulator import Plant
from tests.comparison.made import COARSE, FINE, sensors, steps, swing, write_case
from tests.shared_data import measured_rigs


def headline(setting: Setting) -> str:
    """Its name."""
    return headline_of(setting, [uncertainty(setting, one) for one in displacements(setting)]).name


@pytest.mark.parametrize("counts", [FINE, COARSE])
def test_free_runs_count_where_the_angle_is_known(tmp_path: Path, counts: int) -> None:
    """Choose the whole recording if u_val at its end is below the ball's motion."""
    used = sensors(counts)
    made = write_case(tmp_path, [steps(11, Plant(rolling_resistance=0.002), used)], used)
    assert headline(made.prepare()) == "whole"


def test_the_bundled_recording_counts_whole(bundled: Setting) -> None:
    """Choose the free run for the bundled recording, 4,096 counts per turn."""
    assert headline(bundled) == "whole"


def test_windows_count_where_the_angle_is_poor(tmp_path: Path) -> None:
    """Choose windows if one count of 256 per turn, 25 mrad, displaces the ball by metres in 12 s."""
    used = sensors(256)
    setting = write_case(tmp_path, [swing(12, Plant(), used)], used).prepare()
    assert headline(setting) != "whole"


@pytest.mark.slow
@pytest.mark.parametrize("folder", measured_rigs(), ids=lambda path: path.name)
def test_real_rigs_are_judged_by_windows(folder: Path) -> None:
    """Choose windows for student rigs with a noisy or coarse angle."""
    setting = prepare(load_case(folder), Choices())
    assert headline(setting) in {"1 s", "2 s", "5 s"}


def test_a_recording_without_windows_keeps_its_only_horizon(tmp_path: Path) -> None:
    """Choose the whole recording if it is shorter than any window."""
    used = sensors(256, noise=5e-3)
    setting = write_case(tmp_path, [swing(13, Plant(), used, 0.8)], used).prepare(lengths=(1.0,))
    assert [one.name for one in setting.horizons] == ["whole"]
    assert headline(setting) == "whole"
