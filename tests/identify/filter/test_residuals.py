"""Jacobians of the normalised innovations: what one recording has of its own is differenced on that one alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.estimate.free_run_fit import _jacobian, _point
from harness.identify.estimate.window_runs import FreeRuns
from harness.identify.filter import residuals as module
from harness.identify.filter.dynamics import Dynamics
from harness.identify.filter.residuals import Residuals
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import fitted_windows
from harness.recording import load_case
from harness.simulator import Experiment, write_case

RECORDINGS, PROCESS_NOISE, STEP = 4, 1e-6, 1e-2
# A level and a phase for each recording, beside what all share.
HYPOTHESIS = Hypothesis(("viscous_damping", "level_per_recording", "ball_imbalance"))


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Recordings of 8 s."""
    path: Path = tmp_path_factory.mktemp("residuals") / "case"
    write_case(path, Experiment(duration=8.0, identify=RECORDINGS, predict=0, seed=12))
    return problem_of(load_case(path))


@pytest.fixture
def theta(problem: Problem) -> FloatArray:
    """Scaled parameters, none of them 0 and no two recordings alike."""
    return np.linspace(0.2, 0.9, HYPOTHESIS.size(problem))


def test_columns_of_a_jacobian_are_differences_of_all_residuals(problem: Problem, theta: FloatArray) -> None:
    """Give the differences that running all recordings for every parameter gives."""
    residuals = Residuals(problem, HYPOTHESIS, PROCESS_NOISE)
    moves = STEP * np.eye(len(theta))
    plain = [(residuals.at(theta + move) - residuals.at(theta)) / STEP for move in moves]
    np.testing.assert_array_equal(residuals.jacobian(theta, STEP), np.column_stack(plain))
    both = [(residuals.at(theta + move) - residuals.at(theta - move)) / (2.0 * STEP) for move in moves]
    # (θ + h) − (θ − h) rounds to 2 h within some 1e-16, a relative 1e-14.
    over = residuals.jacobian_over(theta, np.full(len(theta), STEP))
    np.testing.assert_allclose(over, np.column_stack(both), rtol=1e-12, atol=1e-12)


def test_a_step_to_where_the_filter_diverges_tells_no_slope(
    problem: Problem, theta: FloatArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Give a parameter whose difference is not a number a column of zeros, and the others theirs."""
    residuals = Residuals(problem, HYPOTHESIS, PROCESS_NOISE)
    plain = residuals.jacobian(theta, STEP)
    rise = residuals._rise

    def diverging(start: FloatArray, end: FloatArray, number: int, here: FloatArray | None = None) -> FloatArray:
        return np.full(len(plain), np.nan) if number == 1 else rise(start, end, number, here)

    monkeypatch.setattr(residuals, "_rise", diverging)
    slopes = residuals.jacobian(theta, STEP)
    assert not np.any(slopes[:, 1])
    np.testing.assert_array_equal(np.delete(slopes, 1, axis=1), np.delete(plain, 1, axis=1))


def test_work_of_a_jacobian_grows_with_the_number_of_recordings(
    problem: Problem, theta: FloatArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Run each recording once for each parameter that all share, and once for each of its own two."""
    runs: list[str] = []
    original = module.innovations_of

    def counting(model: Dynamics, one: PreparedRecording, process_noise: float) -> tuple[FloatArray, FloatArray]:
        runs.append(one.name)
        return original(model, one, process_noise)

    monkeypatch.setattr(module, "innovations_of", counting)
    residuals = Residuals(problem, HYPOTHESIS, PROCESS_NOISE)
    residuals.jacobian(theta, STEP)
    assert sorted(runs) == sorted(2 * [one.name for one in problem.recordings])


def test_columns_of_a_jacobian_of_free_runs_are_differences_of_all_runs(problem: Problem, theta: FloatArray) -> None:
    """Give the differences that running the windows of all recordings for every parameter gives."""
    runs = FreeRuns(problem, fitted_windows(problem.recordings))
    point = _point(runs, HYPOTHESIS, theta, runs.first_starts())
    here = runs.runs(HYPOTHESIS.terms(theta, problem), point.starts)
    moved = [runs.runs(HYPOTHESIS.terms(theta + move, problem), point.starts) for move in STEP * np.eye(len(theta))]
    plain = np.column_stack([(run - here) / STEP for run in moved])
    # Runs of a few metres are rounded by 1e-16 each, in differences over 1e-2.
    np.testing.assert_allclose(_jacobian(runs, HYPOTHESIS, point, STEP), plain, rtol=0.0, atol=1e-13)
