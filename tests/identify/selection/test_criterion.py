"""The criterion: what is kept, and why, by numbers alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.problem import WHITE, Problem
from harness.identify.problem.settings import DEFAULT, Settings
from harness.identify.selection.criterion import Criterion, Evidence, Rule
from tests.identify.selection.made import PRICE, READINGS, made

C = Criterion()
HELD_OUT = (Rule.JOINT, Rule.VALIDATE, Rule.EXTEND, Rule.EXCHANGE, Rule.PRUNE)


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
    ("rule", "gain", "said"),
    [
        (Rule.DROP, 7.0, "lowers the BIC by 7.0 beside the others"),
        (Rule.DROP, 5.0, "is no longer needed beside the others"),
        (Rule.MERGE, 4.0, "the one effect fits better than the pair"),
        (Rule.MERGE, 0.5, "the one effect fits as well as the pair"),
        (Rule.MERGE, -0.5, "the one effect fits as well as the pair"),
        (Rule.MERGE, -4.0, "the one effect fits worse than the pair"),
        (Rule.SPLIT, 4.0, "the pair fits better than the one effect"),
        (Rule.SPLIT, 0.5, "the pair fits no better than the one effect"),
        (Rule.ADD, 7.0, "lowers the BIC by 7.0"),
        (Rule.ADD, 0.5, "lowers the BIC by 0.5, too little"),
        (Rule.ADD, -0.5, "does not lower the BIC"),
    ],
)
def test_a_decision_gives_its_reason(rule: Rule, gain: float, said: str) -> None:
    """Say in words what the numbers decided."""
    assert C.decide(rule, made(100.0 - gain, "level_error"), made(100.0)).because == said


@pytest.mark.parametrize(("gain", "said"), [(7.0, "lowers the BIC by 7.0"), (-0.5, "does not lower the BIC")])
def test_the_reason_names_the_criterion_that_decided(gain: float, said: str) -> None:
    """Speak of the BIC where the nodes of a spline term are doubled."""
    fine, coarse = (made(score, spline=True, parameters=12) for score in (100.0 - gain, 100.0))
    assert C.decide(Rule.REFINE, fine, coarse).because == said


def test_what_gains_nothing_at_all_does_not_pay() -> None:
    """Say so of a candidate that leaves the criterion exactly as it is, alone or in the place of an effect."""
    idle, without, holder = made(100.0, "level_error", parameters=0), made(100.0), made(50.0, "track_bump")
    assert C.decide(Rule.ADD, idle, without).because == "does not lower the BIC"
    swap = C.decide(Rule.SWAP, idle, without, Evidence(winner=idle, holder=holder))
    assert swap.because == "does not lower the BIC"


def test_a_pair_of_which_one_is_idle_is_told_from_one_that_explains_no_more() -> None:
    """Say that one of the two is not needed."""
    pair, one = made(90.0, "rolling_resistance", "level_error"), made(100.0, "directional_resistance")
    decision = C.decide(Rule.SPLIT, pair, one, Evidence(without=(made(91.0, "level_error"),)))
    assert decision.because == "the pair fits better, but one of its effects is not needed"


@pytest.mark.parametrize(
    ("score", "said"),
    [
        (40.0, "lowers the BIC by 60.0"),
        (50.5, "lowers the BIC by 49.5, 0.5 less than the effect that it would replace"),
        (99.5, "lowers the BIC by 0.5, 49.5 less than the effect that it would replace"),
        (100.5, "does not lower the BIC"),
    ],
)
def test_a_swap_is_told_by_what_it_gains_and_by_what_it_would_replace(score: float, said: str) -> None:
    """Say how far the best candidate is behind the effect that keeps its place."""
    holder, without, tried = made(50.0, "level_error"), made(100.0), made(score, "track_curvature")
    assert C.decide(Rule.SWAP, tried, without, Evidence(winner=tried, holder=holder)).because == said


def test_a_candidate_that_is_not_best_is_told_which_was() -> None:
    """Name what the best fit added last, in a round of additions or of swaps."""
    without, holder = made(100.0), made(50.0, "track_bump")
    best, second = made(40.0, "track_curvature", "level_error"), made(45.0, "track_curvature", "angle_gain")
    for rule in (Rule.ADD, Rule.SWAP):
        because = C.decide(rule, second, without, Evidence(winner=best, holder=holder)).because
        assert because == "lowers the BIC by 55.0, 5 less than level_error"


@pytest.mark.parametrize(("score", "said"), [(120.0, "does not lower the BIC"), (97.0, "lowers the BIC by 3.0")])
def test_a_candidate_whose_fit_was_not_continued_says_so(score: float, said: str) -> None:
    """Tell a candidate that a screening fit ruled out from one that was fitted to the end."""
    without, best = made(100.0), made(40.0, "level_error")
    for abandoned in (False, True):
        tried = replace(made(score, "track_curvature"), abandoned=abandoned)
        because = C.decide(Rule.ADD, tried, without, Evidence(winner=best)).because
        assert because.startswith(said)
        assert because.endswith(" (fit not continued)") is abandoned


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


@pytest.mark.parametrize(
    ("gain", "after", "said"),
    [
        (50.0, (9.0,), "lowers the BIC by 50"),
        (50.0, (11.0,), "lowers the BIC by 50, but fitted to some of the recordings it does not predict the others"),
        (10.0, (9.0,), "lowers the BIC by 10, too little"),
        (10.0, (11.0,), "lowers the BIC by 10, too little"),
    ],
)
def test_a_spline_term_is_told_by_its_gain_and_what_recurs(gain: float, after: tuple[float, ...], said: str) -> None:
    """Tell a gain that is too small from one that one recording alone has."""
    spline, without = with_gain(gain)
    evidence = Evidence(winner=spline, before=(10.0,), after=after)
    assert C.decide(Rule.SPLINE, spline, without, evidence).because == said


@pytest.mark.parametrize(("gain", "said"), [(7.0, "is needed beside the spline term"), (5.0, "is not needed beside")])
def test_an_effect_beside_a_spline_term_is_told_whether_it_pays(gain: float, said: str) -> None:
    """Say of an effect that the spline term does not contain whether it pays."""
    spline, without = with_gain(50.0)
    effect = made(C.value(spline) - gain, "level_error", spline=True, parameters=13)
    assert C.decide(Rule.ABSORB, effect, spline, Evidence(holder=without)).because.startswith(said)


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


def test_needed_separations_follow_from_the_thresholds() -> None:
    """Need √6 σ against a rival of as many parameters, less against a larger one; √(6 + k ln n) to be found at all."""
    found = made(50.0, "level_error")
    assert C.rival_separation(made(60.0, "track_bump"), found) == pytest.approx(math.sqrt(6.0))
    assert C.rival_separation(made(60.0, "track_bump", parameters=3), found) == 0.0
    assert C.detection_limit(READINGS, 2) == pytest.approx(math.sqrt(6.0 + 2.0 * PRICE))


@pytest.mark.parametrize("rule", [rule for rule in Rule if rule not in HELD_OUT])
def test_every_rule_decides_by_the_settings(rule: Rule) -> None:
    """Keep nothing of small gain where every threshold is infinite, and all of it where they are below."""
    tried = made(99.0, "level_error")
    against = made(100.0)
    evidence = Evidence(winner=tried, holder=against, without=(against,), before=(1.0, 1.0), after=(0.5, 0.5))
    loose = Settings(keep=-1e9, rival=-1e9, spline_keep=-1e9, pair_penalty=-1e9)
    strict = Settings(keep=1e9, rival=1e9, spline_keep=1e9, pair_penalty=1e9)
    decide: Callable[[Settings], bool] = lambda one: Criterion(one).decide(rule, tried, against, evidence).kept  # noqa: E731
    assert decide(loose) is (rule is not Rule.MERGE)  # which may be behind by the penalty, here a huge lead
    assert decide(strict) is (rule is Rule.MERGE)


def test_settings_have_a_meaning_and_a_reason_each() -> None:
    """Say of every field what it means, and why it is what it is."""
    for name, default, meaning, reason in Settings.described():
        assert getattr(DEFAULT, name) == default
        assert len(meaning) > 10
        assert len(reason) > 5
