"""A fit made again on other recordings, with the estimator that made it."""

from __future__ import annotations

from dataclasses import replace

from harness.identify.estimate.fit import Estimator, Fit, fit
from harness.identify.estimate.free_run_fit import fit_free_runs
from harness.identify.estimate.starts import starting_points
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import fitted_windows


def refit(problem: Problem, found: Fit) -> Fit:
    """The hypothesis of a fit, fitted to the recordings of `problem` from the values of that fit."""
    if found.estimator is Estimator.FREE_RUNS:
        again = fit_free_runs(problem, found.refined, fitted_windows(problem.recordings), initial=found.values()).fit
        return replace(again, process_noise=found.process_noise)
    start, *_ = starting_points(problem, found.refined, found.values(), found.process_noise)
    # One alternation: without a part of the readings, the optimum and the process noise are where they were but for it.
    return fit(problem, found.refined, process_noise=found.process_noise, starts=[start], rounds=1)
