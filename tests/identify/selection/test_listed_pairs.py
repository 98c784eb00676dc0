"""Two laws of the catalogue are named as such, and not as the curve that they add up to."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Kind, Regressor, blank
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.listed_pairs import in_place_of_spline_term
from harness.progress import silent
from tests.posed import pose

PAIR = {"viscous_damping": {"coefficient": 0.03}, "level_error": {"angle": -0.004}}


def with_spline_of_velocity(problem: Problem) -> tuple[Fit, Fit]:
    """Fits without effects, and with a force of the velocity."""
    base = fit(problem, Hypothesis(()))
    spline = blank(Kind(Regressor.VELOCITY), -0.3, 0.3, problem.settings.spline_nodes)
    return base, fit(problem, Hypothesis((), spline), process_noise=base.process_noise)


@pytest.mark.slow
def test_a_damping_and_a_level_are_no_unlisted_force(tmp_path: Path) -> None:
    """Name both in place of a force of the velocity that fits them together, at their sizes."""
    problem = pose(tmp_path / "case", 3, PAIR).problem
    base, spline = with_spline_of_velocity(problem)
    ledger = Ledger(Criterion(problem.settings))
    found = in_place_of_spline_term(problem, base, spline, ledger, silent)
    assert set(found.hypothesis.names) == set(PAIR)
    assert found.hypothesis.spline is None
    assert [(line.rule, line.kept) for line in ledger.lines] == [(Rule.PREFER, True)]
    values, errors = found.values(), found.deviations()
    for name, parameters in PAIR.items():
        for parameter, value in parameters.items():
            key = name, parameter
            assert abs(values[key] - value) < 4.0 * errors[key]
            assert errors[key] < 0.05 * abs(value)  # told, not only not contradicted


@pytest.mark.slow
def test_an_unlisted_force_of_the_velocity_stays_one(tmp_path: Path) -> None:
    """Keep the curve of a drag that grows with the cube of the velocity: no two laws of the catalogue are that."""
    problem = pose(tmp_path / "case", 3, unlisted={"cubic_drag": {"coefficient": 0.8}}).problem
    base, spline = with_spline_of_velocity(problem)
    ledger = Ledger(Criterion(problem.settings))
    assert in_place_of_spline_term(problem, base, spline, ledger, silent) is spline
    assert [(line.rule, line.kept) for line in ledger.lines] == [(Rule.PREFER, False)]


def test_without_a_spline_term_nothing_is_tried(tmp_path: Path) -> None:
    """Leave a fit of listed effects as it is."""
    problem = pose(tmp_path / "case", 3).problem
    base = fit(problem, Hypothesis(()))
    ledger = Ledger(Criterion(problem.settings))
    assert in_place_of_spline_term(problem, base, base, ledger, silent) is base
    assert not ledger.lines
