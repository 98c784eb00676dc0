"""Where the ball touches an end stop is told and left out; what a free ball does there is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import Recording, load_recording
from tests.recording.simulated import write
from tests.recording.stopped import RATE, STOP, Run, Stopped, stopped

SEEDS = range(3)
HARD = Run(swing=0.16, speed_gain=0.2)  # overshoots to the stops at every turn


def loaded(folder: Path, made: Stopped) -> Recording:
    """The recording, read from a file."""
    return load_recording(write(folder / "rec.csv", made.columns))


def told(recording: Recording) -> list[str]:
    """What is said of end stops."""
    return [one.text for one in recording.findings if one.code == "end-stop"]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("delay", [0.0, 0.06])
def test_a_ball_that_waits_at_a_stop_is_used_from_where_it_leaves(tmp_path: Path, seed: int, delay: float) -> None:
    """Begin a recording of a ball that lies against a stop where it has left it, and say why."""
    made = stopped(Run(held=2.0, delay=delay), seed=seed)
    recording = loaded(tmp_path, made)
    (text,) = told(recording)
    assert "lies against an end stop at" in text
    assert abs(float(text.split("end stop at ")[1].split()[0])) == pytest.approx(STOP, abs=1.5e-3)  # told in mm
    left = made.time[np.flatnonzero(made.touching)[-1]]
    # It needs √(2 · 0.05 · 0.3 m / 0.5 m/s²) = 0.25 s to be 5 % of its travel away.
    assert left < recording.time[0] < left + 0.5
    assert recording.time[-1] == made.time[-1]
    assert len(recording.left_out) == len(made.time) - len(recording.time)


@pytest.mark.parametrize("seed", SEEDS)
def test_impacts_part_a_recording(tmp_path: Path, seed: int) -> None:
    """Use only the longest part between two impacts, without a reading at a stop."""
    made = stopped(HARD, seed=seed)
    recording = loaded(tmp_path, made)
    (text,) = told(recording)
    assert "bounces from an end stop at" in text
    touched = made.time[made.touching > 0.0]
    assert len(touched) > 5
    assert not np.any((touched >= recording.time[0]) & (touched <= recording.time[-1]))
    free = np.diff(np.concatenate(([0.0], touched, [made.time[-1]])))
    assert recording.time[-1] - recording.time[0] > 0.7 * free.max()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_ball_that_touches_no_stop_is_used_whole(tmp_path: Path, seed: int) -> None:
    """Find no stop where the controller turns the ball, or rests it at an end of its travel."""
    for run in (Run(), Run(damping=0.5, delay=0.06), Run(swing=0.15)):
        made = stopped(run, seed=seed)
        assert not made.touching.any()
        assert not told(loaded(tmp_path, made))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_ball_that_is_held_at_first_is_used_from_where_it_is_let_go(tmp_path: Path, seed: int) -> None:
    """Begin a recording where a hand lets the ball go, which held it on a beam that fell inwards."""
    made = stopped(Run(), seed=seed)
    waiting = np.arange(0.0, 2.0, 1.0 / RATE)
    noise = np.random.default_rng(seed).normal(0.0, 1e-3, len(waiting))
    steep = np.interp(waiting, (0.0, 0.3, 1.9, 2.0), (0.0, -0.1, -0.1, made.angle[0]))
    held = Stopped(
        np.concatenate((waiting, 2.0 + made.time)),
        np.concatenate((steep, made.angle)),
        np.concatenate((made.position[0] + noise, made.position)),
        np.concatenate((0.0 * waiting, made.touching)),
    )
    recording = loaded(tmp_path, held)
    (text,) = told(recording)
    assert "is held by something" in text
    assert 1.9 < recording.time[0] < 2.5


def test_a_ball_that_rolls_fast_at_first_is_not_held(tmp_path: Path) -> None:
    """Use a recording whole in which the first readings are 4 cm apart, so that none is near the middle of them."""
    time = np.arange(0.0, 10.01, 0.05)
    position, angle = 0.3 * np.sin(np.pi * time), -0.2 * np.sin(np.pi * time)
    columns = {"time_s": time, "beam_angle_rad": angle, "ball_position_m": position}
    recording = load_recording(write(tmp_path / "rec.csv", columns))
    assert told(recording) == []
    assert recording.usable.sum() == len(time)


def test_the_angle_of_a_motor_shows_no_stop(tmp_path: Path) -> None:
    """Say nothing where the recorded angle is twenty times the beam's: none of its tilts is known to be steep."""
    made = stopped(Run(held=2.0, linkage=20.0), seed=1)
    assert not told(loaded(tmp_path, made))


def test_a_worn_track_at_an_end_is_no_impact(tmp_path: Path) -> None:
    """Keep a recording whole whose readings jump inwards where the ball turns, and then go on as before."""
    made = stopped(Run(), seed=1)
    farthest = int(np.argmax(made.position))
    spoilt = made.position.copy()
    spoilt[farthest - 5 : farthest] += np.linspace(0.0, 0.05, 5)
    assert not told(loaded(tmp_path, made._replace(position=spoilt)))
