"""The search as a whole: stepwise selection, then spline terms, then held-out errors."""

from __future__ import annotations

from dataclasses import dataclass

from harness.failures import Failures
from harness.identify.estimate.fit import Fit, fit
from harness.identify.estimate.predictions import as_predicted
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.beam_roughness import with_beam_roughness
from harness.identify.selection.candidates import explained_by_few, predicts_poorly, selected_effects
from harness.identify.selection.correlated_scores import without_correlated
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.held_out_search import search_by_held_out_errors
from harness.identify.selection.ledger import Ledger, Line
from harness.identify.selection.listed_pairs import in_place_of_spline_term
from harness.identify.selection.quick_search import on_all_readings, without_stepwise
from harness.identify.selection.spline_terms import with_spline_term
from harness.identify.selection.stepwise import Round, first_round, stepwise
from harness.progress import Progress, silent


@dataclass(frozen=True)
class Selection:
    """Result of the search.

    Attributes:
        problem: that the fits are of, with the roughness of the beam that the ball's readings tell.
        base, found: fits without and with the selected terms.
        ledger: every decision.
    """

    problem: Problem
    base: Fit
    found: Fit
    ledger: tuple[Line, ...]


def search(
    problem: Problem, progress: Progress = silent, failures: Failures | None = None, *, jobs: int = 1
) -> Selection:
    """Select the terms that the recordings require beside the known effects.

    Where the ball tells, before or after the first of them, that the beam moves more roughly than its angle's readings
    show, the search begins anew with such a beam. A play may seem to act for want of it, and must not come first.

    Args:
        failures: collects candidates and steps that raise, without which the search goes on; `None` lets them raise.
        jobs: processes for the search by held-out errors and for the band of predictions (`harness.parallel`).
    """
    ledger = Ledger(Criterion(problem.settings), failures)
    base = fit(problem, Hypothesis(problem.unknown))
    rougher = _as_rough_as_told(problem, base, ledger, progress)
    if rougher is not problem:
        return search(rougher, progress, failures, jobs=jobs)
    begun = ledger.attempt("first round", lambda: first_round(problem, base, ledger, progress), Round())
    if begun.kept is not None:
        rougher = _as_rough_as_told(problem, begun.kept, ledger, progress)
        if rougher is not problem:
            return search(rougher, progress, failures, jobs=jobs)
    selected = _by_likelihood(problem, base, begun, ledger, progress)
    found = ledger.attempt(
        "correlated scores", lambda: without_correlated(problem, selected, ledger, progress), selected
    )
    if not _complete(problem, found, ledger.criterion) and predicts_poorly(problem, found):
        chosen = base, found
        base, found = ledger.attempt(
            "search by held-out errors",
            lambda: search_by_held_out_errors(problem, *chosen, ledger, progress, jobs=jobs),
            chosen,
        )
        plain = found
        found = ledger.attempt("band of predictions", lambda: as_predicted(problem, plain, jobs=jobs), plain)
    return Selection(problem, base, found, tuple(ledger.lines))


def _complete(problem: Problem, found: Fit, criterion: Criterion) -> bool:
    """Whether what is predicted poorly is so for another reason than what the fit lacks.

    A fit whose process noise is below what the angle's own error does to the ball lacks nothing that the readings show:
    that error is then larger over seconds than as white noise of its density. And free runs over a few windows do not
    find the values of a curve, and where a ball rolls over hills and hollows they part whatever the law: a spline term
    that leaves nothing to explain is not put to them.
    """
    if found.hypothesis.spline is not None:
        return criterion.at_noise_floor(problem, found)
    return criterion.below_noise_floor(problem, found)


def _as_rough_as_told(problem: Problem, found: Fit, ledger: Ledger, progress: Progress) -> Problem:
    """The problem with the roughness of the beam that the ball tells beside what acts in `found`."""
    return ledger.attempt("roughness of the beam", lambda: with_beam_roughness(problem, found, progress), problem)


def _by_likelihood(problem: Problem, base: Fit, begun: Round, ledger: Ledger, progress: Progress) -> Fit:
    """The fit that stepwise selection and spline terms lead to; of the former one round if it can explain little."""
    criterion = ledger.criterion
    first, quick = begun.kept or base, None
    if not criterion.at_noise_floor(problem, first):
        quick = ledger.attempt("quick search", lambda: without_stepwise(problem, base, first, progress), None)
    if quick is None:
        effects = ledger.attempt("stepwise selection", lambda: stepwise(problem, base, begun, ledger, progress), first)
    else:
        effects = ledger.attempt(
            "quick search", lambda: on_all_readings(problem, quick, base, first, ledger, progress), first
        )
        if not quick.spline:
            return effects
    if explained_by_few(problem, effects):
        return effects
    spline = ledger.attempt("spline terms", lambda: with_spline_term(problem, base, effects, ledger, progress), effects)
    found = ledger.attempt("pairs", lambda: in_place_of_spline_term(problem, base, spline, ledger, progress), spline)
    return _explaining(problem, base, found, ledger)


def _explaining(problem: Problem, base: Fit, found: Fit, ledger: Ledger) -> Fit:
    """`found`, or `base` if its effects leave the process noise far above its floor and take away little of it."""
    names = selected_effects(problem, found)
    if not names or found.hypothesis.spline is not None or not ledger.criterion.far_above_noise_floor(problem, found):
        return found
    return found if ledger.decide(Rule.EXPLAIN, found, base, names) else base
