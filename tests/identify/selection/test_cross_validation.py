"""Cross-validation: what predicts held-out windows worse is given up, what predicts them better is added."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.settings import Settings
from harness.identify.problem.windows import windows_of
from harness.identify.selection.criterion import Criterion, Rule
from harness.identify.selection.cross_validation import cross_validate, held_out_errors
from harness.identify.selection.ledger import Ledger
from tests.posed import pose

HIDDEN = "rolling_resistance"
# Two recordings of 16 s hold eight windows; as if the angle were so well known that nothing counts as explained.
SETTINGS = Settings(min_windows=8, at_floor_ratio=0.0)


@pytest.fixture(scope="module")
def rolling(tmp_path_factory: pytest.TempPathFactory) -> tuple[Problem, Fit, Fit]:
    """A rolling resistance is hidden; the fits without and with it."""
    folder: Path = tmp_path_factory.mktemp("rolling")
    problem = replace(pose(folder / "case", 0, {HIDDEN: {"coefficient": 0.004}}).problem, settings=SETTINGS)
    return problem, fit(problem, Hypothesis(())), fit(problem, Hypothesis((HIDDEN,)))


def validated(problem: Problem, base: Fit, found: Fit, **changes: int) -> tuple[Fit, Ledger]:
    """The result and the ledger."""
    settings = replace(problem.settings, **changes)
    ledger = Ledger(Criterion(settings))
    return cross_validate(replace(problem, settings=settings), base, found, ledger, lambda _: None), ledger


def test_every_window_is_predicted_by_a_fit_that_has_not_seen_it(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Predict each window once, and better with the effect that acts."""
    problem, without, with_it = rolling
    before, after = (held_out_errors(problem, one) for one in (without, with_it))
    assert len(before) == len(after) == len(windows_of(problem.recordings))
    assert sum(one < other for one, other in zip(after, before, strict=True)) > len(before) / 2


def test_what_predicts_better_stays(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Keep the effect that acts, and say so."""
    problem, without, with_it = rolling
    found, ledger = validated(problem, without, with_it, validated_effects=1)
    assert found is with_it
    (line,) = ledger.lines
    assert (line.rule, line.effects, line.kept) == (Rule.VALIDATE, (HIDDEN,), True)


def test_what_predicts_worse_is_dropped(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Give up what misleads over seconds, and say by how much."""
    problem, _, with_it = rolling
    misleading = fit(problem, Hypothesis(("level_error",)))  # beside a base that knows the resistance
    found, ledger = validated(problem, with_it, misleading, validated_effects=1)
    assert found is with_it
    (line,) = ledger.lines
    assert (line.rule, line.effects, line.kept) == (Rule.VALIDATE, ("level_error",), False)
    assert "predicts held-out windows worse" in line.because


def test_what_acts_is_added_by_its_predictions(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Find a dry friction by held-out windows alone, with the reason in the ledger."""
    problem, without, _ = rolling
    found, ledger = validated(problem, without, without, validated_effects=1)
    # windows of 3 s do not tell one law of dry friction from another
    assert found.hypothesis.names[0] in (HIDDEN, "directional_resistance", "stribeck_friction")
    (kept,) = [line for line in ledger.lines if line.kept]
    assert (kept.rule, kept.effects) == (Rule.EXTEND, found.hypothesis.names)
    assert "predicts held-out windows" in kept.because


def test_few_windows_decide_nothing(rolling: tuple[Problem, Fit, Fit]) -> None:
    """Leave what was found as it is where there are too few windows, or nothing is left to explain."""
    problem, without, with_it = rolling
    for change in ({"min_windows": 9}, {"at_floor_ratio": 1e9}):
        found, ledger = validated(problem, without, with_it, **change)  # type: ignore[arg-type]
        assert found is with_it
        assert ledger.lines == []
