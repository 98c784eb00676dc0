"""What takes more than ten minutes says so and asks, before anything is computed; ordinary use is never asked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.api import diagnosis
from harness.api.case import load_case
from harness.api.comparison import compare
from harness.api.diagnosis import diagnose
from harness.api.effort import ASKED, ask, comparison_time, diagnosis_time
from harness.comparison import Choices
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of
from harness.errors import InputError
from tests.acceptance.conftest import Harness
from tests.acceptance.short import write_short_case
from tests.recording.simulated import csv_text
from tests.shared_data import measured_rigs


@pytest.mark.parametrize("rig", measured_rigs(), ids=lambda path: path.name)
def test_ordinary_use_is_not_asked(rig: Path) -> None:
    """Neither diagnose nor compare measured rigs with consent only."""
    case = load_case(rig)
    used = [case.recordings[name] for name in case.identify]
    engines = [(engine_of(name), engine_of(name).parameters()) for name in DEFAULT_ENGINES]
    longest = max(float(np.ptp(one.time)) for one in used)
    ask(diagnosis_time(used), "", yes=False)
    ask(comparison_time(longest, engines, Choices()), "", yes=False)


def test_a_long_run_asks(harness: Harness, tmp_path: Path) -> None:
    """Say how long small steps take and what to do, end with 2, write nothing."""
    case = write_short_case(tmp_path / "case")
    done = harness("run", case, "--set", "pybullet.time_step=2e-6", "--out", tmp_path / "out")
    assert done.code == 2
    (message,) = done.errors
    assert "this would take some" in message
    assert "--yes" in message
    assert not (tmp_path / "out").exists()


def long_recording(folder: Path) -> Path:
    """Ten minutes at 200 Hz."""
    time = np.arange(120_000) / 200.0
    columns = {
        "time_s": time,
        "beam_angle_rad": 0.02 * np.sin(time),
        "ball_position_m": 0.3 + 0.14 * np.sin(time) + 3e-4 * np.cos(7919.0 * time),
    }
    file = folder / "rec.csv"
    file.write_text(csv_text(columns), encoding="utf-8")
    return file


def test_a_long_diagnosis_asks(tmp_path: Path) -> None:
    """Refuse more readings than ten minutes are enough for, and write nothing."""
    with pytest.raises(InputError, match=r"would take some 2\d minutes.*--yes"):
        diagnose(long_recording(tmp_path), out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_consent_is_enough(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Begin where the user says yes."""

    class BegunError(Exception):
        pass

    def begin(*_: object, **__: object) -> None:
        raise BegunError

    case = write_short_case(tmp_path / "case")
    monkeypatch.setattr(diagnosis, "diagnosis_time", lambda _: 2.0 * ASKED)
    monkeypatch.setattr("harness.identify.pose.problem_of", begin)
    monkeypatch.setattr("harness.comparison.prepare", begin)
    with pytest.raises(InputError, match="20 minutes"):
        diagnose(case)
    with pytest.raises(BegunError):
        diagnose(case, yes=True)
    small = {"pybullet": {"time_step": 2e-6}}
    with pytest.raises(BegunError):
        compare(case, settings=small, yes=True)
