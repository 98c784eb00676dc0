"""A quick search on coarse data: whether effects and spline terms could explain long recordings at all.

The stepwise search weighs one-step predictions, and takes hundreds of fits. Where the sensors of a measured rig have
errors of their own colour, nothing that it adds brings the process noise near the input-noise floor, and held-out
errors decide in the end. The same search on a part of the readings, in long steps of the integration, shows that in a
small part of the time: what is far above the floor needs neither all readings nor short steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from harness.failures import Failures
from harness.identify.estimate.fit import Fit, fit, unrefined
from harness.identify.estimate.screening import screen
from harness.identify.estimate.window_errors import window_errors
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import windows_of
from harness.identify.selection.candidates import fit_candidates, fitted_each
from harness.identify.selection.criterion import Criterion, Rule
from harness.identify.selection.ledger import Ledger
from harness.identify.selection.spline_terms import with_spline_term
from harness.progress import Progress

_EFFECTS, _MUCH = 2, 0.5  # two effects that leave half of the root process noise are not what these recordings tell
_FITTED = 4  # candidates of a round that are fitted: the others are far behind where an effect explains much


@dataclass(frozen=True)
class QuickSearch:
    """What a quick search found on coarse data: the fits of its first round, and its result."""

    first: tuple[Fit, ...]
    found: Fit


def unexplained(problem: Problem, base: Fit, progress: Progress) -> QuickSearch | None:
    """What a quick search finds if that explains little, else `None`: two effects at most, and a spline term.

    It is not made, and `None` returned, where the whole search is short or `base` is not far from the recordings.
    """
    if problem.steps < problem.settings.quick_search_from or _explains(problem, base):
        return None
    coarse = replace(problem.coarse, settings=replace(problem.settings, max_fitted=_FITTED))
    ledger = Ledger(Criterion(coarse.settings), Failures())  # decides nothing of the result
    first = fit(coarse, base.hypothesis, initial=base.values())
    rounds: list[list[Fit]] = []
    found: Fit = first
    while len(rounds) < _EFFECTS:
        rounds.append(fit_candidates(coarse, found, progress, failures=ledger.failures))
        kept = ledger.decide_round(Rule.ADD, rounds[-1], found)
        if kept is None:
            break
        found = kept
    if _explains(coarse, found) or found.root_process_noise < _MUCH * first.root_process_noise:
        return None
    found = with_spline_term(coarse, first, found, ledger, progress)
    return None if _explains(coarse, found) else QuickSearch(tuple(rounds[0]), found)


def first_round(problem: Problem, base: Fit, quick: QuickSearch, ledger: Ledger, progress: Progress) -> Fit:
    """The best of `base` with one candidate and of the terms that the quick search found, on all readings.

    The candidates are screened on all readings from where the quick search left them; the best is fitted.
    """

    def screened(one: Fit) -> Fit:
        progress(f"screening: {' + '.join(one.hypothesis.names)}")
        begin = screen(problem, one.hypothesis, one.process_noise, one.values())[0]
        return replace(unrefined(problem, one.hypothesis, begin), abandoned=True)

    def fitted(one: Fit) -> Fit:
        progress(f"fit: {' + '.join(one.hypothesis.names)}")
        return fit(problem, one.refined, process_noise=one.process_noise, initial=one.values())

    def title(one: Fit) -> str:
        return " + ".join(one.hypothesis.names)

    tried = ledger.criterion.ranked(one for _, one in fitted_each(screened, quick.first, title, ledger.failures))
    tried = [fitted(one) for one in tried[:1]] + tried[1:]
    best = ledger.decide_round(Rule.ADD, tried, base) or base
    return min(best, fitted(quick.found), key=ledger.criterion.value)


def _explains(problem: Problem, found: Fit) -> bool:
    """Whether the process noise is not far above the floor, or predictions are good."""
    criterion = Criterion(problem.settings)
    errors = window_errors(problem, found, windows_of(problem.recordings))
    return not (criterion.far_above_noise_floor(problem, found) and criterion.predicts_poorly(problem, errors))
