"""The answer in words follows from the numbers."""

from dataclasses import replace

import numpy as np
import pytest

from harness.report.answer import EngineFact, Facts, sentences
from harness.report.standing import Standing

BEST = Standing("friction_viscous", 0.0100, 0.0012, separated=False, same=True)
CAM = Standing("cam", 0.0300, 0.0020, separated=True, same=False)
MUJOCO = Standing("mujoco", 0.0300, 0.0020, separated=True, same=False)
ENGINE = EngineFact("mujoco", 2e-6, 1e-6, 1e-6)
FACTS = Facts(
    recording="the recording",
    case="my_case",
    seconds=2.0,
    duration=16.0,
    standings=[BEST, CAM, MUJOCO],
    over_uncertainty=5.4,
    u_val=0.0018,
    still=0.050,
    end_u_val=0.200,
    motion=0.080,
    engines=[ENGINE],
)


def said(**changes) -> str:
    """The answer to changed facts, as one text."""
    return " ".join(sentences(replace(FACTS, **changes)))


def test_two_to_four_sentences():
    """Say it in at most four sentences, each with a capital and a full stop."""
    answer = sentences(FACTS)
    assert 2 <= len(answer) <= 4
    assert all(text[0].isupper() and text.endswith(".") for text in answer)


def test_the_closest_source_with_its_error():
    """Name the closest source, its RMS error with standard error, and the horizon."""
    first = sentences(FACTS)[0]
    assert "Friction (viscous) is closest to the recording over windows of 2 s: 10.0 ± 1.2 mm RMS" in first
    assert "significantly less than the next, CAM (30.0 mm)" in first


def test_rivals_that_cannot_be_told_apart_are_named():
    """Name sources within the recording's uncertainty, and claim no significant difference from them."""
    text = said(standings=[BEST, replace(CAM, separated=False), replace(MUJOCO, separated=False)])
    assert "CAM and MuJoCo cannot be distinguished from it" in text
    assert "significantly less" not in text


def test_sources_of_equal_motion_are_one_answer():
    """Name all sources that give the same motion."""
    alike = [replace(CAM, same=True, separated=False), replace(MUJOCO, same=True, separated=False)]
    text = said(standings=[*alike, replace(BEST, same=False, rms=0.04)], still=0.2)
    assert "CAM and MuJoCo are closest" in text
    assert "both give the same motion" in text


@pytest.mark.parametrize(
    ("rms", "words"), [(0.077, "more than a stationary"), (0.040, "not much less than a stationary")]
)
def test_no_source_is_praised_for_standing_still(rms, words):
    """Recommend no model if the closest is hardly better than a stationary ball."""
    text = said(standings=[replace(BEST, rms=rms), CAM], shorter=(1.0, "cam", 0.004))
    assert "No source follows the recording over windows of 2 s" in text
    assert words in text
    assert "over windows of 1 s the closest is CAM with 4.00 mm" in text


def test_error_beyond_uncertainty_asks_for_a_diagnosis():
    """Report missing physics, and the command that identifies it, if the error exceeds 2 u_val."""
    assert "lack physics" in said()
    assert "`harness diagnose my_case`" in said()


def test_error_within_uncertainty_asks_for_nothing():
    """Report no missing physics if E/u_val is about 1."""
    text = said(over_uncertainty=1.1)
    assert "no evidence against it" in text
    assert "diagnose" not in text


def test_declared_effects_are_owned_up_to():
    """Name the declared effects that do not explain the error."""
    assert "beyond the declared rolling resistance" in said(declared=["rolling_resistance"])


def test_engines_that_agree_with_cam():
    """Report how closely the engines agree with CAM."""
    assert "MuJoCo agrees with CAM within 2.0 µm" in said()


@pytest.mark.parametrize(
    ("engine", "advice"),
    [
        (EngineFact("mujoco", 5e-3, 4e-3, 1e-4), "reduce it"),
        (EngineFact("mujoco", 5e-3, 1e-4, 4e-3), "its contact model (stiffen it)"),
        (
            EngineFact("mujoco", 5e-3, 1e-4, 4e-3, scene="beam.xml"),
            "the geometry or the contacts of beam.xml (`harness check-scene my_case`)",
        ),
        (
            EngineFact("mujoco", 5e-3, 1e-4, 4e-3, chosen=("`rolling_friction` of 0.001",)),
            "its contact model with its `rolling_friction` of 0.001.",
        ),
    ],
)
def test_engines_that_depart_from_cam(engine, advice):
    """Report an engine's difference from CAM, its main part, and the remedy."""
    text = said(engines=[engine])
    assert "MuJoCo differs from CAM by up to 5.0 mm" in text
    assert advice in text
    assert "agrees" not in text


def test_a_failed_engine_is_named():
    """Name an engine that failed, with its advice."""
    text = said(engines=[EngineFact("mujoco", np.nan, failed="at t = 0.3 s: the ball left the groove")])
    assert "MuJoCo failed: at t = 0.3 s: the ball left the groove" in text


def test_why_the_free_run_counts_or_not():
    """Explain the headline horizon: u_val exceeds the ball's own motion, or not."""
    assert "is not informative" in said()
    assert "200 mm" in said()
    assert "80.0 mm RMS of the ball's own motion" in said()
    assert "is informative" in said(seconds=None, end_u_val=0.020)


def test_no_finite_motion_at_all():
    """Report that all sources diverge."""
    answer = sentences(replace(FACTS, standings=[replace(BEST, rms=np.inf)]))
    assert answer[0] == "All sources diverge over windows of 2 s."


def test_the_ratio_to_the_uncertainty_is_told_as_that_of_single_instants():
    """Not call it the quotient of the two RMS values beside it, which it is not."""
    assert "Instant by instant its error is 5.4 times (RMS) the uncertainty of angle, start and sensor" in said()
