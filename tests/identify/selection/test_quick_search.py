"""A quick search on coarse data tells what the whole search could explain from what it could not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.identify.estimate.fit import fit
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates
from harness.identify.selection.criterion import Criterion, Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.quick_search import first_round, unexplained
from tests.coloured import with_coloured_readings
from tests.posed import pose

SHORT = 100  # integration steps from which a quick search is made here


def always(problem: Problem) -> Problem:
    """The same, with a quick search however short the recordings are."""
    return replace(problem, settings=replace(problem.settings, quick_search_from=SHORT))


@pytest.fixture(scope="module")
def dirty(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Positions of a sensor whose error wanders by a centimetre, which no effect on ball or beam explains."""
    problem = pose(tmp_path_factory.mktemp("dirty") / "case", 3).problem
    return always(with_coloured_readings(problem, 0.9, 4e-3))


def test_what_one_effect_explains_is_left_to_the_whole_search(tmp_path: Path) -> None:
    """Say nothing where an effect of the catalogue brings predictions near the readings."""
    problem = always(pose(tmp_path / "case", 3, {"rolling_resistance": {"coefficient": 0.006}}).problem)
    assert unexplained(problem, fit(problem, Hypothesis(())), lambda _: None) is None


def test_short_recordings_are_searched_in_any_case(dirty: Problem) -> None:
    """Compute nothing where the whole search is short."""
    problem = replace(dirty, settings=replace(dirty.settings, quick_search_from=1_000_000))
    told: list[str] = []
    assert unexplained(problem, fit(problem, Hypothesis(())), told.append) is None
    assert told == []


def test_where_little_can_be_explained_one_round_is_enough(dirty: Problem) -> None:
    """Weigh each candidate on all readings, once, and return a fit to all of them."""
    base = fit(dirty, Hypothesis(()))
    quick = unexplained(dirty, base, lambda _: None)
    assert quick is not None
    ledger = Ledger(Criterion(dirty.settings))
    best = first_round(dirty, base, quick, ledger, lambda _: None)
    assert {line.title for line in ledger.lines} == set(candidates(dirty))
    assert all(line.rule is Rule.ADD and line.fit.readings == dirty.readings for line in ledger.lines)
    assert best.deviance == pytest.approx(deviance(dirty, best.terms, best.process_noise), rel=1e-9)


def test_coarse_recordings_keep_their_readings_and_their_errors(dirty: Problem) -> None:
    """Take a reading a cell of 40 ms, as it was read, with the covariance that the angle's error has then."""
    coarse, whole = dirty.coarse.recordings[0], dirty.recordings[0]
    kept = np.searchsorted(whole.time, coarse.time)
    np.testing.assert_array_equal(coarse.reading, whole.reading[kept])
    np.testing.assert_array_equal(coarse.error.covariance, whole.error.covariance[kept])
    assert np.min(np.diff(coarse.time)) > 0.03  # stamps every 10 ms: four, or three at the edge of a cell
    assert dirty.coarse.steps < 0.3 * dirty.steps


def test_a_quick_search_takes_a_minute_of_recordings_at_most(dirty: Problem) -> None:
    """Choose recordings from first to last, two at least."""
    many = replace(dirty, recordings=dirty.recordings * 5)
    assert sum(one.time[-1] - one.time[0] for one in many.coarse.recordings) <= 60.0
    assert len(many.coarse.recordings) == 3
    long = replace(dirty.recordings[0], time=100.0 * dirty.recordings[0].time)
    assert len(replace(dirty, recordings=(long, long, long)).coarse.recordings) == 2
