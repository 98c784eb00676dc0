"""The criterion's reasons in words, by numbers alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence, Rule
from tests.identify.selection.made import made, with_gain

C = Criterion()


def test_a_gain_below_the_threshold_is_called_too_little() -> None:
    """Say that a small gain of the best candidate is too little."""
    tried = made(97.0, "level_error")
    assert "too little" in C.decide(Rule.ADD, tried, made(100.0), Evidence(winner=tried)).because


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
