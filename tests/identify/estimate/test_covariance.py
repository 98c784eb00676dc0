"""How well numbers are known: where laws have corners, slopes at one place do not say it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from benchmarks.calibration.pose import experiment_of
from benchmarks.calibration.trials import Trial
from harness.identify.estimate.covariance import interval_jacobian, with_interval_covariance
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.screening import information_inverse
from harness.identify.filter import run as filter_run
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.numerics import TWO_SIDED
from harness.recording import load_case
from harness.simulator import DEFLECTION, write_case
from tests.posed import Posed


@pytest.mark.parametrize("name", ["level_error", "channel_delay", "position_gain"])
def test_a_smooth_law_is_known_as_well_as_its_slopes_say(plain: Posed, name: str) -> None:
    """Leave the interval of a law without corners as it is."""
    found = fit(plain.problem, Hypothesis((name,)))
    jacobian = interval_jacobian(plain.problem, found)
    wide = replace(found, covariance=information_inverse(plain.problem, found.hypothesis, jacobian))
    (before,), (after,) = (one.deviations().values() for one in (found, wide))
    # Over a standard deviation these laws are linear but for the ball's few stops: a twentieth of the interval.
    assert after == pytest.approx(before, rel=0.05)


def test_nothing_fitted_has_no_interval(plain: Posed) -> None:
    """Pass over a fit of nothing."""
    found = fit(plain.problem, Hypothesis(()))
    assert with_interval_covariance(plain.problem, found) is found


PLAY = Trial(
    study="confusion",
    name="linkage_backlash",
    factor=2.0,
    number=0,
    plant="virtual_rig",
    counts=4096,
    noise=0.000286,
    spikes=0.0,
    hidden={"linkage_backlash": {"width": 0.014289}},
    unlisted={},
    declared={"rolling_resistance": {"coefficient": 0.00204}},
    seed=1742178612,
    recordings=2,
)


def backlash(folder: Path, counts: int) -> tuple[Problem, Fit]:
    """A trial with a wide play, in which one closing gap falls on the edge of a step.

    The deviance has dips on either side of the edge, 0.02 typical sizes apart, and in which of them a search ends is
    for the rounding of a processor to decide. A search from the deepest point around its end stays in the deeper one.
    """
    write_case(folder, replace(experiment_of(PLAY), counts=counts, deflection=DEFLECTION))
    problem = problem_of(load_case(folder))
    hypothesis = Hypothesis(("linkage_backlash",))
    found = fit(problem, hypothesis)

    def deviance(theta: FloatArray) -> float:
        at = hypothesis.terms(theta, problem)
        return filter_run.deviance(problem, at, found.process_noise)

    around = [found.theta + shift for shift in np.arange(-0.04, 0.04, 1e-3)]
    return problem, fit(problem, hypothesis, process_noise=found.process_noise, starts=[min(around, key=deviance)])


@pytest.mark.slow
@pytest.mark.parametrize("counts", [4096, 40_000, 4_000_000])
def test_a_law_with_corners_is_known_as_its_deviance_says(tmp_path: Path, counts: int) -> None:
    """Let the deviance rise at both ends of the interval by what a normal one has there."""
    problem, found = backlash(tmp_path / "case", counts)
    key = ("linkage_backlash", "width")
    known = with_interval_covariance(problem, found)
    rises = []  # at the two ends, over what a parabola has there
    for end in (-TWO_SIDED, TWO_SIDED):
        theta = found.theta + end * known.deviations()[key] / found.hypothesis.scale(problem)
        at = found.hypothesis.terms(theta, problem)
        rises.append((filter_run.deviance(problem, at, found.process_noise) - found.deviance) / TWO_SIDED**2)
    # Steps in the deviance leave a factor of two.
    assert all(0.5 < one < 2.0 for one in rises)
