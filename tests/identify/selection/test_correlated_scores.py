"""An effect that gains by correlated innovations alone is taken back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.correlated_scores import score_weights, without_correlated
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from tests.identify.selection.made import PRICE, made
from tests.posed import Posed

GAIN = "position_gain"
RIPPLE, LENGTH = 1e-3, 0.03  # of a worn track: error of the position [m] and its wavelength [m]


def on_worn_track(problem: Problem, phase: float) -> Problem:
    """The same with positions from a track that is worn in ripples, an error that no noise is."""

    def worn(reading: FloatArray) -> FloatArray:
        return reading + RIPPLE * np.sin(2.0 * np.pi * reading / LENGTH + phase)

    return replace(problem, recordings=tuple(replace(one, reading=worn(one.reading)) for one in problem.recordings))


@pytest.mark.parametrize("name", [GAIN, "viscous_damping", "track_curvature"])
def test_scores_of_a_complete_model_are_not_correlated(plain: Posed, name: str) -> None:
    """Weigh a gain as the likelihood does where innovations are independent."""
    assert score_weights(plain.problem, fit(plain.problem, Hypothesis((name,))), [name]) == {name: 1.0}


@pytest.mark.parametrize("phase", [0.0, 2.0, 4.0])
def test_a_worn_track_correlates_the_score_of_a_gain(plain: Posed, phase: float) -> None:
    """See that the gain of positions is less sure by far than the likelihood says: passes repeat the track's error."""
    problem = on_worn_track(plain.problem, phase)
    # Some eight passes in 32 s, each with the same error: a variance that is as many times as large, at least.
    assert score_weights(problem, fit(problem, Hypothesis((GAIN,))), [GAIN])[GAIN] > 8.0


def test_an_effect_that_correlated_scores_feign_is_taken_back(plain: Posed, monkeypatch: pytest.MonkeyPatch) -> None:
    """Drop it, say why in the ledger, and keep one whose score is not correlated."""
    problem = plain.problem
    found = fit(problem, Hypothesis((GAIN, "viscous_damping")))
    weights = {GAIN: 3.0, "viscous_damping": 1.0}
    monkeypatch.setattr(
        "harness.identify.selection.correlated_scores.score_weights", lambda problem, found, names: weights
    )
    ledger = Ledger(Criterion(problem.settings))
    left: Fit = without_correlated(problem, found, ledger, lambda _: None)
    assert left.hypothesis.names == ("viscous_damping",)
    (line,) = ledger.lines
    assert line.rule is Rule.CORRELATED
    assert line.effects == (GAIN,)
    assert "its score is correlated, with 3.0 times the variance supposed, too little" in line.because


@pytest.mark.parametrize(("weight", "kept"), [(1.5, True), (2.0, False)])
def test_the_gain_in_deviance_is_divided_before_its_price_is_paid(weight: float, kept: bool) -> None:
    """Keep what is worth 6 after the price of its parameter, from a deviance over the weight of the score."""
    criterion = Criterion()
    deviance = 1.75 * (criterion.settings.keep + PRICE)
    tried, without = made(PRICE - deviance, GAIN), made(0.0)
    decision = criterion.decide(Rule.CORRELATED, tried, without, Evidence(weight=weight))
    assert decision.kept is kept
    assert decision.gain == pytest.approx(deviance - PRICE)
