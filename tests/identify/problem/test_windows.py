"""Blocks of recordings that are held out together, and what models may be fitted to meanwhile."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.identify.problem.problem import PreparedRecording
from harness.identify.problem.windows import AHEAD, KNOWN, blocks_of, fitted_windows
from tests.posed import pose


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> tuple[PreparedRecording, ...]:
    """Two recordings of 16 s."""
    folder: Path = tmp_path_factory.mktemp("blocks")
    return pose(folder / "case", 0).problem.recordings


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
