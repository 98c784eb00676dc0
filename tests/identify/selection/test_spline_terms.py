"""A spline term of unknown law has to act again: a dozen parameters can follow what happened once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic.motion import FloatArray
from harness.identify.estimate.fit import Fit, fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.settings import DEFAULT
from harness.identify.problem.spline_term import Kind, Regressor, blank
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.spline_terms import held_out_deviances, visited, with_spline_term
from harness.identify.verdict import Verdict, identify
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from tests.posed import DECLARED, pose

# So strong that half of it in either recording pays for a spline term when it blew in one of them.
GUST = {"gust": {"force": 0.02, "start": 5.0, "end": 8.0}}


def blown(folder: Path, *, both: bool) -> Problem:
    """Two recordings with a gust at the same instant in both, or in the first only."""
    gusty = Experiment(declared=DECLARED, unlisted=GUST, predict=0, seed=1)
    first, second = gusty.recordings()
    if not both:
        _, second = replace(gusty, unlisted={}).recordings()
    write_case(folder, gusty, (first, second))
    return problem_of(load_case(folder))


def with_and_without(problem: Problem) -> tuple[Fit, Fit]:
    """Fits without a spline term and with one of time."""
    found = fit(problem, Hypothesis(()))
    term = blank(Kind(Regressor.TIME), *visited(problem, Regressor.TIME))
    return found, fit(problem, Hypothesis((), term), process_noise=found.process_noise)


def recurs(problem: Problem, found: Fit, best: Fit) -> bool:
    """Whether the criterion keeps the spline term by what it predicts of held-out recordings."""
    before, after = held_out_deviances(problem, found, best, lambda _: None)
    evidence = Evidence(winner=best, before=before, after=after)
    return Criterion().decide(Rule.SPLINE, best, found, evidence).kept


@pytest.mark.slow
@pytest.mark.parametrize("both", [True, False], ids=["in both", "in one"])
def test_a_gust_is_a_spline_term_of_time_only_if_it_comes_again(tmp_path: Path, both: bool) -> None:
    """Let only a spline term of time stand that predicts a recording it was not fitted to, much as it gains."""
    problem = blown(tmp_path / "case", both=both)
    found, best = with_and_without(problem)
    assert Criterion().gain(best, found) > DEFAULT.spline_keep  # it follows what happened in either case
    assert recurs(problem, found, best) is both


@pytest.mark.slow
def test_one_recording_cannot_tell(tmp_path: Path) -> None:
    """Take the spline term's gain for what it is where there is no second recording to ask."""
    problem = blown(tmp_path / "case", both=False)
    alone = replace(problem, recordings=problem.recordings[:1])
    found, best = with_and_without(alone)
    assert Criterion().gain(best, found) > DEFAULT.spline_keep
    assert recurs(alone, found, best)


def test_nodes_that_no_reading_visits_follow_their_neighbours(tmp_path: Path) -> None:
    """Carry a force on beyond where the ball has been, instead of leaving it to chance."""
    hill = {"force_hill": {"force": 0.01, "start": 0.29, "end": 0.36}}
    problem = pose(tmp_path / "case", 2, unlisted=hill).problem
    low, high = visited(problem, Regressor.POSITION)
    assert high < 0.55
    start = fit(problem, Hypothesis(()))
    found = fit(problem, Hypothesis((), blank(Kind(Regressor.POSITION), low, 0.7)), process_noise=start.process_noise)
    assert found.terms.spline is not None
    beyond = found.terms.spline.nodes[found.terms.spline.places > high + found.terms.spline.step]
    assert len(beyond) > 1
    # nothing but the difference from its neighbour holds such a node; the last one visited is held by readings
    np.testing.assert_allclose(beyond, beyond[0], atol=1e-3 * np.ptp(found.terms.spline.nodes))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values", "depends", "friction"),
    [
        ("out_of_round", {"torque": 5e-5}, Regressor.ROLL_ANGLE, False),
        ("sticky_spot", {"coefficient": 0.015, "width": 0.3}, Regressor.ROLL_ANGLE, True),
        ("magnet", {"force": -0.01, "centre": 0.35, "distance": 0.05}, Regressor.POSITION, False),
        ("ripple_force", {"force": 0.01, "wavelength": 0.04}, Regressor.POSITION, False),
        # near the ball's turn of 74 mm, so that an imbalance, a rolling radius and a gain imitate it
        ("ripple_force", {"force": 0.0114, "wavelength": 0.0818}, Regressor.POSITION, False),
    ],
    ids=["out of round", "sticky spot", "magnet", "ripple", "ripple of a turn"],
)
def test_what_the_catalogue_made_of_a_cause_gives_way_to_its_spline_term(
    tmp_path: Path, name: str, values: dict[str, float], depends: Regressor, friction: bool
) -> None:
    """Name no effect beside the spline term of what acts, however the ball lay at the start of each recording."""
    said = identify(pose(tmp_path / "case", 3, unlisted={name: values}).problem)
    spline = said.found.terms.spline
    assert said.verdict is Verdict.UNLISTED
    assert not said.effects
    assert spline is not None
    assert (spline.depends, spline.friction, spline.sensor) == (depends, friction, False)
    if name == "ripple_force":
        # Four waves or more over the places visited, each shifted by less than a hundredth of itself.
        assert spline.periodic
        assert spline.period == pytest.approx(values["wavelength"], rel=2.5e-3)
    assert said.found.root_process_noise < 0.1 * said.base.root_process_noise


@pytest.mark.slow
def test_a_crooked_sensor_is_told_from_a_force(tmp_path: Path) -> None:
    """Find what was added to the positions of a ball on which nothing acts, and predict as if it were known.

    Nodes 2.5 cm apart follow hills of 2 and 3 cm deviation to 15 % of their height, and a node is known to 0.1 mm: its
    mean is no error, but another origin. Without a curve the ball is predicted with centimetres of error.
    """

    def error(s: FloatArray) -> FloatArray:
        return 4e-3 * np.exp(-0.5 * ((s - 0.30) / 0.02) ** 2) - 2.8e-3 * np.exp(-0.5 * ((s - 0.38) / 0.03) ** 2)

    problem = pose(tmp_path / "case", 4).problem
    crooked = [replace(one, reading=one.reading + error(one.reading)) for one in problem.recordings]
    said = identify(replace(problem, recordings=tuple(crooked)))
    spline = said.found.terms.spline
    assert said.verdict is Verdict.UNLISTED
    assert not said.effects
    assert spline is not None
    assert spline.kind == Kind(Regressor.POSITION, sensor=True)
    inside = spline.places[1:-1]
    apart = spline.at(inside) - error(inside)
    np.testing.assert_allclose(apart - np.mean(apart), 0.0, atol=0.15 * 4e-3)
    assert Criterion().at_noise_floor(said.problem, said.found)


@pytest.mark.slow
def test_a_single_gust_leaves_a_reason_in_the_ledger(tmp_path: Path) -> None:
    """Keep the fit without a spline term of time, and say why the best spline term was not kept."""
    problem = blown(tmp_path / "case", both=False)
    found = fit(problem, Hypothesis(()))
    ledger = Ledger(Criterion())
    assert with_spline_term(problem, found, found, ledger, lambda _: None) is found
    assert not any(line.kept for line in ledger.lines)
    assert "does not predict the others" in ledger.lines[0].because
