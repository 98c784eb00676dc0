"""A beam that rests on the same encoder count again has the same error again, and intervals know it."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from harness.identify.estimate.covariance import interval_jacobian, with_interval_covariance
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.screening import information_inverse
from harness.identify.estimate.shared_rounding import shared_rounding
from harness.identify.filter.residuals import Residuals
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from tests.posed import Posed, pose

# The controller of `plain` turns the beam to ±3° three times each, which is ±333 counts and a third.


def widened(problem: Problem, found: Fit) -> float:
    """Standard error with shared rounding over that with independent rests, of the one parameter fitted."""
    jacobian = interval_jacobian(problem, found)
    independent = information_inverse(problem, found.hypothesis, jacobian)
    return math.sqrt(1.0 + float(shared_rounding(problem, found, jacobian, independent)[0, 0] / independent[0, 0]))


def test_rests_at_both_stops_widen_a_gain_and_no_delay(plain: Posed) -> None:
    """Opposite errors at opposite stops look like a gain of the angle; nothing of them looks like a delay."""
    fits = (fit(plain.problem, Hypothesis((name,))) for name in ("angle_gain", "channel_delay"))
    gain, delay = (widened(plain.problem, found) for found in fits)
    # Three equal errors in place of three independent ones triple the variance that comes from the rests. A standard
    # error that comes from them by a half then grows by √2; to ask for 1.3 leaves room for what moves give.
    assert gain > 1.3
    assert delay < 1.1


def test_the_estimate_moves_as_the_response_says(plain: Posed) -> None:
    """Fit again with the beam turned at all its rests at one stop: the gain moves by what was computed."""
    problem = plain.problem
    found = fit(problem, Hypothesis(("angle_gain",)))
    recording, *others = problem.recordings
    drive, resolution = recording.drive, recording.drive.sensor.resolution
    counts, resting = np.rint(drive.states[:, 0] / resolution), drive.std[:, 0] > 0.2 * resolution
    moved = []
    for stop in (-333, 333):
        turned = drive.states.copy()
        turned[(counts == stop) & resting, 0] += resolution / math.sqrt(12.0)
        there = replace(problem, recordings=(replace(recording, drive=replace(drive, states=turned)), *others))
        residuals = Residuals(there, found.hypothesis, found.process_noise)
        moved.append(float(least_squares(residuals.at, found.theta, diff_step=1e-3).x[0] - found.theta[0]))
    jacobian = interval_jacobian(problem, found)
    independent = information_inverse(problem, found.hypothesis, jacobian)
    added = shared_rounding(problem, found, jacobian, independent)[0, 0] / found.hypothesis.scale(problem)[0] ** 2
    # Three equal responses: the square of their sum, less the sum of their squares times 0.69, the variance that the
    # drive states over that of a uniform error: 1 − 0.69/3 = 0.77. Unequal ones leave less, of these at least 0.7.
    assert 0.7 < added / sum(one**2 for one in moved) < 0.8


def test_an_angle_without_rounding_adds_nothing(tmp_path: Path) -> None:
    """Noise of a count dithers the rounding: its errors are new in each reading."""
    write_case(tmp_path / "case", Experiment(angle_noise=2.0 * math.pi / 40_000, predict=0, identify=1))
    problem = problem_of(load_case(tmp_path / "case"))
    found = fit(problem, Hypothesis(("angle_gain",)))
    jacobian = interval_jacobian(problem, found)
    assert not shared_rounding(problem, found, jacobian, found.covariance).any()


def test_nothing_gets_narrower(tmp_path: Path) -> None:
    """Add a positive semidefinite matrix, whatever is fitted together."""
    problem = pose(tmp_path / "case", 5).problem
    found = fit(problem, Hypothesis(("angle_gain", "level_error", "viscous_damping")))
    jacobian = interval_jacobian(problem, found)
    independent = information_inverse(problem, found.hypothesis, jacobian)
    units = np.sqrt(np.outer(np.diag(independent), np.diag(independent)))
    added = shared_rounding(problem, found, jacobian, independent) / units
    assert np.linalg.eigvalsh(added).min() > -1e-12  # rounding of numbers of size 1
    assert added.max() > 0.0


@pytest.mark.slow
def test_intervals_of_a_gain_hold_with_an_encoder_of_many_counts(tmp_path: Path) -> None:
    """Thirty rigs without effects, whose controllers turn the beam to a limit anywhere within a count."""
    scores = []
    for seed in range(700, 730):
        limit = math.radians(3.0) * float(np.random.default_rng(seed).uniform(0.95, 1.05))
        write_case(tmp_path / str(seed), Experiment(predict=0, deflection=limit, seed=seed))
        problem = problem_of(load_case(tmp_path / str(seed)))
        found = with_interval_covariance(problem, fit(problem, Hypothesis(("angle_gain",))))
        ((key, value),) = found.values().items()
        scores.append((value - 1.0) / found.deviations()[key])
    # The mean square of thirty standard normal numbers lies below 1.46 in 95 of 100 cases, above 0.62 in 95. With a
    # share of independent rests it is 2.
    assert 0.62 < float(np.mean(np.square(scores))) < 1.46
