"""A curve of unknown law has to act again: twelve numbers can follow what happened once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from harness.identify.fit import Fit, fit
from harness.identify.hypothesis import Hypothesis
from harness.identify.prepare import problem_of
from harness.identify.problem import Problem
from harness.identify.remainder import CURVE_THRESHOLD, _recurs, remainder
from harness.identify.shape import Depends, blank, visited
from harness.recording import load_case
from harness.virtual_rig import Experiment, write_case
from tests.identify.conftest import DECLARED

# So strong that half of it in either recording pays for a curve when it blew in one of them.
GUST = {"gust": {"force": 0.02, "start": 5.0, "end": 8.0}}


def blown(folder: Path, *, both: bool) -> Problem:
    """Two recordings with a gust at the same instant in both, or in the first only."""
    gusty = Experiment(declared=DECLARED, unlisted=GUST, predict=0, seed=1)
    first, second = gusty.recordings()
    if not both:
        _, second = replace(gusty, unlisted={}).recordings()
    write_case(folder, gusty, (first, second))
    return problem_of(load_case(folder))[0]


def with_and_without(problem: Problem) -> tuple[Fit, Fit]:
    """Fits without a curve and with one of time."""
    found = fit(problem, Hypothesis(()))
    curve = blank(Depends.TIME, False, *visited(problem, Depends.TIME))
    return found, fit(problem, Hypothesis((), curve), density=found.density)


@pytest.mark.parametrize("both", [True, False], ids=["in both", "in one"])
def test_a_gust_is_a_curve_of_time_only_if_it_comes_again(tmp_path: Path, both: bool) -> None:
    """Let a curve of time stand that predicts a recording it was not fitted to, and no other, much as it gains."""
    problem = blown(tmp_path / "case", both=both)
    found, best = with_and_without(problem)
    assert found.bic - best.bic > CURVE_THRESHOLD  # it follows what happened in either case
    assert _recurs(problem, found, best, lambda _: None) is both


def test_one_recording_cannot_tell(tmp_path: Path) -> None:
    """Take the curve's gain for what it is where there is no second recording to ask."""
    problem = blown(tmp_path / "case", both=False)
    alone = replace(problem, records=problem.records[:1])
    found, best = with_and_without(alone)
    assert found.bic - best.bic > CURVE_THRESHOLD
    assert _recurs(alone, found, best, lambda _: None)


@pytest.mark.slow
def test_a_single_gust_leaves_a_reason_in_the_ledger(tmp_path: Path) -> None:
    """Keep the fit without a curve of time, and say why the best curve was not kept."""
    problem = blown(tmp_path / "case", both=False)
    found = fit(problem, Hypothesis(()))
    kept, ledger = remainder(problem, found, lambda _: None)
    assert kept is found
    assert not any(entry.kept for entry in ledger)
    assert "does not predict the others" in ledger[0].because
