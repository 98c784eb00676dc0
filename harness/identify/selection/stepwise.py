"""Stepwise selection: effects are added one at a time, each followed by swap steps, until no candidate is kept."""

from __future__ import annotations

from dataclasses import dataclass
from operator import itemgetter

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import best_screened, fit_candidates, selected_effects
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.swaps import swap_steps
from harness.progress import Progress


@dataclass(frozen=True)
class Round:
    """Fits with each candidate, best first, and the one that was kept."""

    tried: tuple[Fit, ...] = ()
    kept: Fit | None = None


def first_round(problem: Problem, base: Fit, ledger: Ledger, progress: Progress) -> Round:
    """Each candidate alone."""
    tried = fit_candidates(problem, base, progress, failures=ledger.failures)
    return Round(tuple(tried), ledger.decide_round(Rule.ADD, tried, base))


def stepwise(problem: Problem, base: Fit, first: Round, ledger: Ledger, progress: Progress) -> Fit:
    """The fit with the effects that the recordings require.

    The first effect added may imitate two others. If much is left unexplained, the search restarts from the runner-up
    whose screening fits reach the lowest criterion, and the better result is kept.

    Args:
        base: the fit of the stand-ins for unknown rig quantities alone.
        first: the first round.
        ledger: records every decision.
    """
    settings, criterion = problem.settings, ledger.criterion
    best = _grow(problem, base, first.kept, ledger, progress)
    if not first.tried or criterion.at_noise_floor(problem, best):
        return best
    least = max(settings.keep, settings.restart_share * criterion.gain(first.tried[0], base))
    runners_up = [fit for fit in first.tried[1 : 1 + settings.restarts_from] if criterion.gain(fit, base) > least]
    screened = [(best_screened(problem, fit, progress, ledger.failures), fit) for fit in runners_up]
    lowest, runner_up = min(screened, key=itemgetter(0), default=(0.0, None))
    if runner_up is None or lowest >= criterion.value(best) + settings.restart_slack:
        return best
    ledger.decide(Rule.RESTART, runner_up, base, selected_effects(problem, runner_up))
    again = _grow(problem, base, runner_up, ledger, progress)
    return again if ledger.decide(Rule.PREFER, again, best, selected_effects(problem, again)) else best


def _grow(problem: Problem, base: Fit, first: Fit | None, ledger: Ledger, progress: Progress) -> Fit:
    """The selection that starts with `first`: effects are added until none is kept; `base` without a first."""
    best, kept = base, first
    while kept is not None:
        best = swap_steps(problem, kept, ledger, progress)
        if len(selected_effects(problem, best)) >= problem.settings.max_effects:
            break
        tried = fit_candidates(problem, best, progress, failures=ledger.failures)
        kept = ledger.decide_round(Rule.ADD, tried, best)
    return best
