"""What a ledger comes to: the fit that its decisions leave, and the candidates that it does not tell of."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.failures import Failed, Part
from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import candidates
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.search import Selection

_TAKES_IF_KEPT = {
    Rule.ADD,
    Rule.SWAP,
    Rule.SPLIT,
    Rule.MERGE,
    Rule.SPLINE,
    Rule.REFINE,
    Rule.EXPLAIN,
    Rule.JOINT,
    Rule.EXTEND,
    Rule.EXCHANGE,
    Rule.PREFER,
    Rule.RESTORE,
}
_LEAVES_IF_NOT_KEPT = {Rule.DROP, Rule.ABSORB, Rule.PRUNE, Rule.VALIDATE, Rule.PREFER, Rule.EXPLAIN, Rule.CORRELATED}
_BY_HELD_OUT_ERRORS = {Rule.JOINT, Rule.VALIDATE, Rule.EXTEND, Rule.EXCHANGE, Rule.PRUNE, Rule.RESTORE}


def untried(problem: Problem, selection: Selection, failures: Iterable[Failed] = ()) -> tuple[str, ...]:
    """Candidates that the first round has no line of, and that did not fail: the search tries each of them alone."""
    failed = [one for one in failures if one.part in (Part.CANDIDATE, Part.SEARCH)]
    if any(one.name == "first round" for one in failed):
        return ()
    added = [line for line in selection.ledger if line.rule is Rule.ADD]
    begun = {line.effects for line in added if not _has_terms(problem, line.against)}
    names = {one.name.split(" + ")[-1] for one in failed}
    return tuple(name for name in candidates(problem) if (name,) not in begun and name not in names)


def contradiction(problem: Problem, selection: Selection, failures: Iterable[Failed] = ()) -> str:
    """Why the result of a selection is not what its decisions lead to; empty if it is, or if a step failed.

    A quick search may find terms that no decision names; they then have to fit better than what the decisions lead to.
    """
    if any(one.part is Part.SEARCH for one in failures):
        return ""
    found, results = selection.found, _possible_results(problem, selection)
    if any(_same_fit(found, one) for one in results):
        return ""
    named = any(_same_fit(found, one) for line in selection.ledger for one in (line.fit, line.against))
    if selection.ledger and not named and _better(problem, found, results[0]):
        return ""
    return f"{title(found)}, but the decisions of the ledger lead to {title(results[0])}"


def _same_fit(found: Fit, one: Fit) -> bool:
    """Whether the result is a certain fit, or this with the band of its predictions, which no decision depends on."""
    if found is one:
        return True
    parts = [(fit.hypothesis, fit.estimator, fit.held_out, fit.process_noise) for fit in (found, one)]
    same = parts[0] == parts[1] and np.array_equal(found.theta, one.theta)
    return same and np.array_equal(found.covariance, one.covariance, equal_nan=True)


def _possible_results(problem: Problem, selection: Selection) -> list[Fit]:
    """Fits of the ledger with which a search that made these decisions may end, the likeliest first."""
    if not selection.ledger:
        return [selection.base]
    now = selection.ledger[0].against
    by_likelihood = now  # what the search by held-out errors begins with
    for line in selection.ledger:
        if line.rule not in _BY_HELD_OUT_ERRORS:
            by_likelihood = now
        if line.rule is Rule.SPLINE and _has_terms(problem, line.against) and _better(problem, line.against, now):
            now = line.against  # found by a quick search
        if line.rule is Rule.RESTART or (line.rule in _TAKES_IF_KEPT and line.kept):
            now = line.fit
        elif line.rule in _LEAVES_IF_NOT_KEPT and not line.kept:
            now = line.against
        if line.rule not in _BY_HELD_OUT_ERRORS:
            by_likelihood = now
    if selection.ledger[-1].rule in (Rule.JOINT, Rule.VALIDATE):
        # Parameters by likelihood stay where they predict as well, and where nothing predicts better than the base.
        return [now, by_likelihood, selection.base]
    return [now]


def _has_terms(problem: Problem, fit: Fit) -> bool:
    """Whether a fit has more than the stand-ins for unknown rig quantities."""
    return any(name not in problem.unknown for name in fit.hypothesis.names) or fit.hypothesis.spline is not None


def _better(problem: Problem, fit: Fit, other: Fit) -> bool:
    criterion = Criterion(problem.settings)
    return fit.estimator is other.estimator and criterion.value(fit) < criterion.value(other)


def title(fit: Fit) -> str:
    """The terms of a fit in words."""
    terms = [*fit.hypothesis.names, *([fit.hypothesis.spline.name] if fit.hypothesis.spline else [])]
    return " + ".join(terms) or "no effect"
