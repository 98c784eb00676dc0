"""Runs of a ball that is let go and rolls to the other end: what one tells of the rig, the others are told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from harness.recording import Case, load_case
from harness.recording.end_stops import Stops, common_stops
from tests.recording.released import COUNT, Release, released

TILTS = (0.05, 0.06, 0.07, 0.08, 0.09, 0.1)
SEEDS = range(3)


def codes(case: Case) -> set[str]:
    """Codes of all warnings."""
    return {one.code for one in case.findings if one.severity == "warning"}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_delay_is_no_wrong_rate(tmp_path: Path, seed: int) -> None:
    """Do not call a sampling rate wrong where the position of a ball that is let go is late by 70 ms."""
    runs = [Release(tilt=tilt, delay=0.07) for tilt in TILTS]
    assert codes(load_case(released(tmp_path, runs, rate=200, seed=seed))) == set()


@pytest.mark.parametrize("seed", SEEDS)
def test_a_stop_of_one_run_is_one_of_all(tmp_path: Path, seed: int) -> None:
    """Use no reading of a ball that leans on a stop under 2°, as friction may hold it too, if others bounce there."""
    runs = [Release(begin=0.4, lean=0.035, wait=1.0, tilt=tilt, bounces=True) for tilt in TILTS]
    case = load_case(released(tmp_path / "all", runs, rate=100, seed=seed))
    assert codes(case) == {"end-stop"}
    for one in case.recordings.values():
        # A contact takes what is within a hundredth of the travel of 0.8 m; what only comes near may stay.
        assert np.max(np.abs(one.position[one.usable])) < 0.4 - 0.01 * 0.8
    (alone,) = load_case(released(tmp_path / "one", runs[:1], rate=100, seed=seed)).recordings.values()
    assert alone.time[0] == 0.0


def test_one_recording_or_two_that_differ_tell_no_stop() -> None:
    """Share a stop that two recordings agree on, the outermost of both places, and no other."""
    assert common_stops([Stops(-0.39, 0.4), Stops(-0.4, None)]) == Stops(-0.4, None)
    assert common_stops([Stops(0.0, 0.4), Stops(None, 0.2)]) == Stops()


def test_a_beam_that_stands_still_is_read_by_the_encoder_of_the_others(tmp_path: Path) -> None:
    """Take the encoder's count from a recording in which the beam turns, where another has one angle throughout."""
    still = Release(begin=0.3, lean=-0.05, tilt=0.05, wait=0.0, duration=1.5)
    case = load_case(released(tmp_path, [Release(), still]))
    _, second = case.recordings.values()
    assert len(np.unique(second.angle)) == 1
    assert second.angle_step == pytest.approx(COUNT, rel=1e-3)


def test_a_part_is_read_by_the_encoder_of_its_file(tmp_path: Path) -> None:
    """Take the encoder's count from the whole file, where the part that is used has too few angles to tell it."""
    runs = [Release(begin=0.4, lean=0.06, wait=1.0, tilt=0.05, bounces=True, duration=5.0)]
    (one, *_) = load_case(released(tmp_path, runs)).recordings.values()
    assert len(np.unique(one.angle)) < 4
    assert one.angle_step == pytest.approx(COUNT, rel=1e-3)


def test_short_parts_are_used_where_all_are_short(tmp_path: Path) -> None:
    """Use the ball's way back from a stop, of 1.2 s, beside its way there, of less than 2 s."""
    runs = [Release(begin=0.4, lean=0.06, wait=1.0, tilt=0.08, bounces=True, duration=5.0)]
    case = load_case(released(tmp_path, runs))
    assert len(case.identify) > 1
    lengths = [np.ptp(one.time) for one in case.recordings.values()]
    assert max(lengths) < 2.0
    assert min(lengths) >= 0.5 * max(lengths)
