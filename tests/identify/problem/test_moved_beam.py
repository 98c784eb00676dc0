"""The table of a beam that effects move: made once for the same values, and anew for others."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import acting, motion_with
from analytic.kernel import Grid
from analytic.motion import BeamMotion, DelayedMotion, FloatArray, ScaledMotion
from harness.identify.pose import problem_of
from harness.identify.problem.problem import Moving, PreparedRecording
from harness.recording import load_case
from harness.simulator import Experiment, write_case


def by(*effects: tuple[str, str, float]) -> Moving:
    """What effects do, by name, parameter and value."""
    return Moving.by([acting(name, {parameter: value}) for name, parameter, value in effects])


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
    lagging = recording.moved_table(by(LAG))
    assert recording.moved_table(by(LAG, DAMPING)) is lagging
    assert len(tabulated) == 1
    later, delayed = recording.moved_table(by(LATER)), recording.moved_table(by(LAG, DELAY))
    assert len(tabulated) == 3
    assert not any(np.array_equal(one, lagging) for one in (later, delayed))
    assert recording.moved_table(by(DAMPING)) is recording.table
    for moving, table in ((by(LAG), lagging), (by(LATER), later), (by(LAG, DELAY), delayed)):
        alone = PreparedRecording(recording.name, recording.time, recording.reading, recording.drive)
        np.testing.assert_array_equal(alone.moved_table(moving), table)


@pytest.mark.parametrize("beside", [(), (DELAY,), (LAG, DELAY)])
def test_a_gain_changes_the_scale_of_a_table_alone(
    recording: PreparedRecording, beside: tuple[tuple[str, str, float], ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tabulate once for all gains of an angle, and give what tabulating the multiplied motion gives, to rounding."""
    moved = [recording.moved_table(by(("angle_gain", "gain", gain), *beside)) for gain in (0.9, 1.1)]
    np.testing.assert_allclose(moved[1], 1.1 / 0.9 * moved[0], rtol=1e-14, atol=1e-15)
    motion = motion_with(ScaledMotion(recording.drive, 0.9), recording.drive.time, by(*beside).effects)
    delay = by(*beside).delay
    ends = float(recording.drive.time[0]), float(recording.drive.time[-1])
    alone = recording.grid.tabulate(DelayedMotion(motion, delay, *ends) if delay else motion)
    np.testing.assert_allclose(moved[0], alone, rtol=1e-13, atol=1e-13)
    monkeypatch.setattr(Grid, "tabulate", lambda *_: pytest.fail("the beam is tabulated once more"))
    recording.moved_table(by(("angle_gain", "gain", 1.3), *beside))


@pytest.mark.parametrize(
    ("name", "values"), [("angle_nonlinearity", {"square": 1.0, "cube": 0.0}), ("linkage_backlash", {"width": 0.01})]
)
def test_a_gain_stays_before_what_is_not_linear(
    recording: PreparedRecording, name: str, values: dict[str, float]
) -> None:
    """Bend, or move in its gap, the multiplied angle: that is no multiple of the bent one."""
    gain, other = acting("angle_gain", {"gain": 0.9}), acting(name, values)
    there = recording.moved_table(Moving.by([gain, other]))
    alone = recording.moved_table(Moving.by([other]))
    assert np.max(np.abs(there[:, 0] - 0.9 * alone[:, 0])) > 1e-5  # a tenth of what the curve or the gap changes
    bent = motion_with(recording.drive, recording.drive.time, [gain, other])
    np.testing.assert_array_equal(there, recording.grid.tabulate(bent))


def test_a_recording_travels_to_another_process_after_its_use(recording: PreparedRecording) -> None:
    """Unpickle what was computed with, and compute the same."""
    lagging = recording.moved_table(by(LAG))
    elsewhere = pickle.loads(pickle.dumps(recording))
    np.testing.assert_array_equal(elsewhere.moved_table(by(LAG)), lagging)
