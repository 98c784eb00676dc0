"""Swap steps: what only stood in for the true cause is exchanged, split, merged or dropped."""

from __future__ import annotations

import pytest

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.swaps import swap_steps
from tests.posed import pose

ROLLING, LEVEL, DIRECTIONAL = "rolling_resistance", "level_error", "directional_resistance"


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A rolling resistance is hidden."""
    return pose(tmp_path_factory.mktemp("rolling") / "case", 0, {ROLLING: {"coefficient": 0.004}}).problem


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    """A rolling resistance and a level error are hidden, which together resist one way only."""
    hidden = {ROLLING: {"coefficient": 0.004}, LEVEL: {"angle": 0.004}}
    return pose(tmp_path_factory.mktemp("both") / "case", 0, hidden).problem


def swapped(problem: Problem, *names: str) -> tuple[Fit, Ledger]:
    """Where swap steps lead from these effects, and the ledger."""
    ledger = Ledger(Criterion())
    return swap_steps(problem, fit(problem, Hypothesis(names)), ledger, lambda _: None), ledger


@pytest.mark.slow
def test_an_idle_effect_is_dropped(rolling: Problem) -> None:
    """Drop what does not pay beside what acts, and say so."""
    found, ledger = swapped(rolling, ROLLING, "position_lag")
    assert found.hypothesis.names == (ROLLING,)
    (dropped,) = [line for line in ledger.lines if line.rule is Rule.DROP and not line.kept]
    assert dropped.effects == ("position_lag",)
    assert "no longer needed" in dropped.because


@pytest.mark.slow
def test_what_stood_in_gives_way(rolling: Problem) -> None:
    """Put the resistance in the place of a damping that imitates it beside an idle effect, then drop that."""
    found, ledger = swapped(rolling, "viscous_damping", "position_lag")
    assert found.hypothesis.names == (ROLLING,)
    assert any(line.rule is Rule.SWAP and line.kept and line.effects == (ROLLING,) for line in ledger.lines)


@pytest.mark.slow
def test_one_law_that_two_imitate_is_split(both: Problem) -> None:
    """Split a resistance that differs by direction into a resistance and a level error, where these act."""
    found, ledger = swapped(both, DIRECTIONAL)
    assert set(found.hypothesis.names) == {ROLLING, LEVEL}
    (split,) = [line for line in ledger.lines if line.rule is Rule.SPLIT]
    assert split.kept
    assert len(split.evidence.without) == 2


def test_two_laws_that_one_explains_as_well_are_merged(rolling: Problem) -> None:
    """Try the one law in the place of the pair that imitates it, and hold the pair's members to pay."""
    found, ledger = swapped(rolling, ROLLING, LEVEL)
    merges = [line for line in ledger.lines if line.rule is Rule.MERGE]
    assert [line.effects for line in merges] == [(DIRECTIONAL,)]
    # a level error that is idle leaves the resistance; the directional one has a parameter as many as the pair
    assert found.hypothesis.names == (DIRECTIONAL,)
