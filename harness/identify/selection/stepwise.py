"""Stepwise selection: effects added one after the other, each followed by swap steps, until none pays any more."""

from __future__ import annotations

from operator import itemgetter

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import Progress, best_screened, fit_candidates, selected_effects
from harness.identify.selection.criterion import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.swaps import swap_steps


def stepwise(problem: Problem, base: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """The fit with the effects that the recordings call for.

    What comes first by itself can be what two other effects look like together. Where much is left unexplained, the
    search is made again from the runner-up beside which a screening fit predicts most, and the better end is kept.

    Args:
        base: the fit of what is unknown of the rig, and nothing else.
        ledger: which every decision is written to.
    """
    settings, criterion = problem.settings, ledger.criterion
    first = fit_candidates(problem, base, progress)
    best = _grow(problem, base, ledger.decide_round(Rule.ADD, first, base), ledger, progress)
    if not first or criterion.explained(problem, best):
        return best
    least = max(settings.keep, settings.restart_share * criterion.gain(first[0], base))
    others = [one for one in first[1 : 1 + settings.restarts_from] if criterion.gain(one, base) > least]
    screened = [(best_screened(problem, one, progress), one) for one in others]
    lowest, other = min(screened, key=itemgetter(0), default=(0.0, None))
    if other is None or lowest >= criterion.value(best) + settings.restart_slack:
        return best
    ledger.decide(Rule.RESTART, other, base, selected_effects(problem, other))
    again = _grow(problem, base, other, ledger, progress)
    return again if ledger.decide(Rule.PREFER, again, best, selected_effects(problem, again)) else best


def _grow(problem: Problem, base: Fit, first: Fit | None, ledger: Ledger, progress: Progress) -> Fit:
    """What is found when `first` is kept first: one effect after the other, until no further one pays."""
    best, kept = base, first
    while kept is not None:
        best = swap_steps(problem, kept, ledger, progress)
        if len(selected_effects(problem, best)) >= problem.settings.max_effects:
            break
        kept = ledger.decide_round(Rule.ADD, fit_candidates(problem, best, progress), best)
    return best
