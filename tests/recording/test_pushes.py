"""Where the ball was pushed is told, and the parts between are used as recordings of their own."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from harness.recording import Recording, load_case, load_recording
from harness.recording.parts import Break, parts_between
from harness.recording.pushes import pushes
from tests.recording.simulated import write
from tests.recording.stopped import Run, Stopped, stopped

SEEDS = range(3)
PUSHES = {5.2: 0.3, 11.2: -0.3}  # [m/s], by their times [s]


def written(folder: Path, made: Stopped, name: str = "rec_01.csv") -> Path:
    """The recording, in a file of the folder."""
    return write(folder / name, made.columns)


def told(recording: Recording) -> list[str]:
    """What is said of pushes and end stops."""
    return [one.text for one in recording.findings if one.code in {"push", "end-stop"}]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("delay", [0.0, 0.1])
def test_every_push_is_found_with_its_size(tmp_path: Path, seed: int, delay: float) -> None:
    """Name each push by its time and size, also where the position is late, and leave out readings about it only."""
    made = stopped(Run(swing=0.05, damping=0.35, delay=delay, pushes=PUSHES), seed=seed)
    assert not made.touching.any()
    recording = load_recording(written(tmp_path, made))
    (text,) = told(recording)
    sizes = [float(each.split()[0]) for each in text.split("by ")[1:]]
    # The noise of 1 mm in lines of 8 readings, 20 ms apart, gives a change of slope a standard error of 11 mm/s: five.
    np.testing.assert_allclose(sizes, list(PUSHES.values()), atol=0.06)
    out = recording.left_out[:, 0]
    for when in PUSHES:
        assert np.any(np.abs(out - when) < 0.05)
    assert all(min(abs(when - each) for each in PUSHES) < 0.2 for when in out)


def test_parts_are_recordings_of_the_case(tmp_path: Path) -> None:
    """Use the longest part under the file's name and the others beside it, in order, each reading once."""
    made = stopped(Run(pushes=PUSHES), seed=1)
    written(tmp_path, made)
    case = load_case(tmp_path)
    assert case.identify == tuple(case.recordings)
    assert case.identify[0] == "rec_01.csv"
    assert len(case.identify) == len(PUSHES) + 1
    assert all(name == one.name for name, one in case.recordings.items())
    further = [case.recordings[name].time for name in case.identify[1:]]
    assert all(part[-1] < after[0] for part, after in pairwise(further))
    stamps = np.concatenate([one.time for one in case.recordings.values()])
    left_out = np.concatenate([one.left_out for one in case.recordings.values()])[:, 0]
    np.testing.assert_array_equal(np.sort(np.concatenate((stamps, left_out))), made.time)
    assert not any(one.code == "duplicate" for one in case.findings)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("run", [Run(), Run(swing=0.05, damping=0.5, delay=0.2), Run(swing=0.15, noise=3e-3)], ids=str)
def test_a_ball_that_nobody_pushes_is_used_whole(tmp_path: Path, seed: int, run: Run) -> None:
    """Find no push where the beam alone moves the ball, whatever the delay and the noise."""
    made = stopped(run, seed=seed)
    assert not made.touching.any()
    recording = load_recording(written(tmp_path, made))
    assert not told(recording)
    assert not recording.further


def test_a_reading_that_jumps_is_no_push(tmp_path: Path) -> None:
    """Keep a recording whole in which a worn track shifts the readings within 60 ms: the ball is as slow as before."""
    made = stopped(Run(), seed=1)
    spoilt = made.position + 0.04 * np.clip((made.time - 5.2) / 0.06, 0.0, 1.0)
    assert not told(load_recording(written(tmp_path, made._replace(position=spoilt))))


def test_a_ball_that_a_steep_place_throws_back_is_used_whole(tmp_path: Path) -> None:
    """Keep what a law of the position does, though the velocity turns at once: it goes back as fast as it came."""
    time = np.arange(1400) / 100.0
    swing = 0.02 * np.sin(2.1 * time)
    position = np.abs(0.12 * np.sin(2.1 * time + 0.4)) + np.random.default_rng(1).normal(0.0, 5e-4, len(time))
    columns = {"time_s": time, "beam_angle_rad": swing, "ball_position_m": position}
    assert not any(one.code == "push" for one in load_recording(write(tmp_path / "rec.csv", columns)).findings)


def test_overlapping_breaks_are_one() -> None:
    """Join breaks that overlap, and leave their readings out of every part."""
    time, usable = np.arange(600) / 100.0, np.ones(600, dtype=np.bool_)
    breaks = [Break(210, 260), Break(250, 255), Break(255, 300)]
    assert parts_between(breaks, time, usable) == (slice(300, 600), slice(0, 210))


def test_parts_of_another_origin_are_not_used_together() -> None:
    """Leave out what lies behind an offset that stays, and what is too short to tell anything."""
    time, usable = np.arange(1500) / 100.0, np.ones(1500, dtype=np.bool_)
    breaks = [Break(600, 600, shifts=True), Break(300, 310), Break(450, 520), Break(900, 910)]
    assert parts_between(breaks, time, usable) == (slice(0, 300),)
    longer = [Break(600, 600, shifts=True), Break(300, 310), Break(470, 520), Break(900, 910)]
    assert parts_between(longer, time, usable) == (slice(0, 300), slice(310, 470))
    assert parts_between([Break(290, 310), Break(590, 600)], time, usable) == (
        slice(600, 1500),
        slice(0, 290),
        slice(310, 590),
    )


@pytest.mark.parametrize("seed", range(10))
def test_a_command_that_answers_noisy_readings_pushes_nothing(tmp_path: Path, seed: int) -> None:
    """Find nothing where the recorded angle is a command, which answers the noise of the recorded positions.

    The noise then moves command and reading alike, as though the beam's turning threw the ball.
    """
    made = stopped(Run(swing=0.06, delay=0.06, noise=3e-3, commanded=True), seed=seed)
    assert not made.touching.any()
    assert told(load_recording(written(tmp_path, made))) == []


def test_stamps_in_bursts_tell_of_no_push() -> None:
    """Find none where stamps are so close in bursts that all readings are averaged to one."""
    time = np.repeat(0.3 * np.arange(50), 3) + np.tile([0.0, 1e-4, 2e-4], 50)
    position, usable = 0.3 + 0.05 * np.sin(time), np.ones(time.size, dtype=bool)
    assert pushes(time, 0.05 * np.sin(time), position, usable, gravity=9.81) == ()
    assert pushes(time, 0.05 * np.sin(time), position, ~usable, gravity=9.81) == ()
