"""Second thoughts: what predicts held-out windows worse is given up."""

from __future__ import annotations

from pathlib import Path

import pytest

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import Entry
from harness.identify.selection.cross_validation import _unless_worse
from tests.identify.conftest import pose

HIDDEN = "rolling_resistance"


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> tuple[Problem, Fit, Fit]:
    """A rolling resistance is hidden; the fits without and with it."""
    folder: Path = tmp_path_factory.mktemp("rolling")
    problem = pose(folder / "case", 0, {HIDDEN: {"coefficient": 0.004}}).problem
    return problem, fit(problem, Hypothesis(())), fit(problem, Hypothesis((HIDDEN,)))


def test_what_predicts_better_stays(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Keep the effect that acts, and write no line about it."""
    problem, without, with_it = rolling
    ledger: list[Entry] = []
    assert _unless_worse(problem, with_it, without, HIDDEN, ledger, lambda _: None) is with_it
    assert ledger == []


def test_what_predicts_worse_is_dropped(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Give up what misleads over seconds, and say by how much, whatever its likelihood."""
    problem, misleading, plain = rolling  # the model that lacks the effect is the worse one
    ledger: list[Entry] = []
    assert _unless_worse(problem, misleading, plain, "what misleads", ledger, lambda _: None) is plain
    (line,) = ledger
    assert (line.effect, line.rule, line.kept) == ("what misleads", "prediction", False)
    assert "held-out windows worse" in line.because
