"""The verdict in words."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analytic.effects import CATALOGUE
from analytic.rig import Rig
from harness.identify.diagnosis import Diagnosis
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.hypothesis import Hypothesis, Terms
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.validation.baseline_comparison import (
    AFTER,
    BASELINES,
    BEFORE,
    FORECASTS,
    BaselineComparison,
)
from harness.identify.validation.held_out import BeforeAfter, Errors
from harness.identify.verdict import Estimate, IdentifiedEffect, Verdict
from harness.report.wording import DEPENDENCES, error_size, phrase, sentence
from tests.posed import Posed

ROLLING = IdentifiedEffect("rolling_resistance", {"coefficient": Estimate(0.0041, 0.0037, 0.0045, "1")}, ())
LEVEL = IdentifiedEffect("level_error", {"angle": Estimate(-0.0025, -0.00251, -0.00249, "rad")}, ())


def said(posed: Posed, verdict: Verdict, findings: tuple[IdentifiedEffect, ...] = (), **changes: Any) -> str:
    """The sentence of a diagnosis with these findings, whose held-out error over 3 s falls from 174 to 0.3 mm."""
    names = tuple(one.name for one in findings)
    at = Terms(recordings=(), effects=(), phases=np.zeros(2), spline=changes.get("spline"))
    process_noise = (changes.get("left", 1.0) * posed.problem.angle_floor) ** 2
    found = Fit(
        Hypothesis(names, at.spline), np.zeros(0), at, process_noise, 0.0, np.zeros((0, 0)), posed.problem.readings,
        estimator=changes.get("estimator", Estimator.LIKELIHOOD),
    )  # fmt: skip
    rms = changes.get("rms", ({"1 s": 0.02, "3 s": 0.174, "whole": 17.0}, {"1 s": 0.0002, "3 s": 0.0003, "whole": 9.0}))
    heldout = BeforeAfter(*(Errors(one, 0.0, 1.0) for one in rms))
    unseen = changes.get("unseen", ())
    diagnosis = Diagnosis(
        posed.problem, verdict, findings, found, found, (), unseen, identify=heldout, heldout=heldout, engines={}
    )
    common = changes.get("common")
    forecasting = None if common is None else replace(found, hypothesis=Hypothesis(common))
    return sentence(replace(diagnosis, baselines=changes.get("baselines"), forecasting=forecasting))


def test_one_effect(plain: Posed) -> None:
    """Name it in words, with its size and what it brings."""
    assert said(plain, Verdict.EFFECT, (ROLLING,)) == (
        "A rolling resistance of 0.0041 ± 0.0004 was missing; the held-out error over 3 s decreases from 174 mm to "
        "0.30 mm."
    )


def test_two_effects_and_a_rival(plain: Posed) -> None:
    """Say both, angles in degrees, and what one of them cannot be told from."""
    level = IdentifiedEffect("level_error", LEVEL.parameters, ("track_curvature",))
    assert said(plain, Verdict.EFFECT, (ROLLING, level)) == (
        "A rolling resistance of 0.0041 ± 0.0004 and a level error of −0.1432 ± 0.0006° (indistinguishable from "
        "track curvature) were missing; the held-out error over 3 s decreases from 174 mm to 0.30 mm."
    )


def test_rivals_that_act_together_are_said_to(plain: Posed) -> None:
    """Name effects that explain as much only together as a pair, and those that do alone before it."""
    pair = ("level_error", "rolling_resistance")
    rivals = (*pair, "stribeck_friction")
    level = IdentifiedEffect("level_error", LEVEL.parameters, rivals, together=(pair,))
    assert level.rivals == (("stribeck_friction",), pair)
    told = said(plain, Verdict.EFFECT, (level,))
    assert "(indistinguishable from stribeck friction or level error and rolling resistance together)" in told


def test_a_bending_that_shaking_would_do_is_called_so(plain: Posed) -> None:
    """Say of a beam that hardly bends that one which shakes does as much, and nothing of one that bends."""

    def bent(compliance: float) -> str:
        size = Estimate(compliance, 0.9 * compliance, 1.1 * compliance, "rad/(N m)")
        return said(plain, Verdict.EFFECT, (IdentifiedEffect("beam_compliance", {"compliance": size}, ()),))

    assert "(a beam that shakes between the readings of its angle, as fast as they show, does as much)" in bent(1e-6)
    assert "shakes" not in bent(0.05)


def test_an_implausible_size_is_called_so(plain: Posed) -> None:
    """Say of a friction that would hold the ball on a steep beam, and of a small gain, that it is implausible."""
    steep = IdentifiedEffect(
        "rolling_resistance",
        {"coefficient": Estimate(0.12, 0.11, 0.13, "1")},
        ("stribeck_friction",),
        {},
        ("coefficient",),
    )
    gain = IdentifiedEffect("angle_gain", {"gain": Estimate(0.3, 0.29, 0.31, "1")}, (), {}, ("gain",))
    assert said(plain, Verdict.EFFECT, (steep,)).startswith(
        "A rolling resistance of 0.120 ± 0.010 (indistinguishable from stribeck friction), which is implausibly large "
        "for a rolling resistance, was missing; the held-out error"
    )
    assert said(plain, Verdict.EFFECT, (gain, ROLLING)).startswith(
        "A gain of 0.300 ± 0.010 between measured and real beam angle, which is implausibly small for an angle gain, "
        "and a rolling resistance of 0.0041 ± 0.0004 were missing;"
    )
    nodes = np.full(12, 0.3)
    text = said(plain, Verdict.UNLISTED, spline=SplineTerm(Regressor.POSITION, True, 0.0, 0.1, nodes))
    assert "(by up to 0.30 of the normal force, which is implausibly large for a ball that rolls)" in text


def test_an_effect_that_may_be_none_and_a_bound_are_told(plain: Posed) -> None:
    """Say that the interval of an effect holds none, and that a parameter ended where the search does."""
    delay = IdentifiedEffect("channel_delay", {"delay": Estimate(0.26, -0.02, 0.54, "s")}, ("position_lag",))
    servo = IdentifiedEffect(
        "angle_servo", {"lag": Estimate(0.24, 0.2, 0.28, "s"), "damping": Estimate(0.2, 0.15, 0.25, "1")}, ()
    )
    text = said(plain, Verdict.EFFECT, (delay, servo))
    assert "(indistinguishable from position lag; the interval of its delay holds no effect too)" in text
    assert "(its damping is at the end of the range tried)" in text


@pytest.mark.parametrize(
    ("after", "at_rest", "told"),
    [
        ((0.04, 0.05, 0.03, 0.04, 0.05), 0.02, "; but a ball at rest predicts better (20.0 mm over held-out blocks, "),
        ((0.01, 0.09, 0.01, 0.07, 0.02), 0.06, "; it is not sure that this predicts better than a ball at rest does"),
        ((0.01, 0.02, 0.01, 0.01, 0.02), 0.06, None),
    ],
)
def test_a_model_that_is_no_better_than_no_physics_is_called_so(
    plain: Posed, after: tuple[float, ...], at_rest: float, told: str | None
) -> None:
    """Say beside what an effect brings that a ball at rest is predicted better, or as well for all that is sure."""
    errors = {name: np.full(5, 0.2) for name in (BEFORE, *BASELINES)}
    errors |= {AFTER: np.array(after), "at_rest": np.full(5, at_rest), "output_error_2": np.full(5, 0.001)}
    text = said(plain, Verdict.EFFECT, (ROLLING,), baselines=BaselineComparison(errors))
    assert (told in text) if told else text.endswith("decreases from 174 mm to 0.30 mm.")


@pytest.mark.parametrize(
    ("verdict", "findings"),
    [(Verdict.EFFECT, (ROLLING,)), (Verdict.NOT_IDENTIFIABLE, ()), (Verdict.NONE, ())],
)
def test_parameters_for_predictions_are_told(
    plain: Posed, verdict: Verdict, findings: tuple[IdentifiedEffect, ...]
) -> None:
    """Say that predictions use parameters fitted to forecasts, and hold these against a ball at rest."""
    errors = {name: np.full(5, 0.2) for name in (BEFORE, *BASELINES)}
    errors |= {AFTER: np.full(5, 0.04), FORECASTS: np.full(5, 0.03), "at_rest": np.full(5, 0.035)}
    text = said(plain, verdict, findings, baselines=BaselineComparison(errors))
    told = "; predictions use parameters fitted to forecasts (30.0 mm over held-out blocks, 40.0 mm without)."
    assert text.endswith(told)
    text = said(
        plain, verdict, findings, baselines=BaselineComparison(errors), common=(ROLLING.name, "viscous_damping")
    )
    assert (
        "; predictions use all effects that are common on measured rigs, together fitted to forecasts (30.0 mm" in text
    )
    text = said(
        plain, verdict, findings, baselines=BaselineComparison(errors), common=tuple(one.name for one in findings)
    )
    assert "; predictions use a process noise fitted to forecasts (30.0 mm" in text
    worse = errors | {"at_rest": np.full(5, 0.02)}
    text = said(plain, Verdict.EFFECT, (ROLLING,), baselines=BaselineComparison(worse))
    assert text.endswith("40.0 mm without); but a ball at rest predicts better (20.0 mm).")


@pytest.mark.parametrize("friction", [False, True])
@pytest.mark.parametrize("depends", Regressor)
def test_a_spline_term(plain: Posed, depends: Regressor, friction: bool) -> None:
    """Say what an unlisted law depends on, how large it gets, and what acts beside it."""
    nodes = np.zeros(12)
    nodes[4] = -0.05
    text = said(plain, Verdict.UNLISTED, (ROLLING,), spline=SplineTerm(depends, friction, 0.0, 0.1, nodes))
    assert DEPENDENCES[depends] in text
    force = 1e3 * plain.problem.rig.mass * 0.05
    assert ("0.050 of the normal force" if friction else f"up to {force:.1f} mN") in text
    assert "beside a rolling resistance of 0.0041 ± 0.0004; the held-out error over 3 s decreases" in text


def test_nothing(plain: Posed) -> None:
    """Report that nothing was found, and the held-out error."""
    text = said(plain, Verdict.NONE)
    assert text.startswith("No missing effect was found")
    assert text.endswith("the held-out error over 3 s is 174 mm.")


def test_what_cannot_be_told(plain: Posed) -> None:
    """Name effects below the detection limit, and count further ones."""
    unseen = ("rolling_resistance", "level_error", "track_bump", "angle_gain", "contact_slip", "position_lag", "x", "y")
    assert "rolling resistance, level error, track bump, angle gain, contact slip and 3 more" in said(
        plain, Verdict.NOT_IDENTIFIABLE, unseen=unseen
    )


def test_what_is_left_unexplained(plain: Posed) -> None:
    """Report process noise far above its floor; where it is not, what could not be detected is the reason."""
    text = said(plain, Verdict.NOT_IDENTIFIABLE, left=54.0)
    assert "the process noise is 54 times its floor" in text
    assert "no law that was tried" in text
    by_free_runs = said(plain, Verdict.NOT_IDENTIFIABLE, left=0.4, estimator=Estimator.FREE_RUNS)
    assert "physics is missing, by the process noise, but no law" in by_free_runs
    seen_too_little = said(plain, Verdict.NOT_IDENTIFIABLE, left=5.0, unseen=("track_bump",))
    assert "track bump would be below the detection limit" in seen_too_little


def test_short_recordings_tell_what_they_can(plain: Posed) -> None:
    """Use windows of 3 s, else the longest shorter ones, else the rest; name an increase as such."""
    longer = {"1 s": 0.02, "2 s": 0.03, "3 s": 0.04, "5 s": 0.09, "whole": 17.0}
    assert "over 3 s is 40.0 mm" in said(plain, Verdict.NONE, rms=(longer, longer))
    shorter = {"1 s": 0.02, "2 s": 0.03, "whole": 0.04}
    assert "over 2 s is 30.0 mm" in said(plain, Verdict.NONE, rms=(shorter, shorter))
    window = said(plain, Verdict.EFFECT, (ROLLING,), rms=({"1 s": 0.02}, {"1 s": 0.001}))
    assert "the held-out error over 1 s decreases from 20.0 mm to 1.0 mm" in window
    assert "too short" in said(plain, Verdict.EFFECT, (ROLLING,), rms=({}, {}))
    assert "the held-out error increases from 1.0 mm to" in said(
        plain, Verdict.EFFECT, (ROLLING,), rms=({"whole": 0.001}, {"whole": 0.002})
    )


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_effect_has_words(name: str) -> None:
    """Say every effect with each of its values once, its interval, and no underscore."""
    values = {
        one.name: Estimate(one.typical, one.typical * 0.9, one.typical * 1.1, one.unit)
        for one in CATALOGUE[name].parameters
    }
    text = phrase(IdentifiedEffect(name, values, ()), Rig())
    assert text.count("±") == len(values)
    assert "_" not in text
    assert "{" not in text


def test_an_effect_of_ones_own_has_words_too() -> None:
    """Say an effect that nobody wrote a phrase for by its name and parameters."""
    own = IdentifiedEffect("air_cushion", {"lift_force": Estimate(0.01, 0.009, 0.011, "N")}, ())
    assert phrase(own, Rig()) == "an air cushion (lift force 0.0100 ± 0.0010 N)"


def test_errors_have_fitting_units() -> None:
    """Say errors in millimetres, from a metre on in metres."""
    assert [error_size(one) for one in (0.00035, 0.0041, 0.0174, 0.174, 0.9996, 1.71)] == [
        "0.35 mm", "4.1 mm", "17.4 mm", "174 mm", "1.00 m", "1.71 m"
    ]  # fmt: skip
