"""Stepwise selection: what pays is added, what does not is left, and every attempt is in the ledger."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import best_screened, candidates, fit_candidates, selected_effects
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.stepwise import first_round, stepwise
from tests.posed import Posed, pose

DAMPED = {"viscous_damping": {"coefficient": 0.03}}


def quiet(_: str) -> None:
    """Progress that nobody follows."""


@pytest.fixture(scope="module")
def damped(tmp_path_factory: pytest.TempPathFactory) -> tuple[Problem, Fit, list[Fit]]:
    """A viscous damping is hidden; the fit without it, and all candidates beside that."""
    problem = pose(tmp_path_factory.mktemp("damped") / "case", 0, DAMPED).problem
    base = fit(problem, Hypothesis(()))
    return problem, base, fit_candidates(problem, base, quiet)


def test_every_candidate_is_tried_best_first(damped: tuple[Problem, Fit, list[Fit]]) -> None:
    """Try each effect of the catalogue that could act, and put what acts first."""
    problem, _, tried = damped
    assert sorted(one.hypothesis.names[-1] for one in tried) == sorted(candidates(problem))
    values = [Criterion().value(one) for one in tried]
    assert values == sorted(values)
    assert tried[0].hypothesis.names == ("viscous_damping",)


def test_only_what_is_behind_is_not_fitted_to_the_end(damped: tuple[Problem, Fit, list[Fit]]) -> None:
    """Mark the candidates whose fit was not continued: most of them here, never the best."""
    _, _, tried = damped
    assert not tried[0].abandoned
    assert sum(one.abandoned for one in tried) > len(tried) / 2


def test_a_screening_fit_promises_nearly_what_a_fit_brings(damped: tuple[Problem, Fit, list[Fit]]) -> None:
    """Come by one step nearer to the best fit than to where the search began."""
    problem, base, tried = damped
    end, begin = (Criterion().value(one) for one in (tried[0], base))
    assert end - 1e-6 <= best_screened(problem, base, quiet) < 0.5 * (begin + end)


def test_an_excluded_effect_is_not_tried(damped: tuple[Problem, Fit, list[Fit]]) -> None:
    """Leave out the effect in whose place others are tried."""
    problem, base, _ = damped
    tried = fit_candidates(problem, base, quiet, excluding="viscous_damping", replacing=True)
    assert "viscous_damping" not in {one.hypothesis.names[-1] for one in tried}


@pytest.mark.slow
def test_what_acts_is_found_and_nothing_else(damped: tuple[Problem, Fit, list[Fit]]) -> None:
    """Add the damping, then nothing; the ledger tells of two rounds in which every candidate was tried."""
    problem, base, _ = damped
    ledger = Ledger(Criterion())
    found = stepwise(problem, base, first_round(problem, base, ledger, quiet), ledger, quiet)
    assert selected_effects(problem, found) == ("viscous_damping",)
    added = [line for line in ledger.lines if line.rule is Rule.ADD]
    assert [line.effects for line in added if line.kept] == [("viscous_damping",)]
    assert len(added) == 2 * len(candidates(problem)) - 1
    assert {line.beside for line in added} == {(), ("viscous_damping",)}


def test_nothing_is_found_where_nothing_is_missing(plain: Posed) -> None:
    """End with the fit that it began with, and a reason for each candidate."""
    base = fit(plain.problem, Hypothesis(()))
    ledger = Ledger(Criterion())
    assert stepwise(plain.problem, base, first_round(plain.problem, base, ledger, quiet), ledger, quiet) is base
    assert not any(line.kept for line in ledger.lines)
    assert all(line.because for line in ledger.lines)


@pytest.mark.slow
def test_no_more_effects_are_found_than_the_settings_allow(tmp_path: Path) -> None:
    """Stop at the number of effects that recordings can tell apart."""
    from dataclasses import replace

    from harness.identify.problem.settings import Settings

    hidden = {"rolling_resistance": {"coefficient": 0.004}, "level_error": {"angle": 0.004}}
    problem = replace(pose(tmp_path / "case", 0, hidden).problem, settings=Settings(max_effects=1, restarts_from=0))
    ledger = Ledger(Criterion(problem.settings))
    base = fit(problem, Hypothesis(()))
    found = stepwise(problem, base, first_round(problem, base, ledger, quiet), ledger, quiet)
    assert len(selected_effects(problem, found)) == 1
