"""A command that is computed from the reading of its own row is told from a measured angle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.recording import Recording, load_case, load_recording
from harness.recording.commanded import answers_readings
from tests.recording.hand_turned import Hand, write_hand_turned
from tests.recording.simulated import write
from tests.recording.stopped import Run, stopped


def recorded(folder: Path, run: Run, seed: int) -> Recording:
    """What is read of a run of the plant."""
    return load_recording(write(folder / "rec_01.csv", stopped(run, seed=seed).columns))


@pytest.mark.parametrize("noise", [3e-4, 3e-3])
@pytest.mark.parametrize("seed", range(3))
def test_a_command_answers_the_reading_of_its_row(tmp_path: Path, noise: float, seed: int) -> None:
    """Tell a command by what it has of the reading's noise, and a measured angle by its having none."""
    command = Run(swing=0.05, noise=noise, commanded=True)
    assert answers_readings([recorded(tmp_path, command, seed)])
    assert not answers_readings([recorded(tmp_path, replace(command, commanded=False), seed)])


def test_a_command_that_is_logged_a_row_late_does_not(tmp_path: Path) -> None:
    """Take a command that answers the row before for an angle, which acts after that row in any case."""
    made = stopped(Run(swing=0.05, noise=1e-3, commanded=True), seed=1)
    late = {**made.columns, "beam_angle_rad": np.append(made.angle[0], made.angle[:-1])}
    assert not answers_readings([load_recording(write(tmp_path / "rec_01.csv", late))])


def test_few_rows_tell_nothing(tmp_path: Path) -> None:
    """Say no where there is not enough to say anything: of no recording, of a short one, of a beam that rests."""
    made = stopped(Run(commanded=True), seed=1).columns
    short = {name: values[:60] for name, values in made.items()}
    still = {**made, "beam_angle_rad": np.zeros(len(made["time_s"]))}
    assert not answers_readings([])
    assert not answers_readings([load_recording(write(tmp_path / "short.csv", short))])
    assert not answers_readings([load_recording(write(tmp_path / "still.csv", still))])


@pytest.mark.slow
def test_what_is_known_of_the_shared_rigs_is_told(shared: Path) -> None:
    """Name the two measured rigs of which a command is recorded, and none whose angle is measured or simulated."""
    rigs = {one.name: load_case(one) for group in ("cases", "recordings") for one in sorted((shared / group).iterdir())}
    told = {name for name, case in rigs.items() if answers_readings(case.recordings.values())}
    assert told == {"open_ball_beam", "ping_pong"}


@pytest.mark.parametrize("seed", range(3))
def test_a_beam_that_turns_far_between_its_readings_is_no_command(tmp_path: Path, seed: int) -> None:
    """Its ball answers at once, too, but by the lever of the beam's acceleration, and by no more."""
    case = load_case(write_hand_turned(tmp_path / "case", Hand(corner=3.0, size=0.1, rate=8.0), seed))
    assert not answers_readings(case.recordings.values())
