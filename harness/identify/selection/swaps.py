"""Swap steps of the stepwise selection: each effect found is compared with all that could replace it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

from analytic.effects import CATALOGUE
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.starts import starting_points
from harness.identify.filter.run import deviance
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import fit_candidates, refitted, selected_effects
from harness.identify.selection.decision import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from harness.progress import Progress


def swap_steps(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """`best` after splits, merges, drops and swaps, until nothing changes.

    Merges and drops may raise the criterion slightly and lead back to an earlier set of effects, which ends the loop.
    """
    visited: list[set[str]] = []
    while True:
        best = ledger.attempt("splits", partial(_split_or_merge, problem, best, ledger, progress), best)
        if set(best.hypothesis.names) in visited:
            return best
        visited.append(set(best.hypothesis.names))
        former = best
        if len(selected_effects(problem, best)) > 1:
            best = ledger.attempt("swaps", partial(_swap, problem, best, ledger, progress), best)
        if best is former:
            return best


def _swap(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """Try to drop each effect, then to replace it by each candidate; the first change that is kept, or `best`."""
    for name in selected_effects(problem, best):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"without {name}")
        without = refitted(problem, rest, best)
        if not ledger.decide(Rule.DROP, best, without, (name,)):
            return without
        main = best.process_noise < problem.settings.main_effect_ratio * without.process_noise
        start = _at_values_of(problem, without, best) if main else without
        tried = fit_candidates(problem, start, progress, excluding=name, replacing=main, failures=ledger.failures)
        swapped = ledger.decide_round(Rule.SWAP, tried, without, holder=best)
        if swapped is not None:
            return swapped
    return best


def _at_values_of(problem: Problem, without: Fit, best: Fit) -> Fit:
    """The hypothesis of `without`, at the values of `best` and the geometric mean of their process noises.

    Replacements of a main effect start from there: in the fit without it the other values are distorted.
    """
    process_noise = math.sqrt(without.process_noise * best.process_noise)
    (start,) = starting_points(problem, without.hypothesis, best.values(), process_noise)
    at = without.hypothesis.terms(start, problem)
    return replace(
        without,
        theta=start,
        terms=at,
        process_noise=process_noise,
        deviance=deviance(problem, at, process_noise),
        quiet_deviance=math.inf,
    )


def _split_or_merge(problem: Problem, best: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """Compare each effect with the pair that it can imitate, whichever of the two was found."""
    splits = {name: effect.relations.splits_into for name, effect in CATALOGUE.items()}
    for name, parts in splits.items():
        if parts is None:
            continue
        pair = (parts[0].name, parts[1].name)
        names = selected_effects(problem, best)
        if name in names and not set(pair) & set(names) and len(names) < problem.settings.max_effects:
            best = _split(problem, best, name, pair, ledger, progress)
        elif name not in names and set(pair) <= set(names):
            progress(f"{name} in place of {' + '.join(pair)}")
            rest = tuple(other for other in best.hypothesis.names if other not in pair)
            merged = refitted(problem, (*rest, name), best)
            best = merged if ledger.decide(Rule.MERGE, merged, best, (name,)) else best
    return best


def _split(problem: Problem, best: Fit, name: str, pair: tuple[str, str], ledger: Ledger, progress: Progress) -> Fit:
    progress(f"{' + '.join(pair)} in place of {name}")
    rest = tuple(other for other in best.hypothesis.names if other != name)
    both = refitted(problem, (*rest, *pair), best)
    better = ledger.criterion.needs_evidence(Rule.SPLIT, both, best)
    without = tuple(refitted(problem, (*rest, single), both) for single in pair) if better else ()
    return both if ledger.decide(Rule.SPLIT, both, best, pair, Evidence(without=without)) else best
