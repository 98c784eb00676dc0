"""Blocks of recordings that are held out together, and what models may be fitted to meanwhile."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from analytic.rig import Rig
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import AHEAD, KNOWN, blocks_of, fitted_windows, folds
from harness.signals.drive import make_drive
from tests.posed import pose


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Two recordings of 16 s."""
    folder: Path = tmp_path_factory.mktemp("blocks")
    return pose(folder / "case", 0).problem


@pytest.fixture(scope="module")
def recordings(problem: Problem) -> tuple[PreparedRecording, ...]:
    """Both of them."""
    return problem.recordings


def test_no_fit_sees_a_reading_that_it_has_to_predict(recordings: tuple[PreparedRecording, ...]) -> None:
    """Leave out of every fit all windows with readings of the predicted parts of its blocks."""
    blocks = blocks_of(recordings)
    for block in blocks:
        for other in (one for one in blocks if one.group == block.group):
            for held in other.held_out:
                for window in block.fitted:
                    begin, end = held.begin + KNOWN, held.begin + KNOWN + AHEAD
                    apart = window.begin >= end - 1e-9 or window.begin + KNOWN + AHEAD <= begin + 1e-9
                    assert window.recording is not held.recording or apart


def test_blocks_cover_the_recordings(recordings: tuple[PreparedRecording, ...]) -> None:
    """Predict every window that begins at a full second, in blocks of three that begin within 3 s."""
    blocks = blocks_of(recordings)
    begins = [window.begin for block in blocks for window in block.held_out if window.recording is recordings[0]]
    assert begins == pytest.approx([float(second) for second in range(12)])  # the last one of 5 s begins at 11 s
    assert {len(block.held_out) for block in blocks} == {3}
    assert {block.group for block in blocks} == set(range(6))


def test_a_short_recording_has_no_blocks(recordings: tuple[PreparedRecording, ...]) -> None:
    """Hold out nothing where too little is left to fit."""
    one = recordings[0]
    short = PreparedRecording(one.name, one.time[:750], one.reading[:750], one.drive)  # 7.5 s: two windows to fit
    assert len(fitted_windows((short,))) == 2
    assert blocks_of((short,)) == ()


@pytest.mark.parametrize(("count", "of_a_fold"), [(2, {1}), (6, {1}), (8, {1, 2}), (25, {4, 5})])
def test_every_recording_is_held_out_once_in_few_folds(problem: Problem, count: int, of_a_fold: set[int]) -> None:
    """Hold out one at a time of few recordings, and groups of many, each predicted by a fit to all others."""
    many = tuple(replace(problem.recordings[0], name=f"{number}") for number in range(count))
    made = folds(replace(problem, recordings=many))
    assert len(made) == min(count, 6)
    assert {len(fold.left) for fold in made} == of_a_fold
    assert sorted(int(one.name) for fold in made for one in fold.left) == list(range(count))
    for fold in made:
        assert {one.name for one in (*fold.left, *fold.problem.recordings)} == {one.name for one in many}
        assert len(fold.left) + len(fold.problem.recordings) == count


def test_a_recording_shorter_than_the_span_of_the_floor_has_one(recordings: tuple[PreparedRecording, ...]) -> None:
    """Estimate the input-noise floor of 0.3 s of angles as a number that no motion has."""
    one = recordings[0]
    drive = make_drive(one.drive.time[:30], one.drive.states[:30, 0])
    short = PreparedRecording(one.name, one.time[:30], one.reading[:30], drive)
    assert 0.0 < Problem((short,), Rig(), (), 1e-8).angle_floor < 1e-2
