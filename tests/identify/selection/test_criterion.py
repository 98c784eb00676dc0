"""The criterion: what is kept, and why, by numbers alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from harness.identify.problem.problem import Problem
from harness.identify.problem.settings import DEFAULT, Settings
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence, Rule
from tests.identify.selection.made import PRICE, READINGS, made, with_gain

C = Criterion()
HELD_OUT = (Rule.JOINT, Rule.VALIDATE, Rule.EXTEND, Rule.EXCHANGE, Rule.PRUNE, Rule.RESTORE)


def test_the_price_of_a_parameter_is_log_n() -> None:
    """Charge ln n for a parameter, and take the deviance for what it is."""
    base, tried = made(0.0), made(0.0, "level_error")
    assert C.value(tried) == pytest.approx(0.0)
    assert tried.deviance == pytest.approx(-PRICE)
    assert C.gain(tried, base) == pytest.approx(0.0)


def test_process_noise_is_a_parameter_that_may_be_saved() -> None:
    """Credit ln n to a fit that needs no process noise, and no more than what the noise gained to one that does."""
    noisy = made(0.0)
    quiet = replace(noisy, quiet_deviance=noisy.deviance)
    assert C.gain(quiet, noisy) == pytest.approx(PRICE)
    assert C.gain(replace(noisy, quiet_deviance=noisy.deviance + 0.5 * PRICE), noisy) == pytest.approx(0.5 * PRICE)
    assert C.gain(replace(noisy, quiet_deviance=noisy.deviance + 2.0 * PRICE), noisy) == 0.0


@pytest.mark.parametrize(("share", "kept"), [(0.5, True), (0.98, False), (1.1, False)])
def test_a_spline_term_by_likelihood_is_returned_to_if_it_surely_predicts_better(share: float, kept: bool) -> None:
    """Compare mean errors of held-out blocks, each by the estimator of its fit, and say by how much the log differs."""
    before = np.array([2.0, 4.0, 3.0, 5.0, 2.5, 1.5]) * 1e-3
    after = share * before[::-1]  # another order, so that a few hundredths are within the scatter of the blocks
    evidence = Evidence(before=tuple(before), after=tuple(after))
    decision = C.decide(Rule.RESTORE, made(0.0, spline=True, parameters=12), made(0.0, "level_error"), evidence)
    assert decision.kept is kept
    assert decision.gain == pytest.approx(-math.log(share))
    assert f"{3.0 * share:.3g} mm instead of 3 mm" in decision.because
    assert ("not significant" in decision.because) == (not kept and share < 1.0)


def test_spline_terms_are_compared_by_the_same_criterion() -> None:
    """Charge ln n for each node of a spline term too."""
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
    ("gain", "each", "kept"), [(3.01, 7.0, True), (2.99, 7.0, False), (4.0, 5.99, False), (4.0, 6.01, True)]
)
def test_two_causes_have_to_explain_more_and_each_to_pay(gain: float, each: float, kept: bool) -> None:
    """Split one law into two where they gain more than the pair penalty and neither is idle."""
    pair = made(100.0 - gain, "rolling_resistance", "level_error")
    without = tuple(made(100.0 - gain + each, name) for name in ("rolling_resistance", "level_error"))
    decision = C.decide(Rule.SPLIT, pair, made(100.0, "directional_resistance"), Evidence(without=without))
    assert decision.kept is kept


@pytest.mark.parametrize(("gain", "kept"), [(-2.99, True), (-3.01, False), (4.0, True)])
def test_one_cause_is_preferred_to_two_that_explain_as_much(gain: float, kept: bool) -> None:
    """Merge two effects into one that is behind by less than the pair penalty."""
    one = made(100.0 - gain, "directional_resistance")
    assert C.decide(Rule.MERGE, one, made(100.0, "rolling_resistance", "level_error")).kept is kept


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


@pytest.mark.parametrize(
    ("rule", "kept"),
    [(Rule.ADD, False), (Rule.RESTART, False), (Rule.PREFER, False), (Rule.REFINE, False), (Rule.DROP, True)],
)
def test_at_the_threshold_nothing_changes(rule: Rule, kept: bool) -> None:
    """Add nothing that gains exactly the threshold, and drop nothing that does."""
    tried, against = made(90.0, "level_error"), made(100.0)
    exact = Settings(keep=C.gain(tried, against))
    assert Criterion(exact).decide(rule, tried, against).kept is kept


def test_at_the_pair_penalty_two_causes_stay_what_they_are() -> None:
    """Neither split one law nor merge two where the gain is exactly the penalty, nor split where one just pays."""
    pair, one = made(90.0, "rolling_resistance", "level_error"), made(100.0, "directional_resistance")
    half = made(200.0, "rolling_resistance")
    exact = Criterion(Settings(pair_penalty=C.gain(pair, one)))
    assert not exact.decide(Rule.SPLIT, pair, one, Evidence(without=(half,))).kept
    assert not exact.decide(Rule.MERGE, one, pair).kept
    assert C.decide(Rule.SPLIT, pair, one, Evidence(without=(half,))).kept
    just = Criterion(Settings(keep=C.gain(pair, half)))
    assert not just.decide(Rule.SPLIT, pair, one, Evidence(without=(half,))).kept


def test_at_its_threshold_a_spline_term_explains_nothing() -> None:
    """Neither keep a spline term that gains exactly its threshold nor say that it contains an effect."""
    spline, without = with_gain(50.0)
    exact = Criterion(Settings(spline_keep=C.gain(spline, without)))
    assert C.decide(Rule.SPLINE, spline, without, Evidence(winner=spline)).kept
    assert not exact.decide(Rule.SPLINE, spline, without, Evidence(winner=spline)).kept
    effect = made(C.value(spline) - 30.0, "level_error", spline=True, parameters=13)
    nested = Evidence(holder=without, nested=True)
    assert not C.decide(Rule.ABSORB, effect, spline, nested).kept
    assert exact.decide(Rule.ABSORB, effect, spline, nested).kept
    idle = Criterion(Settings(keep=C.gain(effect, spline)))
    assert idle.decide(Rule.ABSORB, effect, spline, Evidence(holder=without)).kept


@pytest.mark.parametrize(
    ("rule", "threshold"), [(Rule.SPLINE, DEFAULT.spline_keep), (Rule.SPLIT, DEFAULT.pair_penalty)]
)
def test_further_evidence_is_needed_only_where_it_can_decide(rule: Rule, threshold: float) -> None:
    """Ask for it beyond the first threshold of the rule, which no evidence makes up for."""
    spline = rule is Rule.SPLINE
    without = made(100.0, spline=spline)
    for gain, needed in ((threshold - 0.01, False), (threshold + 0.01, True)):
        tried = made(100.0 - gain, spline=spline)
        assert C.needs_evidence(rule, tried, without) is needed
        best = Evidence(winner=tried, before=(10.0,), after=(9.0,))
        assert C.decide(rule, tried, without, best).kept is needed


def test_one_recording_of_three_is_not_half_of_them() -> None:
    """Drop a spline term that predicts one recording of three better, or all of them just as well."""
    spline, without = with_gain(50.0)
    for after, kept in (((9.0, 11.0, 11.0), False), ((9.0, 9.0, 11.0), True), ((10.0, 10.0, 10.0), False)):
        evidence = Evidence(winner=spline, before=(10.0,) * 3, after=after)
        assert C.decide(Rule.SPLINE, spline, without, evidence).kept is kept


def test_held_out_figures_come_in_pairs() -> None:
    """Refuse to compare two recordings without the spline term with one that has it."""
    spline, without = with_gain(50.0)
    with pytest.raises(ValueError, match="shorter"):
        C.decide(Rule.SPLINE, spline, without, Evidence(winner=spline, before=(10.0, 10.0), after=(9.0,)))


@pytest.mark.parametrize(("ratio", "below", "above"), [(0.99, True, False), (1.0, False, False), (1.01, False, True)])
def test_what_is_left_is_judged_against_the_floor_of_the_input_noise(ratio: float, below: bool, above: bool) -> None:
    """Call a fit at the floor below the one multiple of it, and far above it beyond the other."""
    one = made(0.0)
    for factor in (1.0, 4.0):  # powers of two, so that the product is exact
        criterion = Criterion(Settings(at_floor_ratio=factor, above_floor_ratio=factor))
        floor = cast(Problem, SimpleNamespace(angle_floor=one.root_process_noise / factor / ratio))
        assert criterion.at_noise_floor(floor, one) is below
        assert criterion.far_above_noise_floor(floor, one) is above


def test_exactly_so_far_behind_is_no_rival() -> None:
    """Count what is behind by the whole margin as told apart."""
    assert not Criterion(Settings(rival=0.0)).rivals(made(50.0, "track_bump"), made(50.0, "level_error"))


@pytest.mark.parametrize(("behind", "first"), [(5.9, "rolling_resistance"), (6.1, "directional_resistance")])
def test_of_laws_that_fit_alike_the_simplest_is_first(behind: float, first: str) -> None:
    """Rank a law of one number before one of two that is better by less than strong evidence, and say why."""
    two = made(50.0, "directional_resistance", parameters=2)
    one, other = made(50.0 + behind, "rolling_resistance"), made(70.0, "level_error")
    ranked = C.ranked([other, two, one])
    assert ranked[0].hypothesis.names == (first,)
    assert ranked[-1] is other
    decision = C.decide(Rule.ADD, two, made(100.0), Evidence(winner=ranked[0]))
    assert decision.kept is (first == "directional_resistance")
    assert ("which has fewer parameters" in decision.because) is not decision.kept


@pytest.mark.parametrize(("behind", "rival"), [(5.99, True), (6.01, False)])
def test_rivals_are_less_than_strong_evidence_behind(behind: float, rival: bool) -> None:
    """Count as a rival what is behind by less than six; never across spline terms."""
    found = made(50.0, "level_error")
    assert C.rivals(made(50.0 + behind, "track_curvature"), found) is rival
    assert not C.rivals(made(50.0, spline=True, parameters=12), found)


@pytest.mark.parametrize(("behind", "rival"), [(5.9, True), (6.1, False)])
def test_what_makes_the_ball_late_need_not_pay_to_be_a_rival(behind: float, rival: bool) -> None:
    """Count a servo of two numbers as a rival of a delay that fits as well, and not of a friction beside one."""
    delay = made(50.0, "channel_delay")
    servo = made(50.0 + PRICE + behind, "angle_servo", parameters=2)
    assert C.rivals(servo, delay) is rival
    assert C.rival_separation(servo, delay) == pytest.approx(math.sqrt(6.0))
    simpler = made(servo.deviance + 2.0 * PRICE + behind, "position_lag")
    assert C.rivals(simpler, servo) is rival
    assert C.rival_separation(simpler, servo) == pytest.approx(math.sqrt(6.0 + PRICE))
    assert not C.rivals(made(50.0 + PRICE + behind, "angle_servo", "channel_delay", parameters=2), delay)
    assert not C.rivals(servo, made(50.0, "viscous_damping"))


@pytest.mark.parametrize(("beside", "rival"), [(("level_error",), True), (("viscous_damping",), False)])
def test_the_same_law_under_another_name_need_not_pay(beside: tuple[str, ...], rival: bool) -> None:
    """Count a curvature as a rival of a compliance beside a level, though it has two numbers, and not beside a drag."""
    bends = made(50.0, *beside, "beam_compliance")
    hill = made(50.0 + PRICE, *beside, "track_curvature", parameters=3)
    assert C.rivals(hill, bends) is rival
    assert C.rival_separation(hill, bends) == pytest.approx(math.sqrt(6.0) if rival else 0.0)


def test_needed_separations_follow_from_the_thresholds() -> None:
    """Need √6 σ against a rival of as many parameters, less against a larger one; √(6 + k ln n) to be found at all."""
    found = made(50.0, "level_error")
    assert C.rival_separation(made(60.0, "track_bump"), found) == pytest.approx(math.sqrt(6.0))
    assert C.rival_separation(made(60.0, "track_bump", parameters=3), found) == 0.0
    assert C.detection_limit(READINGS, 2) == pytest.approx(math.sqrt(6.0 + 2.0 * PRICE))


@pytest.mark.parametrize(("left", "kept"), [(0.74, True), (0.76, False), (1.2, False)])
def test_effects_far_above_the_floor_have_to_explain_a_quarter(left: float, kept: bool) -> None:
    """Weigh the density of the process noise that is left, whatever the likelihood gains, and give its share."""
    against = made(1000.0)
    tried = replace(made(0.0, "contact_slip"), process_noise=left * against.process_noise)
    decision = C.decide(Rule.EXPLAIN, tried, against)
    assert decision.kept is kept
    assert f"{max(1.0 - left, 0.0):.0%} less process noise" in decision.because
    assert decision.gain == pytest.approx(C.gain(tried, against))


@pytest.mark.parametrize("rule", [rule for rule in Rule if rule not in HELD_OUT])
def test_every_rule_decides_by_the_settings(rule: Rule) -> None:
    """Keep nothing of small gain where every threshold is infinite, and all of it where they are below."""
    tried = made(99.0, "level_error")
    against = made(100.0)
    evidence = Evidence(winner=tried, holder=against, without=(against,), before=(1.0, 1.0), after=(0.5, 0.5))
    loose = Settings(keep=-1e9, rival=-1e9, spline_keep=-1e9, pair_penalty=-1e9, explained_least=-1e9)
    strict = Settings(keep=1e9, rival=1e9, spline_keep=1e9, pair_penalty=1e9, explained_least=1e9)
    decide: Callable[[Settings], bool] = lambda one: Criterion(one).decide(rule, tried, against, evidence).kept  # noqa: E731
    assert decide(loose) is (rule is not Rule.MERGE)  # which may be behind by the penalty, here a huge lead
    assert decide(strict) is (rule is Rule.MERGE)


def test_settings_have_a_meaning_and_a_reason_each() -> None:
    """Say of every field what it means, and why it is what it is."""
    for name, default, meaning, reason in Settings.described():
        assert getattr(DEFAULT, name) == default
        assert len(meaning) > 10
        assert len(reason) > 5
