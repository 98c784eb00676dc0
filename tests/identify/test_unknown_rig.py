"""What a rig file leaves open is estimated beside everything else, and is never a finding."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from analytic.rig import Rig
from harness.identify.estimate.fit import Fit, fit
from harness.identify.pose import problem_of
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates, hidden_by, selected_effects
from harness.identify.selection.criterion import Criterion
from harness.identify.verdict import Verdict, identify
from harness.recording import load_case
from harness.simulator import Experiment, write_case
from tests.posed import DECLARED, Effects

LEVEL_KNOWN = "level_angle_rad = 0.0\n"


def without_groove(folder: Path, hidden: Effects | None = None) -> Problem:
    """A rig whose file says nothing of the groove, hence nothing of K; its beam is levelled."""
    declared = {} if hidden else DECLARED
    write_case(folder, Experiment(declared=declared, hidden=hidden or {}, predict=0, seed=5))
    file = folder / "rig.toml"
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    written = "".join(LEVEL_KNOWN if line.startswith("rolling_radius_m") else line for line in lines)
    file.write_text(written, encoding="utf-8")
    return problem_of(load_case(folder))


@pytest.fixture(scope="module")
def open_problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """Nothing is hidden, K is unknown."""
    return without_groove(tmp_path_factory.mktemp("open") / "case")


@pytest.fixture(scope="module")
def base(open_problem: Problem) -> Fit:
    """What stands for the unknown, fitted."""
    return fit(open_problem, Hypothesis(open_problem.unknown))


@pytest.mark.slow
def test_a_gain_of_the_angle_stands_for_an_unknown_ratio(open_problem: Problem, base: Fit) -> None:
    """Find the true K as that of the completed rig times the gain, whatever the rig was completed with."""
    assert open_problem.unknown == ("angle_gain",)
    ratio = open_problem.rig.rolling_ratio
    gain = base.values()["angle_gain", "gain"]
    reach = 1.96 * base.deviations()["angle_gain", "gain"]
    assert abs(gain * ratio - Rig().rolling_ratio) < reach * ratio
    assert Criterion().at_noise_floor(open_problem, base)
    # Another completion, whose K is 1 % more, is made up for.
    other = replace(open_problem, rig=open_problem.rig.with_(inertia=open_problem.rig.inertia * 0.97))
    off = other.rig.rolling_ratio / ratio
    assert off - 1.0 > 10.0 * reach
    again = fit(other, Hypothesis(other.unknown))
    assert abs(again.values()["angle_gain", "gain"] * off - gain) < reach


@pytest.mark.slow
def test_what_stands_for_the_unknown_is_no_finding(open_problem: Problem, base: Fit) -> None:
    """Count it among no findings, and try neither it nor what no recording can tell from it."""
    assert base.hypothesis.names == ("angle_gain",)
    assert selected_effects(open_problem, base) == ()
    assert hidden_by(open_problem.unknown) == ("angle_gain", "rolling_radius", "position_gain")
    assert not {"angle_gain", "rolling_radius", "position_gain"} & set(candidates(open_problem))
    assert {"angle_gain", "rolling_radius", "position_gain", "level_error"} <= set(
        candidates(replace(open_problem, unknown=()))
    )
    assert "level_error" in candidates(open_problem)


@pytest.mark.slow
@pytest.mark.parametrize("hidden", [{}, {"rolling_resistance": {"coefficient": 0.004}}], ids=["none", "rolling"])
def test_an_unknown_ratio_does_not_hide_what_acts(tmp_path: Path, hidden: Effects) -> None:
    """Name what acts, and only that, on a rig whose K nobody knows."""
    said = identify(without_groove(tmp_path / "case", hidden))
    assert said.verdict is (Verdict.EFFECT if hidden else Verdict.NONE)
    assert {one.name for one in said.effects} == set(hidden)
    assert said.found.hypothesis.names[0] == "angle_gain"
    assert all("angle_gain" not in entry.effects for entry in said.ledger)


@pytest.mark.slow
def test_an_unknown_pivot_does_not_take_a_delay_for_a_lever(tmp_path: Path) -> None:
    """Name a delay alone, at its size, and find where the pivot is, though without the delay it seems elsewhere."""
    hidden = {"channel_delay": {"delay": 0.06}}
    write_case(tmp_path, Experiment(declared=DECLARED, hidden=hidden, predict=0, seed=5))
    file = tmp_path / "rig.toml"
    lines = file.read_text(encoding="utf-8").splitlines(keepends=True)
    file.write_text("".join(one for one in lines if not one.startswith("eccentricity_m")), encoding="utf-8")
    problem, truth = problem_of(load_case(tmp_path)), Rig().eccentricity
    assert "eccentric_pivot" in problem.unknown
    assert abs(problem.rig.eccentricity - truth) > 0.01  # as it was completed without the delay
    said = identify(problem)
    (delay,) = said.effects
    assert delay.name == "channel_delay"
    assert delay.parameters["delay"].low < 0.06 < delay.parameters["delay"].high
    key = "eccentric_pivot", "eccentricity"
    assert abs(said.found.values()[key] - truth) < 4.0 * said.found.deviations()[key]  # one normal error of 16,000
