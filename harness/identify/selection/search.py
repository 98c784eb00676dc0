"""The search as a whole: stepwise selection, then spline terms, then cross-validation."""

from __future__ import annotations

from dataclasses import dataclass

from harness.failures import Failures
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


def search(problem: Problem, progress: Progress = silent, failures: Failures | None = None) -> Selection:
    """Select the terms that the recordings require beside the known effects.

    Args:
        failures: collects candidates and steps that raise, without which the search goes on; `None` lets them raise.
    """
    ledger = Ledger(Criterion(problem.settings), failures)
    base = fit(problem, Hypothesis(problem.unknown))
    found = ledger.attempt("stepwise selection", lambda: stepwise(problem, base, ledger, progress), base)
    if not ledger.criterion.at_noise_floor(problem, found):
        effects = found
        found = ledger.attempt("spline terms", lambda: with_spline_term(problem, effects, ledger, progress), effects)
    terms = found
    found = ledger.attempt("cross-validation", lambda: cross_validate(problem, base, terms, ledger, progress), terms)
    return Selection(base, found, tuple(ledger.lines))
