"""A search goes on without what raises, keeps what it has, and never takes a failure for an absence."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.failures import Failures
from harness.identify.estimate.fit import fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.selection import candidates, search, spline_terms
from harness.identify.selection.decision import Rule
from harness.identify.verdict import Verdict, identify
from tests.posed import Posed


def test_without_any_candidate_nothing_is_excluded(plain: Posed, monkeypatch: pytest.MonkeyPatch) -> None:
    """Answer that nothing is identifiable, not that nothing acts, where every candidate fails."""

    def fail(*_: Any, **__: Any) -> Any:
        raise np.linalg.LinAlgError("singular matrix")

    monkeypatch.setattr(candidates, "screen", fail)
    failures = Failures()
    found = identify(plain.problem, failures=failures)
    assert found.verdict is Verdict.NOT_IDENTIFIABLE
    assert set(found.unseen) == set(candidates.candidates(plain.problem)) == {one.name for one in failures.all}
    with pytest.raises(np.linalg.LinAlgError):
        identify(plain.problem)


@pytest.mark.slow
def test_a_deviance_that_is_no_number_is_a_failure(plain: Posed, monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out a candidate whose fit ends with NaN, and say so."""
    base, original, failures = search.search(plain.problem).base, candidates.screen, Failures()

    def screen(problem: Any, hypothesis: Any, *arguments: Any, **options: Any) -> Any:
        ends = original(problem, hypothesis, *arguments, **options)
        bad = "level_error" in hypothesis.names
        return [replace(end, deviance=math.nan) for end in ends] if bad else ends

    monkeypatch.setattr(candidates, "screen", screen)
    tried = candidates.fit_candidates(plain.problem, base, lambda *_, **__: None, failures=failures)
    names = {one.hypothesis.names[-1] for one in tried}
    assert names == set(candidates.candidates(plain.problem)) - {"level_error"}
    (failure,) = failures.all
    assert (failure.part, failure.name) == ("candidate", "level_error")
    assert "not a number" in failure.message


@pytest.mark.slow
def test_a_step_that_fails_leaves_what_was_found_before(plain: Posed, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the effects where spline terms and the search by held-out errors raise, and name both."""

    def fail(*_: Any, **__: Any) -> Any:
        raise ValueError("array must not contain infs or NaNs")

    monkeypatch.setattr(search, "with_spline_term", fail)
    monkeypatch.setattr(search, "search_by_held_out_errors", fail)
    monkeypatch.setattr(search.Criterion, "predicts_poorly", lambda *_: True)
    monkeypatch.setattr(search.Criterion, "at_noise_floor", lambda *_: False)
    monkeypatch.setattr(search.Criterion, "below_noise_floor", lambda *_: False)
    monkeypatch.setattr(search, "without_stepwise", lambda *_: None)
    monkeypatch.setattr(search, "stepwise", lambda problem, base, *_: base)
    failures = Failures()
    selection = search.search(plain.problem, failures=failures)
    # that very fit, with the band and the travel of its predictions
    assert selection.found.terms is selection.base.terms
    assert selection.found.covariance is selection.base.covariance
    assert selection.found.process_noise == selection.base.process_noise
    assert [(one.part, one.name) for one in failures.all] == [
        ("search", "spline terms"),
        ("search", "search by held-out errors"),
    ]


@pytest.mark.slow
def test_what_needs_no_process_noise_is_not_searched_by_held_out_errors(
    plain: Posed, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Keep a fit that lacks nothing the readings show, however poorly the angle's own error lets it predict."""

    def fail(*_: Any, **__: Any) -> Any:
        raise AssertionError("searched")

    monkeypatch.setattr(search.Criterion, "predicts_poorly", lambda *_: True)
    monkeypatch.setattr(search, "search_by_held_out_errors", fail)
    assert search.search(plain.problem).found.root_process_noise < plain.problem.angle_floor
    monkeypatch.setattr(search.Criterion, "below_noise_floor", lambda *_: False)
    with pytest.raises(AssertionError, match="searched"):
        search.search(plain.problem)


@pytest.mark.slow
def test_effects_that_take_away_little_of_much_process_noise_are_not_kept(
    plain: Posed, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Return to no effect, with the reason, where stepwise selection ends far above the floor and explains nothing."""
    problem = plain.problem
    damped = fit(problem, Hypothesis(("viscous_damping",)))
    monkeypatch.setattr(search, "stepwise", lambda *_: damped)
    monkeypatch.setattr(search, "without_stepwise", lambda *_: None)
    monkeypatch.setattr(search, "with_spline_term", lambda problem, base, effects, *_: effects)
    monkeypatch.setattr(search.Criterion, "at_noise_floor", lambda *_: False)
    monkeypatch.setattr(search.Criterion, "far_above_noise_floor", lambda *_: True)
    monkeypatch.setattr(search.Criterion, "explains", lambda *_: False)
    selection = search.search(problem)
    assert selection.found is selection.base
    last = selection.ledger[-1]
    assert (last.rule, last.kept, last.effects) == (Rule.EXPLAIN, False, ("viscous_damping",))
    assert last.because.endswith("too little")
    monkeypatch.setattr(search.Criterion, "explains", lambda *_: True)
    assert search.search(problem).found is damped


@pytest.mark.slow
def test_spline_terms_that_all_fail_leave_the_effects(plain: Posed, monkeypatch: pytest.MonkeyPatch) -> None:
    """Go on without any spline term where none can be fitted."""

    def fail(*_: Any, **__: Any) -> Any:
        raise FloatingPointError("overflow")

    monkeypatch.setattr(spline_terms, "screen", fail)
    failures = Failures()
    ledger = search.Ledger(search.Criterion(plain.problem.settings), failures)
    found = search.fit(plain.problem, search.Hypothesis(()))
    assert spline_terms.with_spline_term(plain.problem, found, found, ledger, lambda *_, **__: None) is found
    assert len(failures.all) == len(spline_terms.KINDS)
