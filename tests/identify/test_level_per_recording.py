"""A level that differs between recordings: found, told apart from one that all share, estimated anew where held out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import CATALOGUE
from harness.errors import InputError
from harness.identify.estimate.cross_validation import cross_validated, fit_without
from harness.identify.estimate.drawn import drawn_terms
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.forecast import forecast
from harness.identify.estimate.free_run_fit import fit_free_runs
from harness.identify.estimate.own_values import own_deviations, own_of
from harness.identify.estimate.predictions import as_predicted
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import PreparedRecording, Problem
from harness.identify.problem.windows import blocks_of, fitted_windows
from harness.identify.record import EffectRecord
from harness.identify.selection.candidates import candidates
from harness.identify.selection.search import Selection
from harness.identify.verdict import judge
from harness.preparation.declared_effects import declared_effects
from harness.preparation.recordings import observe
from harness.recording import Case, load_case
from harness.recording.known_rig import Declared
from harness.simulator import Experiment, write_case

SPREAD, NAME = 0.003, "level_per_recording"
EXPERIMENT = Experiment(hidden={NAME: {"spread": SPREAD}}, identify=3, predict=1, duration=8.0, seed=4)
LEVELS = [EXPERIMENT.plant(seed, EXPERIMENT.acting).rig.level_angle for seed in EXPERIMENT.seeds]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Three recordings to identify from and one to predict, each with a level of its own."""
    path: Path = tmp_path_factory.mktemp("levels") / "case"
    write_case(path, EXPERIMENT)
    return load_case(path)


@pytest.fixture(scope="module")
def problem(case: Case) -> Problem:
    """Of these recordings."""
    return problem_of(case)


@pytest.fixture(scope="module")
def found(problem: Problem) -> Fit:
    """A fit of the level of each recording."""
    return fit(problem, Hypothesis((NAME,)))


def test_virtual_rig_is_put_up_anew_for_each_recording() -> None:
    """Give the recordings to identify from levels of the mean 0 and the standard deviation that is asked for."""
    assert np.mean(LEVELS[:3]) == pytest.approx(0.0, abs=1e-15)
    assert np.std(LEVELS[:3]) == pytest.approx(SPREAD, rel=1e-12)
    assert len(set(LEVELS)) == 4


def test_fit_finds_the_level_of_every_recording(problem: Problem, found: Fit) -> None:
    """Estimate each level and their standard deviation within four of their own deviations."""
    errors = found.own_deviations(NAME)
    for recording, value, level in zip(problem.recordings, found.terms.own[NAME], LEVELS, strict=False):
        assert value == pytest.approx(level, abs=4.0 * errors[recording.name])
        assert errors[recording.name] < 0.02 * SPREAD
    (acting,) = found.terms.effects
    error = found.deviations()[NAME, "spread"]
    assert acting.values["spread"] == pytest.approx(SPREAD, abs=4.0 * error)
    # the standard deviation of three values that are independent is as uncertain as each is, over √3
    assert error == pytest.approx(np.sqrt(np.mean(np.square(list(errors.values())))) / np.sqrt(3.0), rel=0.5)


def test_before_its_ball_rolls_a_level_is_the_mean_of_the_others(case: Case, problem: Problem, found: Fit) -> None:
    """Expect of a recording of which nothing is known what the others say of it, and be as unsure as they differ."""
    last = PreparedRecording.of(observe(case.recordings[case.predict[0]], case.sensors, problem.rig))
    nothing = np.where(np.arange(len(last.reading)) < 2, last.reading, np.nan)  # two readings, 10 ms apart
    own = own_of(problem, found, last, nothing)
    levels = found.terms.own[NAME]
    assert own.values[NAME] == pytest.approx(np.mean(levels), abs=1e-5)
    # Student's t of two degrees of freedom, at its mode: s √(1 + 1/n) √((n − 1)/n), by differences that reach one width
    expected = np.std(levels, ddof=1) * np.sqrt((1.0 + 1.0 / 3.0) * 2.0 / 3.0)
    assert own_deviations(problem, found, last, nothing, own).values[NAME] == pytest.approx(expected, rel=0.3)


def test_a_held_out_recording_gets_its_own_level(case: Case, problem: Problem, found: Fit) -> None:
    """Estimate the level of a recording that was not fitted from its readings, and keep those that were."""
    last = PreparedRecording.of(observe(case.recordings[case.predict[0]], case.sensors, problem.rig))
    own = own_of(problem, found, last, last.reading)
    # as those that were fitted, each of which is known to a hundredth of the spread
    assert own.values[NAME] == pytest.approx(LEVELS[3], abs=0.02 * SPREAD)
    kept = own_of(problem, found, problem.recordings[1], np.full_like(problem.recordings[1].reading, np.nan))
    assert kept.values[NAME] == found.terms.own[NAME][1]


def test_a_prediction_is_as_unsure_as_its_level(case: Case, problem: Problem, found: Fit) -> None:
    """Hold what happens in the band, which widens by what 1.5 s of positions leave open of the level."""
    last = PreparedRecording.of(observe(case.recordings[case.predict[0]], case.sensors, problem.rig))
    own = own_of(problem, found, last, last.reading)
    deviation = own_deviations(problem, found, last, last.reading, own).values[NAME]
    assert abs(own.values[NAME] - LEVELS[3]) < 4.0 * deviation
    predicted = forecast(problem, found, last, last.reading)
    error = EXPERIMENT.recordings()[3].noiseless - predicted.position
    assert np.all(np.abs(error) < 4.0 * predicted.deviation + 1e-4)  # and a step of the record
    # A level that is wrong by δ moves the ball by K g δ t²/2; the start, estimated with it, takes a part of that back.
    ahead = last.time[-1] - last.time[np.isfinite(last.reading)][-1]
    assert predicted.deviation[-1] > 0.5 * problem.rig.rolling_ratio * problem.rig.gravity * deviation * ahead**2 / 2.0


def test_what_all_recordings_share_goes_to_the_common_level(problem: Problem) -> None:
    """Leave recordings their deviations alone where a common level is fitted too, as for a rig of unknown level."""
    both = fit(problem, Hypothesis(("level_error", NAME)))
    shifted = replace(problem, rig=problem.rig.with_(level_angle=0.01))
    moved = fit(shifted, Hypothesis(("level_error", NAME)))
    # the prior of 0.02 rad pulls each deviation towards zero, and so the mean of all: the common level takes it
    for one, common in ((both, 0.0), (moved, -0.01)):
        level, each = one.terms.effects[0].values["angle"], one.terms.own[NAME]
        np.testing.assert_allclose(level + each, np.array(LEVELS[:3]) + common, rtol=0.0, atol=0.02 * SPREAD)
        assert np.mean(each) == pytest.approx(0.0, abs=0.02 * SPREAD)


def test_result_has_the_level_of_every_recording(problem: Problem, found: Fit) -> None:
    """Give the standard deviation as the effect's parameter, and each level with its interval beside it."""
    base = fit(problem, Hypothesis(()))
    (effect,) = judge(Selection(problem, base, found, ())).effects
    record = EffectRecord.model_validate(effect)
    assert list(record.parameters) == ["spread"]
    assert list(record.by_recording) == [recording.name for recording in problem.recordings]
    for level, one in zip(LEVELS, record.by_recording.values(), strict=False):
        assert one.low is not None
        assert one.high is not None
        # the interval of two deviations, twice as wide
        assert abs(one.value - level) < one.high - one.low
        assert one.unit == "rad"


def test_one_recording_cannot_differ_from_itself(problem: Problem) -> None:
    """Try it only where there are two recordings."""
    assert NAME in candidates(problem)
    assert NAME not in candidates(replace(problem, recordings=problem.recordings[:1]))


def test_it_cannot_be_declared(case: Case) -> None:
    """Refuse a declared spread, which would not say which recording has which level."""
    declared = Declared(NAME, {"spread": 0.003})
    with pytest.raises(InputError, match="in each recording and cannot be declared"):
        declared_effects(replace(case, declared=(declared,)))
    assert CATALOGUE[NAME].by_recording is not None


def test_held_out_blocks_are_foreseen_by_fits_to_fewer_recordings(problem: Problem) -> None:
    """Draw the parameters of a fit that has levels of some recordings alone, and calibrate the band by its errors."""
    whole = fit_free_runs(problem, Hypothesis((NAME,)), fitted_windows(problem.recordings)).fit
    found = as_predicted(problem, cross_validated(problem, whole))
    # In some of them the ball goes farther than in those that are fitted to, where its prediction stays.
    assert np.isclose(found.forecast_errors, found.held_out, rtol=0.05).sum() >= len(found.held_out) // 2
    part = fit_without(problem, whole, blocks_of(problem.recordings)[0].fitted)
    assert len(part.terms.recordings) < len(problem.recordings)
    drawn = list(drawn_terms(problem, part, 3, np.random.default_rng(0)))
    assert [one.recordings for one in drawn] == 3 * [part.terms.recordings]
