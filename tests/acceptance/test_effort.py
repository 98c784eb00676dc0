"""What takes over ten minutes or 4 GB says so and asks, before anything is computed; ordinary use is never asked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.api import diagnosis
from harness.api.case import load_case
from harness.api.comparison import compare
from harness.api.diagnosis import diagnose
from harness.api.effort import ASKED, MEMORY_ASKED, ask, comparison_time, diagnosis_time, expected, tuning_time
from harness.api.memory import comparison_memory, diagnosis_memory, tuning_memory
from harness.api.tuning import tune
from harness.comparison import Choices
from harness.engines.catalogue import DEFAULT_ENGINES, engine_of
from harness.errors import InputError
from tests.acceptance.conftest import Harness, Outcome
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
    ask(diagnosis_time(used), diagnosis_memory(used), "", yes=False)
    for one in used:
        ask(comparison_time(longest, engines, Choices()), comparison_memory(one, engines, Choices()), "", yes=False)


def test_tuning_the_default_set_is_not_asked_on_two_processors() -> None:
    """Expect less than ten minutes for two recordings of 16 s, and no more of many processors than a step can use."""
    engine, durations, free = engine_of("mujoco"), (16.0, 16.0), 5  # the default set and the level
    alone, two, three, many = (tuning_time(durations, free, engine, {}, jobs) for jobs in (1, 2, 3, 64))
    assert two < ASKED < alone
    assert two == alone / 2.0
    assert three == many == alone / 3.0


def asked(done: Outcome) -> str:
    """The one message of a command that ended with 2 and says how to go on all the same."""
    assert done.code == 2
    (message,) = done.errors
    assert "--yes" in message
    return message


def test_a_long_run_asks(harness: Harness, tmp_path: Path) -> None:
    """Say how long small steps take and what to do, end with 2, write nothing."""
    case = write_short_case(tmp_path / "case")
    done = harness("run", case, "--set", "pybullet.time_step=2e-6", "--out", tmp_path / "out")
    assert "this would take some" in asked(done)
    assert not (tmp_path / "out").exists()


def long_recording(folder: Path, rate: float) -> Path:
    """120,000 rows at a rate [Hz]."""
    time = np.arange(120_000) / rate
    columns = {
        "time_s": time,
        "beam_angle_rad": 0.02 * np.sin(time),
        "ball_position_m": 0.3 + 0.14 * np.sin(time) + 3e-4 * np.cos(7919.0 * time),
    }
    file = folder / "rec.csv"
    file.write_text(csv_text(columns), encoding="utf-8")
    return file


@pytest.mark.slow
def test_a_long_diagnosis_asks(tmp_path: Path) -> None:
    """Refuse more readings than ten minutes are enough for, at a rate at which each is used, and write nothing."""
    with pytest.raises(InputError, match=r"would take some 1\d minutes.*--yes"):
        diagnose(long_recording(tmp_path, 100.0), out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_consent_is_enough(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Begin where the user says yes."""

    class BegunError(Exception):
        pass

    def begin(*_: object, **__: object) -> None:
        raise BegunError

    case = write_short_case(tmp_path / "case")
    monkeypatch.setattr(diagnosis, "diagnosis_time", lambda _: 2.0 * ASKED)
    monkeypatch.setattr(diagnosis, "diagnosis_memory", lambda _: 2.0 * MEMORY_ASKED)
    monkeypatch.setattr("harness.identify.pose.problem_of", begin)
    monkeypatch.setattr("harness.comparison.prepare", begin)
    with pytest.raises(InputError, match=r"20 minutes, more than 10 and up to 8\.0 GB of memory, more than 4; list"):
        diagnose(case)
    with pytest.raises(BegunError):
        diagnose(case, yes=True)
    small = {"pybullet": {"time_step": 2e-6}}
    with pytest.raises(BegunError):
        compare(case, settings=small, yes=True)


@pytest.mark.slow
def test_what_memory_does_not_hold_asks(harness: Harness, tmp_path: Path) -> None:
    """Refuse to compare a long recording in steps so small that memory does not hold them."""
    out = tmp_path / "out"
    small = ("--set", "mujoco.time_step=4e-4")
    done = harness("run", long_recording(tmp_path, 200.0), "--engine", "mujoco", *small, "--out", out)
    message = asked(done)
    assert "this would take up to " in message  # 7 minutes, which is not too long
    assert "GB of memory, more than 4; set a longer time_step" in message
    assert not out.exists()


def test_a_large_diagnosis_asks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refuse more memory than 4 GB where the time is short, and write nothing."""
    case = write_short_case(tmp_path / "case")
    monkeypatch.setattr(diagnosis, "diagnosis_memory", lambda _: 6.1e9)
    with pytest.raises(InputError, match=r"this would take up to 6\.1 GB of memory, more than 4; .*--yes"):
        diagnose(case, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_large_tuning_asks(tmp_path: Path) -> None:
    """Refuse engine runs in so many processes that memory does not hold them together, and write nothing."""
    case = write_short_case(tmp_path / "case")
    # 5 s in steps of 10 µs are 0.5 GB a process; the number of free parameters keeps the time short.
    with pytest.raises(InputError, match=r"GB of memory, more than 4; .*--yes"):
        tune(case, free=["friction"], settings={"mujoco": {"time_step": 1e-5}}, jobs=16, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_large_sweep_asks(harness: Harness, tmp_path: Path) -> None:
    """Refuse processes whose engine runs together take more than memory holds, and write nothing."""
    write_short_case(tmp_path / "case")
    spec = tmp_path / "fine.toml"
    spec.write_text('cases = ["case"]\nsources = ["mujoco"]\ntime_step = [2e-6]\n', encoding="utf-8")
    done = harness("sweep", spec, "--jobs", "8", "--out", tmp_path / "out")
    assert "GB of memory, more than 4; sweep fewer points" in asked(done)
    assert not (tmp_path / "out").exists()


def test_memory_grows_as_the_arrays_do() -> None:
    """Let a diagnosis grow with readings times recordings, a comparison with the duration."""
    case = load_case("paper_protocol")
    one = case.recordings[case.identify[0]]
    sizes = [diagnosis_memory([one] * count) for count in (100, 200, 400)]
    assert 3.0 < (sizes[2] - sizes[1]) / (sizes[1] - sizes[0]) < 4.0  # 2 if linear, 4 if square
    assert sizes[2] > MEMORY_ASKED
    lengths = [replace(one, time=np.arange(round(100.0 * length)) / 100.0) for length in (300.0, 600.0, 1200.0)]
    sizes = [comparison_memory(each, [], Choices()) for each in lengths]
    assert (sizes[2] - sizes[1]) / (sizes[1] - sizes[0]) == pytest.approx(2.0)
    assert tuning_memory([one], 1e-3, 2) > diagnosis_memory([one])


def test_a_diagnosis_tells_what_it_takes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tell time and memory with the first step of the progress, before anything is computed."""
    told: list[str] = []

    class BegunError(Exception):
        pass

    def begin(*_: object, **__: object) -> None:
        raise BegunError

    def tell(text: str, *, share: float | None = None) -> None:
        told.append(text)

    monkeypatch.setattr("harness.identify.pose.problem_of", begin)
    with pytest.raises(BegunError):
        diagnose(write_short_case(tmp_path / "case"), progress=tell)
    assert told == [f"drives and rig; {told[0].partition('; ')[2]}"]
    assert "this takes less than a minute and up to " in told[0]
    assert expected(59.0, 4.2e8) == "this takes less than a minute and up to 0.4 GB of memory"
