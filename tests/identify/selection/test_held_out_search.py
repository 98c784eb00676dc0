"""Search by held-out errors: effects that act together are found together, what predicts worse is given up."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.effects import acting
from harness.identify.estimate.cross_validation import cross_validated
from harness.identify.estimate.fit import Estimator, Fit, fit
from harness.identify.estimate.free_run_fit import fit_free_runs
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import fitted_windows
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.held_out_search import _Search, search_by_held_out_errors
from harness.identify.selection.ledger import Ledger
from tests.coloured import with_coloured_readings
from tests.identify.selection.test_held_out_criterion import free
from tests.posed import pose

HIDDEN = {"rolling_resistance": {"coefficient": 0.006}, "channel_delay": {"delay": 0.05}}


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A dry friction and a delay are hidden, under coloured errors of the position sensor that no model declares."""
    folder: Path = tmp_path_factory.mktemp("pair")
    problem = pose(folder / "case", 3, HIDDEN).problem
    return with_coloured_readings(problem, 0.95, 5e-4)


def searched(problem: Problem, base: Fit, found: Fit) -> tuple[Fit, Fit, Ledger]:
    """Fits without and with what was found, and the ledger."""
    ledger = Ledger(Criterion(problem.settings))
    return *search_by_held_out_errors(problem, base, found, ledger, lambda _: None), ledger


@pytest.mark.slow
def test_effects_that_act_together_are_found_together(pair: Problem) -> None:
    """Find both from a likelihood search that found nothing, near their true values, with the reason in the ledger."""
    base = fit(pair, Hypothesis(()))
    plain, found, ledger = searched(pair, base, base)
    assert plain.estimator is found.estimator is Estimator.FREE_RUNS
    assert plain.hypothesis.names == ()
    assert "rolling_resistance" in found.hypothesis.names
    values = found.values()
    assert values["rolling_resistance", "coefficient"] == pytest.approx(0.006, rel=0.1)
    # Over seconds a delay of 50 ms and lags of the same length differ by less than the sensor's error.
    late = {"channel_delay", "position_lag", "angle_lag", "angle_hold"} & set(found.hypothesis.names)
    assert len(late) == 1
    (joint,) = [line for line in ledger.lines if line.rule is Rule.JOINT and line.kept]
    assert set(joint.effects) == set(HIDDEN)
    assert "predicts held-out blocks" in joint.because


@pytest.mark.slow
def test_an_idle_effect_gives_its_place_to_one_that_acts(pair: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """Prune before effects are added, of which there may be two, though no exchange is made."""
    problem = replace(pair, settings=replace(pair.settings, max_effects=2))
    windows = fitted_windows(problem.recordings)
    names = ((), ("rolling_resistance", "quadratic_drag"))
    plain, idle = (cross_validated(problem, fit_free_runs(problem, Hypothesis(one), windows).fit) for one in names)
    monkeypatch.setattr(_Search, "jointly", lambda search, *_: (plain, idle))
    monkeypatch.setattr(_Search, "exchanged", lambda _, best: best)
    monkeypatch.setattr(_Search, "_scale", fit_free_runs(problem, plain.hypothesis, windows).scale, raising=False)
    _, found, _ = searched(problem, fit(problem, Hypothesis(())), plain)
    assert "quadratic_drag" not in found.hypothesis.names
    assert len(found.hypothesis.names) == 2


@pytest.mark.timeout(120)
def test_a_search_that_comes_back_to_a_set_ends(pair: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """End where what an addition led to is pruned again to the set that was there before it."""
    plain, one, two = free(1.0), free(0.8, "level_error"), free(0.5, "level_error", "track_bump")
    monkeypatch.setattr(_Search, "jointly", lambda search, *_: (plain, one))
    monkeypatch.setattr(_Search, "exchanged", lambda _, best: best)
    monkeypatch.setattr(_Search, "pruned", lambda _, best: one)
    monkeypatch.setattr(_Search, "extended", lambda _, best: two)
    base = fit(pair, Hypothesis(()))
    _, found, _ = searched(pair, base, base)
    assert found is one


def test_a_weak_effect_does_not_keep_another_from_being_added(pair: Problem) -> None:
    """Add the best of what is surely of some strength, beside something better that may be none, and say why."""
    base, strong = free(1.0), free(0.88, "viscous_damping")
    weak = free(0.85, "level_error")
    weak = replace(
        weak,
        terms=replace(weak.terms, effects=(acting("level_error", {"angle": 0.01}),)),
        covariance=np.array([[1e-4]]),
    )
    ledger = Ledger(Criterion(pair.settings))
    kept = _Search(pair, ledger, lambda _: None)._decided(Rule.EXTEND, [strong, weak], base, tests=2)
    assert kept is strong
    because = {line.effects: line.because for line in ledger.lines}
    assert "strength may be none" in because["level_error",]
    assert "strength may be none" not in because["viscous_damping",]


@pytest.mark.slow
def test_what_predicts_worse_is_given_up(tmp_path: Path) -> None:
    """Return the base where the selected effect raises the held-out error and nothing else acts."""
    problem = pose(tmp_path / "case", 5).problem
    base = fit(problem, Hypothesis(()))
    misleading = fit(problem, Hypothesis(("level_error",)))
    wrong = replace(
        misleading,
        theta=misleading.theta + 3.0,
        terms=misleading.hypothesis.terms(misleading.theta + 3.0, problem),
    )
    plain, found, ledger = searched(problem, base, wrong)
    assert found.hypothesis.names in ((), ("level_error",))  # refitted, it is hardly there
    assert plain is base
    assert not any(line.kept for line in ledger.lines if line.rule is not Rule.VALIDATE)


def test_few_blocks_decide_nothing(pair: Problem) -> None:
    """Leave what was found as it is where there are too few blocks."""
    problem = replace(pair, settings=replace(pair.settings, min_blocks=9))
    base, other = fit(problem, Hypothesis(())), fit(problem, Hypothesis(("level_error",)))
    plain, found, ledger = searched(problem, base, other)
    assert (plain, found) == (base, other)
    assert ledger.lines == []


@pytest.mark.slow
def test_parameters_that_predict_worse_give_way_to_those_of_free_runs(pair: Problem) -> None:
    """Keep the terms of the likelihood, and not its parameters, where these are far off and predict worse."""
    hypothesis = Hypothesis(tuple(HIDDEN))
    base, right = fit(pair, Hypothesis(())), fit(pair, hypothesis)
    theta = right.theta * np.array([2.0, 0.2])
    wrong = replace(right, theta=theta, terms=hypothesis.terms(theta, pair))
    _, kept, _ = searched(pair, base, right)
    _, mended, _ = searched(pair, base, wrong)
    assert mended.estimator is Estimator.FREE_RUNS
    assert mended.values()["rolling_resistance", "coefficient"] == pytest.approx(0.006, rel=0.1)
    assert kept.hypothesis.names[0] == mended.hypothesis.names[0] == "rolling_resistance"


def test_a_base_that_lacks_physics_is_the_one_that_predicts_better(pair: Problem) -> None:
    """Take parameters of free runs for a model that is certain to lack physics, if they predict better, else not."""
    hypothesis = Hypothesis(("level_error",))
    base = fit(pair, hypothesis)
    plain = fit_free_runs(pair, hypothesis, fitted_windows(pair.recordings)).fit
    theta = base.theta + 3.0
    wrong = replace(base, theta=theta, terms=hypothesis.terms(theta, pair))
    search = _Search(pair, Ledger(Criterion(pair.settings)), lambda _: None)
    at_floor = pair.angle_floor**2
    lacking = 4.0 * (pair.settings.above_floor_ratio * pair.angle_floor) ** 2
    assert search.predicting(replace(wrong, process_noise=lacking), plain) is plain
    kept = replace(wrong, process_noise=at_floor)
    assert search.predicting(kept, plain) is kept
    as_good = replace(base, theta=plain.theta, terms=plain.terms, process_noise=lacking)
    assert search.predicting(as_good, plain) is as_good
