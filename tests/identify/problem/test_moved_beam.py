"""The table of a beam that effects move: made once for the same values, and anew for others."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import Acting, acting
from analytic.kernel import Grid
from analytic.motion import BeamMotion, FloatArray
from harness.identify.pose import problem_of
from harness.identify.problem.problem import PreparedRecording
from harness.recording import load_case
from harness.simulator import Experiment, write_case


def of(*effects: tuple[str, str, float]) -> list[Acting]:
    """Effects by name, parameter and value."""
    return [acting(name, {parameter: value}) for name, parameter, value in effects]


LAG, DAMPING = ("angle_lag", "time_constant", 0.1), ("viscous_damping", "coefficient", 0.01)
LATER, DELAY = ("angle_lag", "time_constant", 0.2), ("channel_delay", "delay", 0.05)


@pytest.fixture
def recording(tmp_path: Path) -> PreparedRecording:
    """One of 5 s."""
    write_case(tmp_path / "case", Experiment(duration=5.0, identify=1, predict=0, seed=5))
    return problem_of(load_case(tmp_path / "case")).recordings[0]


def test_the_beam_is_tabulated_once_for_what_moves_it(
    recording: PreparedRecording, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tabulate anew for another lag or delay, not for a force beside it; give what a new recording would."""
    tabulated: list[BeamMotion] = []
    original = Grid.tabulate

    def counting(grid: Grid, motion: BeamMotion) -> FloatArray:
        tabulated.append(motion)
        return original(grid, motion)

    monkeypatch.setattr(Grid, "tabulate", counting)
    lagging = recording.table_with(of(LAG))
    assert recording.table_with(of(LAG, DAMPING)) is lagging
    assert len(tabulated) == 1
    later, delayed = recording.table_with(of(LATER)), recording.table_with(of(LAG, DELAY))
    assert len(tabulated) == 3
    assert not any(np.array_equal(one, lagging) for one in (later, delayed))
    assert recording.table_with(of(DAMPING)) is recording.table
    for effects, table in ((of(LAG), lagging), (of(LATER), later), (of(LAG, DELAY), delayed)):
        alone = PreparedRecording(recording.name, recording.time, recording.reading, recording.drive)
        np.testing.assert_array_equal(alone.table_with(effects), table)


def test_a_recording_travels_to_another_process_after_its_use(recording: PreparedRecording) -> None:
    """Unpickle what was computed with, and compute the same."""
    lagging = recording.table_with(of(LAG))
    elsewhere = pickle.loads(pickle.dumps(recording))
    np.testing.assert_array_equal(elsewhere.table_with(of(LAG)), lagging)
