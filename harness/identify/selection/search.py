"""The search as a whole: stepwise selection, then spline terms, then cross-validation."""

from __future__ import annotations

from dataclasses import dataclass

from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.cross_validation import cross_validate
from harness.identify.selection.ledger import Ledger, Line
from harness.identify.selection.spline_terms import with_spline_term
from harness.identify.selection.stepwise import stepwise
from harness.progress import Progress, silent


@dataclass(frozen=True)
class Selection:
    """Result of the search.

    Attributes:
        base, found: fits without and with the selected terms.
        ledger: every decision.
    """

    base: Fit
    found: Fit
    ledger: tuple[Line, ...]


def search(problem: Problem, progress: Progress = silent) -> Selection:
    """Select the terms that the recordings require beside the known effects."""
    ledger = Ledger(Criterion(problem.settings))
    base = fit(problem, Hypothesis(problem.unknown))
    found = stepwise(problem, base, ledger, progress)
    if not ledger.criterion.at_noise_floor(problem, found):
        found = with_spline_term(problem, found, ledger, progress)
    found = cross_validate(problem, base, found, ledger, progress)
    return Selection(base, found, tuple(ledger.lines))
