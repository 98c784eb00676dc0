"""The criterion: what is kept, and why, by numbers alone."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from harness.identify.estimate.fit import Fit
from harness.identify.problem.hypothesis import Hypothesis, Terms
from harness.identify.problem.settings import DEFAULT, Settings
from harness.identify.problem.spline_term import Regressor, blank
from harness.identify.selection.criterion import Criterion, Evidence, Rule

READINGS = 1000
PRICE = math.log(READINGS)
C = Criterion()


def made(score: float, *names: str, spline: bool = False, parameters: int | None = None) -> Fit:
    """A fit whose criterion is `score`, with one parameter an effect unless told otherwise."""
    spline = blank(Regressor.POSITION, False, 0.0, 1.0) if spline else None
    count = len(names) if parameters is None else parameters
    hypothesis = Hypothesis(names, spline)
    overdispersion = 1.0 if spline else DEFAULT.overdispersion
    deviance = (score - PRICE * count) * overdispersion
    terms = Terms((), (), np.zeros(0), spline)
    return Fit(hypothesis, np.zeros(count), terms, 1e-8, deviance, np.zeros((count, count)), READINGS)


def test_the_price_of_a_parameter_is_log_n() -> None:
    """Charge ln n for a parameter, and count the deviance over the overdispersion."""
    base, tried = made(0.0), made(0.0, "level_error")
    assert C.value(tried) == pytest.approx(0.0)
    assert tried.deviance / DEFAULT.overdispersion == pytest.approx(-PRICE)
    assert C.gain(tried, base) == pytest.approx(0.0)


def test_spline_terms_are_compared_by_the_plain_bic() -> None:
    """Take the deviance for what it is where either fit has a spline term."""
    plain, spline = made(100.0, parameters=0), made(40.0, spline=True, parameters=12)
    assert C.value(spline) == pytest.approx(40.0)
    assert C.gain(spline, plain) == pytest.approx(plain.deviance - 40.0)
    assert C.gain(plain, spline) == -C.gain(spline, plain)


@pytest.mark.parametrize(("gain", "kept"), [(6.01, True), (5.99, False), (-1.0, False)])
@pytest.mark.parametrize("rule", [Rule.ADD, Rule.RESTART, Rule.PREFER, Rule.REFINE])
def test_what_is_added_pays_more_than_the_threshold(rule: Rule, gain: float, kept: bool) -> None:
    """Keep what lowers the criterion by more than `keep`."""
    decision = C.decide(rule, made(100.0 - gain, "level_error"), made(100.0))
    assert decision.kept is kept
    assert decision.gain == pytest.approx(gain)


def test_only_the_best_of_a_round_is_added() -> None:
    """Say of the others how far they are behind it."""
    base, best, second = made(100.0), made(60.0, "rolling_resistance"), made(80.0, "level_error")
    evidence = Evidence(winner=best)
    assert C.decide(Rule.ADD, best, base, evidence).kept
    other = C.decide(Rule.ADD, second, base, evidence)
    assert not other.kept
    assert "20 less than rolling_resistance" in other.because
    assert "does not lower" in C.decide(Rule.ADD, made(101.0, "level_error"), base, evidence).because


def test_a_gain_below_the_threshold_is_called_too_little() -> None:
    """Say that a small gain of the best candidate is too little."""
    tried = made(97.0, "level_error")
    assert "too little" in C.decide(Rule.ADD, tried, made(100.0), Evidence(winner=tried)).because


@pytest.mark.parametrize(("gain", "stays"), [(6.01, True), (5.99, False)])
def test_an_effect_stays_while_it_pays(gain: float, stays: bool) -> None:
    """Drop an effect that lowers the criterion by less than `keep` beside the others."""
    with_it, without = made(100.0 - gain, "rolling_resistance", "level_error"), made(100.0, "level_error")
    assert C.decide(Rule.DROP, with_it, without).kept is stays


@pytest.mark.parametrize(("score", "kept"), [(49.9, True), (50.0, False), (50.1, False)])
def test_a_swap_lowers_the_criterion(score: float, kept: bool) -> None:
    """Put a candidate in the place of an effect if the criterion is lower with it, however little."""
    holder, without, tried = made(50.0, "level_error"), made(100.0), made(score, "track_curvature")
    decision = C.decide(Rule.SWAP, tried, without, Evidence(winner=tried, holder=holder))
    assert decision.kept is kept
    if score > 50.0:
        assert "less than the effect that it would replace" in decision.because


def test_only_the_best_is_swapped_in() -> None:
    """Leave a second candidate out, though it too would lower the criterion."""
    holder, without = made(50.0, "level_error"), made(100.0)
    best, second = made(40.0, "track_curvature"), made(45.0, "track_bump")
    assert not C.decide(Rule.SWAP, second, without, Evidence(winner=best, holder=holder)).kept


@pytest.mark.parametrize(
    ("gain", "each", "kept"), [(1.01, 7.0, True), (0.99, 7.0, False), (3.0, 5.99, False), (3.0, 6.01, True)]
)
def test_two_causes_have_to_explain_more_and_each_to_pay(gain: float, each: float, kept: bool) -> None:
    """Split one law into two where they gain more than the pair penalty and neither is idle."""
    pair = made(100.0 - gain, "rolling_resistance", "level_error")
    without = tuple(made(100.0 - gain + each, name) for name in ("rolling_resistance", "level_error"))
    decision = C.decide(Rule.SPLIT, pair, made(100.0, "directional_resistance"), Evidence(without=without))
    assert decision.kept is kept


@pytest.mark.parametrize(("gain", "kept"), [(-0.99, True), (-1.01, False), (2.0, True)])
def test_one_cause_is_preferred_to_two_that_explain_as_much(gain: float, kept: bool) -> None:
    """Merge two effects into one that is behind by less than the pair penalty."""
    one = made(100.0 - gain, "directional_resistance")
    assert C.decide(Rule.MERGE, one, made(100.0, "rolling_resistance", "level_error")).kept is kept


def with_gain(gain: float) -> tuple[Fit, Fit]:
    """A spline term and the fit without it, of which the BIC is higher by this."""
    without = made(0.0)
    return made(without.deviance - gain, spline=True, parameters=12), without


@pytest.mark.parametrize(("gain", "kept"), [(20.01, True), (19.99, False)])
def test_a_spline_term_has_a_higher_threshold(gain: float, kept: bool) -> None:
    """Keep a spline term that lowers the BIC by more than `spline_keep`; of one recording nothing recurs."""
    spline, without = with_gain(gain)
    assert C.decide(Rule.SPLINE, spline, without, Evidence(winner=spline)).kept is kept


@pytest.mark.parametrize(("wins", "kept"), [(0, False), (1, True), (2, True)])
def test_a_spline_term_predicts_half_of_the_recordings(wins: int, kept: bool) -> None:
    """Keep it if at least half of the recordings held out are predicted better with it."""
    spline, without = with_gain(50.0)
    after = tuple(9.0 if n < wins else 11.0 for n in range(2))
    decision = C.decide(Rule.SPLINE, spline, without, Evidence(winner=spline, before=(10.0, 10.0), after=after))
    assert decision.kept is kept
    assert ("does not predict the others" in decision.because) is not kept


def test_what_a_spline_term_contains_is_dropped() -> None:
    """Drop a nested effect where the spline term without it beats the fit before by its threshold."""
    effect, before = made(30.0, "level_error", spline=True, parameters=13), made(100.0)
    without = made(60.0, spline=True, parameters=12)
    assert C.decide(Rule.ABSORB, effect, without, Evidence(holder=before)).kept
    nested = C.decide(Rule.ABSORB, effect, without, Evidence(holder=before, nested=True))
    assert not nested.kept
    assert "contained" in nested.because
    weak = made(before.deviance - 19.0, spline=True, parameters=12)
    assert C.decide(Rule.ABSORB, effect, weak, Evidence(holder=before, nested=True)).kept
    idle = made(32.0, spline=True, parameters=12)
    assert not C.decide(Rule.ABSORB, effect, idle, Evidence(holder=before)).kept


WINDOWS = tuple(np.linspace(0.01, 0.03, 12))


@pytest.mark.parametrize(("factor", "kept"), [(0.9, True), (1.0, False), (1.1, False)])
def test_what_was_found_has_to_predict_held_out_windows_better(factor: float, kept: bool) -> None:
    """Keep what lowers the RMS error of held-out windows, whatever its likelihood."""
    evidence = Evidence(before=WINDOWS, after=tuple(factor * one for one in WINDOWS))
    decision = C.decide(Rule.VALIDATE, made(200.0, "level_error"), made(100.0), evidence)
    assert decision.kept is kept
    assert ("worse" in decision.because) is not kept


@pytest.mark.parametrize(("factor", "sure"), [(0.5, True), (1.0, False)])
def test_an_extension_is_sure_and_best(factor: float, sure: bool) -> None:
    """Add a candidate by held-out windows only beyond chance, and only the best of its round."""
    tried, base = made(90.0, "level_error"), made(100.0)
    after = tuple(factor * one for one in WINDOWS)
    first = Evidence(winner=tried if sure else None, before=WINDOWS, after=after, tests=17)
    assert C.decide(Rule.EXTEND, tried, base, first).kept is sure
    second = Evidence(winner=made(80.0, "track_bump"), before=WINDOWS, after=after, tests=17)
    assert not C.decide(Rule.EXTEND, tried, base, second).kept


def test_more_candidates_need_a_surer_gain() -> None:
    """Share the chance of a false positive among all candidates: the interval is wider."""
    after = tuple(one - 0.004 * (-1) ** n for n, one in enumerate(WINDOWS))
    one, many = (C.reduction(Evidence(before=WINDOWS, after=after, tests=tests)) for tests in (1, 17))
    assert many.low < one.low < one.value < one.high < many.high


@pytest.mark.parametrize(("behind", "rival"), [(5.99, True), (6.01, False)])
def test_rivals_are_less_than_strong_evidence_behind(behind: float, rival: bool) -> None:
    """Count as a rival what is behind by less than six; never across spline terms."""
    found = made(50.0, "level_error")
    assert C.rivals(made(50.0 + behind, "track_curvature"), found) is rival
    assert not C.rivals(made(50.0, spline=True, parameters=12), found)


def test_needed_separations_follow_from_the_thresholds() -> None:
    """Need √6 σ against a rival of as many parameters, less against a larger one; √(6 + k ln n) to be found at all."""
    found = made(50.0, "level_error")
    assert C.rival_separation(made(60.0, "track_bump"), found) == pytest.approx(math.sqrt(6.0))
    assert C.rival_separation(made(60.0, "track_bump", parameters=3), found) == 0.0
    assert C.detection_limit(READINGS, 2) == pytest.approx(math.sqrt(6.0 + 2.0 * PRICE))


@pytest.mark.parametrize("rule", Rule)
def test_every_rule_decides_by_the_settings(rule: Rule) -> None:
    """Keep nothing of small gain where every threshold is infinite, and all of it where they are below."""
    tried = made(99.0, "level_error")
    against = made(100.0)
    evidence = Evidence(
        winner=tried, holder=against, without=(against,), before=WINDOWS, after=tuple(0.5 * one for one in WINDOWS)
    )
    loose = Settings(keep=-1e9, spline_keep=-1e9, pair_penalty=-1e9)
    strict = Settings(keep=1e9, spline_keep=1e9, pair_penalty=1e9)
    decide: Callable[[Settings], bool] = lambda one: Criterion(one).decide(rule, tried, against, evidence).kept  # noqa: E731
    assert decide(loose) is (rule is not Rule.MERGE)  # which may be behind by the penalty, here a huge lead
    by_held_out = rule in (Rule.VALIDATE, Rule.EXTEND)
    # a swap asks for the lower criterion alone, a merge may be behind by the penalty
    assert decide(strict) is (by_held_out or rule in (Rule.SWAP, Rule.MERGE))


def test_settings_have_a_meaning_and_a_reason_each() -> None:
    """Say of every field what it means, and why it is what it is."""
    for name, default, meaning, reason in Settings.described():
        assert getattr(DEFAULT, name) == default
        assert len(meaning) > 10
        assert len(reason) > 5
