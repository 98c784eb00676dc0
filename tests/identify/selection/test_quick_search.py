"""A quick search on coarse data tells what the whole search could explain from what it could not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.identify.estimate.fit import fit
from harness.identify.filter.run import deviance
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.quick_search import QuickSearch, on_all_readings, without_stepwise
from harness.identify.selection.stepwise import first_round
from harness.recording import load_case
from tests.posed import pose
from tests.pushed import with_random_accelerations


@pytest.fixture(scope="module")
def shaken(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A ball that random accelerations move by a decimetre, which no law explains."""
    problem = pose(tmp_path_factory.mktemp("shaken") / "case", 3).problem
    settings = replace(problem.settings, given_up_from=100)  # coarse readings: these recordings are short
    return replace(with_random_accelerations(problem, 3e-3), settings=settings)


@pytest.mark.slow
def test_what_effects_explain_is_left_to_the_stepwise_search(tmp_path: Path) -> None:
    """Say nothing where effects of the catalogue bring the process noise to the floor, the first of them or more."""
    hidden = {"rolling_resistance": {"coefficient": 0.006}, "level_error": {"angle": 0.01}}
    problem = pose(tmp_path / "case", 3, hidden).problem
    base, first = (fit(problem, Hypothesis(names)) for names in ((), ("rolling_resistance",)))
    told: list[str] = []
    assert without_stepwise(problem, base, first, told.append) is None
    assert any("rolling_resistance + level_error" in text for text in told)
    both = fit(problem, Hypothesis(tuple(hidden)), initial=first.values())
    assert without_stepwise(problem, base, both, told.append) is None


def test_coarse_data_that_are_all_data_are_not_searched_first(shaken: Problem) -> None:
    """Compute nothing where it would be the whole search once more."""
    coarse = shaken.coarse
    told: list[str] = []
    base = fit(coarse, Hypothesis(()))
    assert without_stepwise(coarse, base, base, told.append) is None
    assert told == []


@pytest.mark.slow
def test_coarse_data_are_searched_first_wherever_predictions_are_poor(shaken: Problem) -> None:
    """Need no certain distance from the noise floor: minutes of a search on all readings would hang on a hair."""
    near = replace(shaken, settings=replace(shaken.settings, above_floor_ratio=1e6))
    base = fit(near, Hypothesis(()))
    assert without_stepwise(near, base, base, lambda _: None) is not None


@pytest.mark.slow
def test_where_little_can_be_explained_one_round_is_enough(shaken: Problem) -> None:
    """Weigh each candidate on all readings, once, and what is best by what it explains; return a fit to all of them."""
    ledger = Ledger(Criterion(shaken.settings))
    base = fit(shaken, Hypothesis(()))
    first = first_round(shaken, base, ledger, lambda _: None).kept or base
    quick = without_stepwise(shaken, base, first, lambda _: None)
    assert quick is not None
    assert not quick.spline
    best = on_all_readings(shaken, quick, base, first, ledger, lambda _: None)
    added = [line for line in ledger.lines if line.rule is Rule.ADD]
    assert {line.title for line in added} == set(candidates(shaken))
    assert all(line.fit.readings == shaken.readings for line in added)
    (weighed,) = (line for line in ledger.lines if line.rule is Rule.EXPLAIN)
    assert ledger.criterion.value(weighed.fit) <= ledger.criterion.value(first)
    assert weighed.kept is bool(weighed.fit.process_noise < 0.75 * base.process_noise)
    assert best is (weighed.fit if weighed.kept else base)
    assert best.deviance == pytest.approx(deviance(shaken, best.terms, best.process_noise), rel=1e-9)


def test_what_gains_much_and_explains_little_is_not_kept(shaken: Problem) -> None:
    """Return to the fit without effects, whatever likelihood gains, unless the process noise is less by a quarter."""
    base = fit(shaken, Hypothesis(()))
    gains = replace(fit(shaken, Hypothesis(("viscous_damping",))), deviance=base.deviance - 500.0)
    for share, kept in ((0.9, False), (0.5, True)):
        ledger = Ledger(Criterion(shaken.settings))
        first = replace(gains, process_noise=share * base.process_noise)
        best = on_all_readings(shaken, QuickSearch(base, spline=False), base, first, ledger, lambda _: None)
        (line,) = ledger.lines
        assert (line.rule, line.effects, line.kept) == (Rule.EXPLAIN, ("viscous_damping",), kept)
        assert best is (first if kept else base)


@pytest.mark.slow
def test_a_spline_term_that_explains_what_effects_do_not_ends_the_stepwise_search(shared: Path) -> None:
    """See on coarse data that no effects imitate a gust of wind, and leave its curve to all readings."""
    problem = problem_of(load_case(shared / "cases" / "unlisted_wind"))
    base = fit(problem, Hypothesis(()))
    first = first_round(problem, base, Ledger(Criterion(problem.settings)), lambda _: None).kept or base
    quick = without_stepwise(problem, base, first, lambda _: None)
    assert quick is not None
    assert quick.spline
    assert quick.found.hypothesis.spline is None


def test_coarse_recordings_keep_their_readings_and_their_errors(shaken: Problem) -> None:
    """Take a reading a cell of 40 ms, as it was read, with the covariance that the angle's error has then."""
    coarse, whole = shaken.coarse.recordings[0], shaken.recordings[0]
    kept = np.searchsorted(whole.time, coarse.time)
    np.testing.assert_array_equal(coarse.reading, whole.reading[kept])
    np.testing.assert_array_equal(coarse.error.covariance, whole.error.covariance[kept])
    assert np.min(np.diff(coarse.time)) > 0.03  # stamps every 10 ms: four, or three at the edge of a cell
    assert shaken.coarse.steps < 0.3 * shaken.steps


def test_a_quick_search_takes_a_minute_of_recordings_at_most(shaken: Problem) -> None:
    """Choose recordings from first to last, two at least."""
    many = replace(shaken, recordings=shaken.recordings * 5)
    assert sum(one.time[-1] - one.time[0] for one in many.coarse.recordings) <= 60.0
    assert len(many.coarse.recordings) == 3
    long = replace(shaken.recordings[0], time=100.0 * shaken.recordings[0].time)
    assert len(replace(shaken, recordings=(long, long, long)).coarse.recordings) == 2
