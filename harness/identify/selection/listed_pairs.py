"""Two effects of the catalogue in place of a spline term that contains the laws of both.

Laws of one regressor add up to a curve of it, which a spline term fits at once: a viscous damping and a level to a
force of the velocity. Single effects do not lead to the pair where the best of them is a third law.
"""

from __future__ import annotations

import itertools

from analytic.effects import LEVEL_ERROR
from harness.identify.estimate.fit import Fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates, fitted_each, fitted_from, is_seen_in_coarse
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.spline_terms import contains
from harness.progress import Progress

_FINISHED = 2  # pairs that are fitted to all readings, of those fitted to coarse data


def in_place_of_spline_term(problem: Problem, base: Fit, found: Fit, ledger: Ledger, progress: Progress) -> Fit:
    """`found`, or the pair of effects beside its others that fits better than its spline term.

    Args:
        base: fit without effects, which tells whether coarse data show what is missing.
    """
    spline = found.terms.spline
    if spline is None:
        return found
    free = [name for name in candidates(problem) if name not in found.hypothesis.names]
    listed = [name for name in free if contains(spline, name)]
    constant = [LEVEL_ERROR.name] if LEVEL_ERROR.name in free and not spline.sensor else []  # is a force of anything
    quick = problem.coarse if is_seen_in_coarse(problem, base) else problem

    def title(pair: tuple[str, ...]) -> str:
        return f"{' + '.join(pair)} in place of the {spline.name}"

    def fitted(pair: tuple[str, ...]) -> Fit:
        progress(title(pair))
        return fitted_from(quick, found, Hypothesis((*found.hypothesis.names, *pair)))

    tried = list(itertools.combinations(dict.fromkeys((*listed, *constant)), 2))
    pairs = fitted_each(fitted, tried, title, ledger.failures)
    pairs = sorted(pairs, key=lambda one: ledger.criterion.value(one[1]))[:_FINISHED]
    finished = fitted_each(
        lambda one: fitted_from(problem, one[1], one[1].hypothesis), pairs, lambda one: title(one[0]), ledger.failures
    )
    if not finished:
        return found
    (pair, _), best = min(finished, key=lambda one: ledger.criterion.value(one[1]))
    return best if ledger.decide(Rule.PREFER, best, found, pair) else found
