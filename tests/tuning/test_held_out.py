"""Errors of a tuned engine on held-out blocks, and what is not tuned because it predicts them no better."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.engines.catalogue import engine_of
from harness.errors import EngineFailure
from harness.identify.estimate.block_errors import block_errors
from harness.identify.estimate.fit import fit as fit_cam
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import AHEAD, KNOWN, blocks_of
from harness.numerics import rms
from harness.recording import load_case
from harness.tuning.estimate.fit import fit, run_through
from harness.tuning.estimate.free import LEVEL, level_of
from harness.tuning.estimate.runs import Model
from harness.tuning.estimate.selection import Selection
from harness.tuning.estimate.windows import fitted_stretches, stretches_of
from harness.tuning.held_out import HeldOutErrors, held_out_errors
from harness.tuning.tune import Tuned, Verdict, _predicting, tune
from tests.posed import pose

SETTINGS = {"time_step": 4e-3}  # twice that of the defaults: its error of some micrometres is far below the noise


def tuned(problem: Problem, *names: str) -> Tuned:
    """MuJoCo, tuned with these parameters free."""
    return tune(problem, engine_of("mujoco"), SETTINGS, names)


@pytest.fixture(scope="module")
def complete(tmp_path_factory: pytest.TempPathFactory) -> Tuned:
    """A friction that nothing needs, on a rig whose model lacks nothing."""
    return tuned(pose(tmp_path_factory.mktemp("complete") / "case", 3).problem, "friction")


@pytest.mark.slow
def test_a_complete_engine_predicts_held_out_blocks_as_well_as_cam(complete: Tuned) -> None:
    """Err by no more than half as much again: both begin at a start fitted to the known seconds."""
    made, problem = complete, complete.model.problem
    assert made.verdict is Verdict.NOTHING
    assert made.held_out is not None
    cam = block_errors(problem, fit_cam(problem, Hypothesis(())))
    assert rms(made.held_out.before) < 1.5 * rms(cam[list(made.held_out.blocks)])


@pytest.mark.slow
def test_nothing_is_tuned_that_predicts_held_out_blocks_no_better(tmp_path: Path) -> None:
    """Say that physics is missing where a damping is, though the level or a friction follows some of its colour."""
    problem = pose(tmp_path / "case", 4, {"viscous_damping": {"coefficient": 0.05}}).problem
    made = tuned(problem, "friction_across", "friction")
    assert made.verdict is Verdict.PHYSICS
    assert made.settings == SETTINGS
    assert made.scene == {}
    assert made.held_out is not None
    np.testing.assert_array_equal(made.held_out.before, made.held_out.after)


@pytest.fixture(scope="module")
def lifting() -> Model:
    """MuJoCo on the bundled measured rig, whose commanded angle throws the ball off now and then."""
    problem = problem_of(load_case("open_ball_beam"))
    return Model(engine_of("mujoco"), problem, SETTINGS, {LEVEL: level_of(problem.rig)})


@pytest.mark.slow
def test_windows_in_which_the_ball_lifts_off_are_left_out(lifting: Model) -> None:
    """Keep the other one."""
    windows = stretches_of(lifting.problem, lifting.problem.recordings[0], [(0.0, 4.5), (0.0, 9.0)])
    kept, failures = run_through(lifting, windows, {LEVEL: 0.0})
    assert [one.time[-1] for one in kept] == [windows[0].time[-1]]
    (failure,) = failures
    assert failure.of_the_rig


@pytest.mark.slow
def test_blocks_in_which_the_ball_lifts_off_are_left_out_and_counted(lifting: Model) -> None:
    """Keep the blocks that the engine runs through, and no error of a run that ended."""
    windows = stretches_of(lifting.problem, lifting.problem.recordings[0], [(0.0, 4.5)])
    before = fit(lifting, windows, [], {}, fixed={LEVEL: 0.0})
    found = held_out_errors(lifting, windows, Selection(before, before, {}, (), ()))
    assert found is not None
    assert found.left_out > 0
    assert len(found.blocks) + found.left_out == len(blocks_of(lifting.problem.recordings))
    assert np.isfinite(np.concatenate([one.before for one in found.predicted])).all()


@pytest.mark.slow
def test_a_rig_that_no_engine_runs_on_is_told_with_what_to_do(lifting: Model) -> None:
    """Name the recordings, and point to what needs no engine."""
    with pytest.raises(EngineFailure, match=r"lifts off.*every window of rec_01\.csv.*harness diagnose"):
        tune(lifting.problem, lifting.engine, SETTINGS, ["friction"])


@pytest.mark.slow
def test_what_predicts_no_better_is_told_with_its_errors(complete: Tuned) -> None:
    """Reject it where the model is incomplete, and keep it where the model is complete, whatever few blocks say."""
    made = complete
    assert made.held_out is not None
    paying = replace(made.selection, pays=("friction",))
    worse = replace(made.held_out, after=2.0 * made.held_out.before)
    assert _predicting(paying, worse) == (paying, worse, None)
    lacking = replace(paying, found=replace(paying.found, residual=10.0 * paying.found.residual))
    selection, held_out, rejected = _predicting(lacking, worse)
    assert selection.pays == ()
    assert rejected is not None
    assert (rejected.names, rejected.after) == (("friction",), 2.0 * rejected.before)
    assert held_out is not None
    np.testing.assert_array_equal(held_out.before, held_out.after)


def with_readings(model: Model, readings: FloatArray) -> Model:
    """The same with other readings of the first recording, shape (n,) [m]."""
    first, *others = model.problem.recordings
    return replace(model, problem=replace(model.problem, recordings=(replace(first, reading=readings), *others)))


def untuned(model: Model) -> HeldOutErrors:
    """Errors of the engine as it is."""
    windows = fitted_stretches(model.problem)
    before = fit(model, windows, [], {}, fixed={LEVEL: 0.0})
    found = held_out_errors(model, windows, Selection(before, before, {}, (), ()))
    assert found is not None
    return found


@pytest.mark.slow
def test_what_is_predicted_is_not_used_where_a_window_begins_without_readings(complete: Tuned) -> None:
    """Begin the same runs whatever is read behind the known 2 s, though the first second of these has no readings."""
    recording = complete.model.problem.recordings[0]
    time = recording.time - recording.time[0]
    into = time % AHEAD  # blocks begin one after the other
    missing = np.where(into < 1.0, np.nan, recording.reading)
    moved = np.where((into >= KNOWN) & (into < KNOWN + 0.9), missing + 5e-3, missing)
    first, other = (untuned(with_readings(complete.model, readings)).predicted for readings in (missing, moved))
    assert len(first) == len(other) > 2
    for one, same in zip(first, other, strict=True):
        # The windows of a block are fitted together, those that hold the moved readings too, up to a tolerance.
        np.testing.assert_allclose(one.before, same.before, rtol=0.0, atol=1e-5)


@pytest.mark.slow
def test_a_block_of_too_few_readings_is_left_out_and_counted(complete: Tuned) -> None:
    """Keep the errors of the others."""
    recording = complete.model.problem.recordings[0]
    time = recording.time - recording.time[0]
    few = np.arange(len(time)) % 48 == 0  # 0.48 s apart: five in 2 s and eleven in 5 s at most
    readings = np.where((time > 5.0) & ~few, np.nan, recording.reading)
    model = with_readings(complete.model, readings)
    found = untuned(model)
    assert found.left_out > 0
    assert len(found.blocks) + found.left_out == len(blocks_of(model.problem.recordings))
