"""A quick search on coarse data: whether effects of the catalogue explain the recordings at all.

The stepwise search weighs one-step predictions, and takes hundreds of fits. Where a force acts that the catalogue has
not, or the sensors have errors of their own colour, nothing that it adds brings the process noise near the input-noise
floor, and a spline term or held-out errors decide in the end. The same search on a part of the readings, in long steps
of the integration, shows that in a small part of the time: what is far above the floor needs neither all readings nor
short steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from harness.failures import Failures
from harness.identify.estimate.fit import Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import (
    are_coarse_fewer,
    explained_by_few,
    fit_candidates,
    fitted_from,
    predicts_poorly,
    selected_effects,
)
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.spline_terms import with_spline_term
from harness.progress import Progress

_EFFECTS, _MUCH = 2, 0.5  # two effects that leave half of the root process noise are not what these recordings tell
_FITTED = 4  # candidates of a round that are fitted: the others are far behind where an effect explains much


@dataclass(frozen=True)
class QuickSearch:
    """What a quick search found on coarse data.

    Attributes:
        found: its result, without a spline term that is to be selected on all readings.
        spline: whether a spline term explains what effects do not.
    """

    found: Fit
    spline: bool


def without_stepwise(problem: Problem, base: Fit, first: Fit, progress: Progress) -> QuickSearch | None:
    """What a quick search finds if effects explain little on coarse data, else `None`: the stepwise search is needed.

    It adds effects, without swaps, as long as each explains something and as many as are selected at most, then a
    spline term. It is not made, and `None` returned, where `first` predicts well or coarse data are as many.

    Args:
        base, first: fits without effects, and with the first that was added.
    """
    if not (are_coarse_fewer(problem) and predicts_poorly(problem, first)):
        return None
    coarse = replace(problem.coarse, settings=replace(problem.settings, max_fitted=_FITTED))
    ledger = Ledger(Criterion(coarse.settings), Failures())  # decides nothing of the result
    bare = fit(coarse, base.hypothesis, initial=base.values())
    path, explains = [bare, _refitted(coarse, first)], ledger.criterion.explains
    while explains(path[-1], path[-2]) and len(path) <= problem.settings.max_effects:
        tried = fit_candidates(coarse, path[-1], progress, failures=ledger.failures)
        kept = ledger.decide_round(Rule.ADD, tried, path[-1])
        if kept is None:
            break
        path.append(kept)
        if explained_by_few(coarse, kept):
            return None
    left = min(one.root_process_noise for one in path[: 1 + _EFFECTS])
    effects = path[-1] if explains(path[-1], path[-2]) else path[-2]
    found = with_spline_term(coarse, bare, effects, ledger, progress)
    if found.hypothesis.spline is not None and found.root_process_noise < _MUCH * effects.root_process_noise:
        listed = Hypothesis(found.hypothesis.names)
        return QuickSearch(fitted_from(coarse, found, listed), spline=True)
    little = left > _MUCH * bare.root_process_noise and predicts_poorly(coarse, found)
    return QuickSearch(found, spline=False) if little and coarse.readings >= problem.settings.given_up_from else None


def on_all_readings(
    problem: Problem, quick: QuickSearch, base: Fit, first: Fit, ledger: Ledger, progress: Progress
) -> Fit:
    """The better of `first` and of the terms that the quick search found, fitted to all readings; `base` if no spline
    term is to follow and that explains little.

    Args:
        base, first: as for `without_stepwise`.
        ledger: records whether it explains enough.
    """
    found = first
    if quick.found.refined != first.hypothesis:
        progress(f"fit: {' + '.join(quick.found.hypothesis.names)}")
        found = min(first, _refitted(problem, quick.found), key=Criterion(problem.settings).value)
    if quick.spline or found.hypothesis == base.hypothesis:
        return found
    return found if ledger.decide(Rule.EXPLAIN, found, base, selected_effects(problem, found)) else base


def _refitted(problem: Problem, one: Fit) -> Fit:
    """The same hypothesis, fitted to other readings from its values."""
    return fitted_from(problem, one, one.refined)
