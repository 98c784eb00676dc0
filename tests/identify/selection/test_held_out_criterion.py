"""The criterion where held-out blocks decide, by numbers alone."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from analytic.effects import acting
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.problem import WHITE, Problem
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence, Rule
from tests.identify.selection.made import made

C = Criterion()
BLOCKS = np.linspace(0.01, 0.03, 12)


def free(factors: float | np.ndarray, *names: str) -> Fit:
    """A fit to free runs with held-out errors of this many times `BLOCKS`."""
    return replace(made(0.0, *names), estimator=Estimator.FREE_RUNS, held_out=tuple((factors * BLOCKS).tolist()))


@pytest.mark.parametrize(("factor", "kept"), [(0.9, True), (1.0, True), (1.1, False)])
def test_what_was_selected_may_not_predict_worse(factor: float, kept: bool) -> None:
    """Drop what raises the mean error of held-out blocks, whatever its likelihood."""
    decision = C.decide(Rule.VALIDATE, free(factor, "level_error"), free(1.0))
    assert decision.kept is kept
    assert f"{20.0 * factor:.3g} mm instead of 20 mm" in decision.because


@pytest.mark.parametrize("rule", [Rule.JOINT, Rule.EXTEND, Rule.EXCHANGE])
@pytest.mark.parametrize(("factor", "sure"), [(0.5, True), (1.0, False)])
def test_what_held_out_blocks_select_is_sure_and_best(rule: Rule, factor: float, sure: bool) -> None:
    """Keep terms by held-out blocks only beyond chance, and only the best of the round."""
    tried, base = free(factor, "level_error"), free(1.0)
    decision = C.decide(rule, tried, base, Evidence(winner=tried, tests=17))
    assert decision.kept is sure
    assert not C.decide(rule, tried, base, Evidence(winner=free(0.4, "track_bump"), tests=17)).kept


@pytest.mark.parametrize(
    ("factor", "loss", "kept"),
    [
        (0.97, 0.9, True),
        (0.97, 0.97, False),
        (0.97, 1.1, False),
        (1.01, 0.5, False),
        (np.r_[np.full(11, 1.02), 0.2], 0.9, True),  # better by 5 %, but not significantly
        (np.r_[np.full(11, 1.02), 0.2], 1.1, False),
    ],
)
def test_in_sample_loss_decides_an_exchange_that_held_out_blocks_leave_open(
    factor: float | np.ndarray, loss: float, kept: bool
) -> None:
    """Make an exchange that predicts a little better if it also fits better by 5 %, and none that predicts worse."""
    tried, base = free(factor, "rolling_resistance"), free(1.0, "viscous_damping")
    decision = C.decide(Rule.EXCHANGE, tried, base, Evidence(winner=tried, before=(2.0,), after=(2.0 * loss,)))
    assert decision.kept is kept
    assert ("in-sample loss" in decision.because) is bool(np.mean(factor) < 1.0)
    assert not C.decide(Rule.EXCHANGE, tried, base, Evidence(winner=tried)).kept
    assert C.needs_evidence(Rule.EXCHANGE, tried, base) is bool(np.mean(factor) < 1.0)
    assert not C.needs_evidence(Rule.EXCHANGE, free(0.5, "rolling_resistance"), base)  # surely better in any case


@pytest.mark.parametrize(("factor", "kept"), [(0.99, True), (1.01, True), (1.03, False)])
def test_an_exchange_for_fewer_parameters_is_made_where_one_would_be_pruned(factor: float, kept: bool) -> None:
    """Take the law of one number for that of two if held-out blocks are predicted worse by less than 2 %."""
    simple, rich = free(factor, "rolling_resistance"), free(1.0, "directional_resistance")
    for losses in ({}, {"before": (1.0,), "after": (2.0,)}):  # a nested law's loss is higher
        assert C.decide(Rule.EXCHANGE, simple, rich, Evidence(winner=simple, **losses)).kept is kept
    assert C.decide(Rule.PRUNE, rich, simple).kept is not kept
    assert not C.needs_evidence(Rule.EXCHANGE, simple, rich)
    assert not C.decide(Rule.EXCHANGE, simple, rich, Evidence(winner=free(0.4, "level_error"))).kept


def test_an_exchange_for_more_parameters_has_to_be_sure() -> None:
    """Take the law of two numbers for that of one only if held-out blocks surely say so, whatever it fits better."""
    base = free(1.0, "rolling_resistance")
    for factor, kept in ((np.r_[np.full(11, 1.02), 0.2], False), (0.8, True)):
        rich = free(factor, "directional_resistance")
        assert not C.needs_evidence(Rule.EXCHANGE, rich, base)
        evidence = Evidence(winner=rich, before=(2.0,), after=(0.1,))
        assert C.decide(Rule.EXCHANGE, rich, base, evidence).kept is kept


def test_of_many_exchanges_the_best_is_not_sure_by_chance() -> None:
    """Divide the significance level by the exchanges that were tried, so that the in-sample loss has to decide."""
    factor = np.r_[np.full(8, 0.85), np.full(4, 1.06)]
    tried, base = free(factor, "rolling_resistance"), free(1.0, "viscous_damping")
    assert not C.needs_evidence(Rule.EXCHANGE, tried, base, tests=1)
    assert C.needs_evidence(Rule.EXCHANGE, tried, base, tests=30)
    assert C.decide(Rule.EXCHANGE, tried, base, Evidence(winner=tried, tests=1)).kept
    assert not C.decide(Rule.EXCHANGE, tried, base, Evidence(winner=tried, tests=30)).kept


def test_a_reduction_that_a_few_blocks_make_is_not_significant() -> None:
    """Keep nothing that makes one block of twelve much better and the others a little worse, and say why."""
    factors = np.r_[np.full(11, 1.02), 0.2]
    decision = C.decide(Rule.JOINT, free(factors, "level_error"), free(1.0))
    assert not decision.kept
    assert decision.gain > 0.0
    assert "not significant" in decision.because


def test_a_set_of_effects_pays_by_a_fifth() -> None:
    """Keep no set that surely reduces the error, but by too little to choose it among a dozen sets."""
    decision = C.decide(Rule.JOINT, free(0.9, "level_error"), free(1.0))
    assert not decision.kept
    assert "too little" in decision.because
    assert C.decide(Rule.EXTEND, free(0.9, "level_error"), free(1.0)).kept


@pytest.mark.parametrize(("factor", "kept"), [(0.97, True), (0.99, False)])
def test_an_effect_is_pruned_that_does_not_pay_for_its_parameter(factor: float, kept: bool) -> None:
    """Ask 2 % of every parameter, e.g. factors below exp(−0.02) = 0.980."""
    assert C.decide(Rule.PRUNE, free(factor, "level_error"), free(1.0)).kept is kept


@pytest.mark.parametrize(
    ("strength", "factor", "kept"), [(2.1, 0.97, True), (-2.1, 0.97, True), (1.9, 0.85, False), (1.9, 0.78, True)]
)
def test_an_effect_that_may_be_none_has_to_pay_by_a_fifth(strength: float, factor: float, kept: bool) -> None:
    """Drop, and do not add, what reduces the error of held-out blocks a little and has an interval that holds none of
    it, e.g. factors above exp(−0.22) = 0.803."""
    tried = free(factor, "level_error")
    terms = replace(tried.terms, effects=(acting("level_error", {"angle": 0.01 * strength}),))
    weak = replace(tried, terms=terms, covariance=np.array([[1e-4]]))
    for rule in (Rule.PRUNE, Rule.EXTEND):  # or the search would add and drop it for ever
        decision = C.decide(rule, weak, free(1.0))
        assert decision.kept is kept
        assert ("strength may be none" in decision.because) is not kept


def test_more_candidates_need_a_surer_gain() -> None:
    """Share the chance of a false positive among all candidates: the interval is wider."""
    after = 1.0 - 0.2 * (-1.0) ** np.arange(12)
    one, many = (C.reduction(free(after, "level_error"), free(1.0), tests) for tests in (1, 17))
    assert many.low < one.low < one.value < one.high < many.high
    assert C.reduction(free(after, "level_error"), free(1.0)) == one


@pytest.mark.parametrize(("factor", "rival"), [(1.04, True), (1.06, False)])
def test_rivals_over_seconds_predict_almost_as_well(factor: float, rival: bool) -> None:
    """Count as a rival what predicts held-out blocks worse by less than 5 %; never a fit by likelihood."""
    found = free(1.0, "level_error")
    assert C.rivals(free(factor, "viscous_damping"), found) is rival
    assert not C.rivals(made(-1e9, "viscous_damping"), found)


@pytest.mark.parametrize(("error", "poor"), [(1.2, False), (1.3, True)])
@pytest.mark.parametrize(("floor", "complete"), [(0.0, 1e-3), (1e-2, 0.01637)])
def test_predictions_are_poor_where_a_complete_model_errs_less(
    error: float, poor: bool, floor: float, complete: float
) -> None:
    """Judge median errors of windows against those of readings and angle; without any window nothing is poor."""
    # With q = 1e-4 m²/s³ and readings of 1 mm at 100 Hz: √2 q^¾ (1e-8 m² s)^¼ = 1.41e-5 m²/s², which over 3 s adds
    # 3 s² of it, 4.2e-5 m², and q 27/12 s³ = 2.25e-4 m²: a root of 16.4 mm with the 1e-6 m² of a reading.
    one = SimpleNamespace(time=np.arange(100) * 0.01)
    problem = cast(Problem, SimpleNamespace(reading_variance=1e-6, colour=WHITE, angle_floor=floor, recordings=(one,)))
    assert C.predicts_poorly(problem, [0.5 * complete * error, 1.5 * complete * error]) is poor
    assert not C.predicts_poorly(problem, [])


def test_a_value_for_each_recording_has_to_pay_as_one_for_all() -> None:
    """Weigh a level of each recording as a level of all: neither simpler than it nor kept for a thousandth."""
    level, each = free(1.0, "level_error"), free(1.01, "level_per_recording")
    assert C.value(free(1.0, "level_per_recording")) == C.value(level)
    assert not C.decide(Rule.EXCHANGE, each, level, Evidence(winner=each, tests=20)).kept
    for name in ("level_error", "level_per_recording"):
        assert not C.decide(Rule.PRUNE, free(0.999, name), free(1.0)).kept
