"""Swap steps of the stepwise selection: each effect found is held against all that could stand in its place."""

from __future__ import annotations

import math
from dataclasses import replace

from analytic.effects import CATALOGUE
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.starts import starting_points
from harness.identify.filter.run import deviance
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import Progress, fit_candidates, refitted, selected_effects
from harness.identify.selection.criterion import Evidence, Rule
from harness.identify.selection.ledger import Ledger


def swap_steps(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """`best` after splits, merges, drops and swaps, until nothing changes.

    Every change but a split lowers the criterion; a split may lead back to what had been held before, which ends it.
    """
    held: list[set[str]] = []
    while True:
        best = _split_or_merge(problem, best, ledger, progress)
        if set(best.hypothesis.names) in held:
            return best
        held.append(set(best.hypothesis.names))
        former = best
        if len(selected_effects(problem, best)) > 1:
            best = _swap(problem, best, ledger, progress)
        if best is former:
            return best


def _swap(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """Hold each effect against none and against all others; the first change, or `best`."""
    for name in selected_effects(problem, best):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"{name} again")
        without = refitted(problem, rest, best)
        if not ledger.decide(Rule.DROP, best, without, (name,)):
            return without
        main = best.process_noise < problem.settings.absorbed_share * without.process_noise
        start = _at_values_of(problem, without, best) if main else without
        tried = fit_candidates(problem, start, progress, excluding=name, replacing=main)
        swapped = ledger.decide_round(Rule.SWAP, tried, without, holder=best)
        if swapped is not None:
            return swapped
    return best


def _at_values_of(problem: Problem, without: Fit, best: Fit) -> Fit:
    """`without` an effect, at the values that `best` has with it, and a process noise between those of the two.

    What stands in for that effect is searched from there: fitted without it, the others have moved to make up for it.
    """
    process_noise = math.sqrt(without.process_noise * best.process_noise)
    (start,) = starting_points(problem, without.hypothesis, best.values(), process_noise)
    at = without.hypothesis.terms(start, problem)
    return replace(
        without, theta=start, terms=at, process_noise=process_noise, deviance=deviance(problem, at, process_noise)
    )


def _split_or_merge(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """Hold one law against the two that imitate it, whichever was found."""
    imitated = {name: effect.relations.splits_into for name, effect in CATALOGUE.items()}
    for name, parts in imitated.items():
        if parts is None:
            continue
        pair = (parts[0].name, parts[1].name)
        names = selected_effects(problem, best)
        if name in names and not set(pair) & set(names) and len(names) < problem.settings.max_effects:
            best = _split(problem, best, name, pair, ledger, progress)
        elif name not in names and set(pair) <= set(names):
            progress(f"{name} for {' + '.join(pair)}")
            rest = tuple(one for one in best.hypothesis.names if one not in pair)
            merged = refitted(problem, (*rest, name), best)
            best = merged if ledger.decide(Rule.MERGE, merged, best, (name,)) else best
    return best


def _split(problem: Problem, best: Fit, name: str, pair: tuple[str, str], ledger: Ledger, progress: Progress) -> Fit:
    progress(f"{' + '.join(pair)} for {name}")
    rest = tuple(one for one in best.hypothesis.names if one != name)
    parted = refitted(problem, (*rest, *pair), best)
    worth = ledger.criterion.gain(parted, best) > problem.settings.pair_penalty  # else the fits without each are idle
    without = tuple(refitted(problem, (*rest, one), parted) for one in pair) if worth else ()
    return parted if ledger.decide(Rule.SPLIT, parted, best, pair, Evidence(without=without)) else best
