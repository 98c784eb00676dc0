"""Readings of a sensor that was wrong are named and left out; what a ball or a beam at rest does is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.recording import KnownRig, Recording, Sensors, load_case, load_recording
from harness.recording.known_rig import known_rig_of
from tests.recording.simulated import NOISE, PAPER, Cosines, simulated, write

RATE = 100


def loaded(
    folder: Path,
    time: FloatArray,
    angle: FloatArray,
    position: FloatArray,
    *,
    rig: KnownRig | None = None,
    noise: float | None = None,
) -> Recording:
    """A recording read from a file."""
    columns = {"time_s": time, "beam_angle_rad": angle, "ball_position_m": position}
    return load_recording(write(folder / "rec.csv", columns), rig=rig, sensors=Sensors(position_noise=noise))


def codes(recording: Recording) -> list[str]:
    """Codes of its warnings."""
    return [one.code for one in recording.findings if one.severity == "warning"]


@pytest.fixture
def signals() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Time, angle and position of a sound recording, to be spoilt."""
    time, angle, position = simulated()
    return time, angle.copy(), position.copy()


Signals = tuple[FloatArray, FloatArray, FloatArray]


def test_a_sound_recording_is_used_whole(tmp_path: Path, signals: Signals) -> None:
    """Set nothing aside, cut nothing off, warn of nothing."""
    recording = loaded(tmp_path, *signals, rig=known_rig_of(PAPER), noise=NOISE)
    assert recording.findings == ()
    assert not len(recording.left_out)


def test_a_position_that_never_changes_is_read(tmp_path: Path, signals: Signals) -> None:
    """Read a recording of one position alone, from which nothing tells a stuck sensor."""
    time, angle, position = signals
    recording = loaded(tmp_path, time, angle, np.full_like(position, 0.3))
    assert np.ptp(recording.position[recording.known]) == 0.0


@pytest.mark.parametrize(("value", "code"), [(None, "stuck-position"), (0.0, "zeros")], ids=("stuck", "zeros"))
def test_a_stretch_of_equal_readings_is_left_out(
    tmp_path: Path, signals: Signals, value: float | None, code: str
) -> None:
    """Name the stretch with its rows, and leave out these readings and no others."""
    time, angle, position = signals
    position[420:520] = position[419] if value is None else value
    recording = loaded(tmp_path, time, angle, position)
    assert codes(recording)[0] == code
    out = np.flatnonzero(recording.set_aside)
    assert set(range(420, 520)) <= set(out.tolist()) <= set(range(419, 520))
    assert "left out of all fits" in recording.findings[0].text
    assert len(recording.left_out) == len(out)


def test_a_clipped_sensor_is_named(tmp_path: Path, signals: Signals) -> None:
    """Leave out readings at the end of a sensor's range where the ball goes on moving."""
    time, angle, position = signals
    limit = np.quantile(position, 0.8)
    recording = loaded(tmp_path, time, angle, np.minimum(position, limit))
    assert set(codes(recording)) == {"clipped"}
    # Where noise hides on which side of the limit the ball is, readings may count for either.
    beyond = position > limit + 5 * NOISE
    assert np.mean(recording.set_aside[beyond]) > 0.9
    assert not recording.set_aside[position < limit - 5 * NOISE].any()


def test_a_ball_at_rest_is_no_fault(tmp_path: Path) -> None:
    """Leave in readings of a ball that rests by friction or at an end stop, however equal they are.

    It comes and goes by less than the 0.15 m/s of a push.
    """
    time = np.arange(1200) / RATE
    angle = np.round(0.04 * np.sin(0.8 * time) / 1e-4) * 1e-4
    leaving = 0.3 + 0.5 * 0.2 * np.maximum(time - 5.0, 0.0) ** 2
    hitting = np.minimum(0.1 + 0.08 * time, 0.4)
    back = np.where(time > 8.0, 0.4 - 0.5 * 0.2 * (time - 8.0) ** 2, hitting)
    for path in (leaving, hitting, back):
        recording = loaded(tmp_path, time, angle, np.round(path, 4))
        assert not len(recording.left_out), codes(recording)


@pytest.mark.parametrize("size", [0.05, -0.05])
def test_an_offset_that_stays_parts_the_recording(tmp_path: Path, signals: Signals, size: float) -> None:
    """Use the longer part only, and say which rows these are."""
    time, angle, position = signals
    position[700:] += size
    recording = loaded(tmp_path, time, angle, position)
    assert codes(recording) == ["jump"]
    np.testing.assert_array_equal(recording.time, time[:700])
    np.testing.assert_array_equal(recording.left_out, np.column_stack((time, position))[700:])
    assert "before row 702" in recording.findings[0].text
    assert "Only rows 2-701 are used" in recording.findings[0].text


def test_readings_before_an_offset_are_preferred(tmp_path: Path, signals: Signals) -> None:
    """Use the part before an offset that stays, which has the right origin, unless it is far shorter."""
    time, angle, position = signals
    position[500:] += 0.05
    assert len(loaded(tmp_path, time, angle, position).time) == 500
    time, angle, position = signals[0], signals[1], simulated()[2].copy()
    position[100:] += 0.05
    assert len(loaded(tmp_path, time, angle, position).time) == len(time) - 100


def test_an_offset_for_a_while_is_left_out(tmp_path: Path, signals: Signals) -> None:
    """Leave out what lies between a jump and the one back, and use all else."""
    time, angle, position = signals
    position[300:500] += 0.05
    recording = loaded(tmp_path, time, angle, position)
    assert codes(recording) == ["jump"]
    np.testing.assert_array_equal(np.flatnonzero(recording.set_aside), np.arange(300, 500))


def test_lost_rows_are_told_by_both_signals(tmp_path: Path, signals: Signals) -> None:
    """Say that rows are lost where angle and position jump together."""
    _, angle, position = signals
    lost = slice(500, 570)
    angle, position = np.delete(angle, lost), np.delete(position, lost)
    recording = loaded(tmp_path, np.arange(len(angle)) / RATE, angle, position)
    assert codes(recording) == ["lost-rows"]
    assert len(recording.time) == len(angle) - 500


def test_steps_that_take_a_while_are_no_jump(tmp_path: Path, signals: Signals) -> None:
    """Leave in what moves within several readings: a worn track, or a ball that was pushed."""
    time, angle, position = signals
    position += 0.05 * np.clip((time - 6.0) / 0.04, 0.0, 1.0)
    assert not len(loaded(tmp_path, time, angle, position).left_out)


def test_a_held_reading_is_no_jump(tmp_path: Path, signals: Signals) -> None:
    """Leave in a sensor that repeats a reading for a fifth of a second and goes on."""
    time, angle, position = signals
    position[600:620] = position[599]
    assert not len(loaded(tmp_path, time, angle, position).left_out)


def test_a_stuck_angle_parts_the_recording(tmp_path: Path, signals: Signals) -> None:
    """Name it by the ball, which goes on, and use the longer part, without the stretch."""
    time, angle, position = signals
    angle[700:820] = angle[699]
    recording = loaded(tmp_path, time, angle, position)
    assert codes(recording) == ["stuck-angle"]
    assert recording.time[-1] < 7.0


def test_a_beam_at_rest_is_no_fault(tmp_path: Path) -> None:
    """Leave in a beam that is held at an angle for seconds and then moved, as in a step response."""
    time = np.arange(1500) / RATE
    angle = np.select([time < 4.0, time < 7.0, time < 11.0], [0.0, 0.03, -0.03], 0.01)
    acceleration = PAPER.gravity * PAPER.rolling_ratio * angle
    velocity = np.cumsum(acceleration) / RATE
    position = 0.3 + np.cumsum(velocity) / RATE + np.random.default_rng(2).normal(0.0, NOISE, len(time))
    assert not len(loaded(tmp_path, time, angle, position).left_out)


@pytest.mark.parametrize("factor", [10.0, 0.1, 3e6])
def test_declared_noise_is_held_against_the_readings(tmp_path: Path, signals: Signals, factor: float) -> None:
    """Name a declared noise that the readings contradict, with what they have."""
    recording = loaded(tmp_path, *signals, noise=factor * NOISE)
    assert codes(recording) == ["position-noise"]
    assert codes(loaded(tmp_path, *signals, noise=2.0 * NOISE)) == []


@pytest.mark.parametrize("factor", [1.2, 1.0 / 1.2])
def test_a_wrong_rate_is_told_by_gravity(tmp_path: Path, signals: Signals, factor: float) -> None:
    """Name times that are too long or too short for a rig whose K and gravity are known; with neither, say nothing."""
    time, angle, position = signals
    recording = loaded(tmp_path, factor * time, angle, position, rig=known_rig_of(PAPER))
    assert codes(recording) == ["rate"]
    assert "1.2" in recording.findings[0].text
    assert codes(loaded(tmp_path, factor * time, angle, position)) == []


def test_a_short_recording_is_not_cut(tmp_path: Path) -> None:
    """Use all of a recording whose parts would be too short to be used alone."""
    time, angle, position = simulated(Cosines(), duration=0.7)
    spoilt = position + 0.05 * (np.arange(len(time)) >= 35)
    assert len(loaded(tmp_path, time, angle, spoilt).time) == len(time)


@pytest.mark.slow
@pytest.mark.parametrize("group", ["recordings", "cases"])
def test_sound_recordings_are_used_whole(shared: Path, group: str) -> None:
    """Leave nothing out of five measured rigs and of simulated cases with effects, and stop none of them."""
    for folder in sorted((shared / group).iterdir()):
        case = load_case(folder)
        assert not any(len(one.left_out) for one in case.recordings.values()), folder.name
        assert not [one for one in case.findings if one.stops or "noise" in one.code], folder.name
