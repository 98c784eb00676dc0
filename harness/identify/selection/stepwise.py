"""Which effects act: found one after the other, tested together, dropped when they no longer pay."""

from __future__ import annotations

from operator import itemgetter

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import THRESHOLD, Entry, Progress, beside, explained, found_in, glimpse, tell
from harness.identify.selection.swaps import MOST, settle

# What comes first by itself can be what two effects look like together. Where much is left in the end, the search
# begins again with one of so many runners-up: that beside which a look sees most, if it sees nearly as much.
_OTHERS = 4
_SHARE = 0.25  # of the winner's gain, below which another does not begin
_NEARLY = 10.0  # of the score, which a fit gains over a look


def select(problem: Problem, base: Fit, progress: Progress = lambda _: None) -> tuple[Fit, list[Entry]]:
    """Find the effects that the recordings call for.

    Args:
        base: what is to be explained: the fit of nothing but what is unknown of the rig.

    Returns:
        The best fit, and every attempt in order.
    """
    first = beside(problem, base, progress)
    ledger = tell(first, base, first[0], kept=_pays(first[0], base))
    best = _grown(problem, base, first[0], ledger, progress)
    if explained(problem, best):
        return best, ledger
    least = max(THRESHOLD, _SHARE * (base.score - first[0].score))
    others = [one for one in first[1 : 1 + _OTHERS] if base.score - one.score > least]
    seen, other = min(
        ((glimpse(problem, one, progress), one) for one in others), key=itemgetter(0), default=(0.0, None)
    )
    if other is not None and seen < best.score + _NEARLY:
        ledger += tell([other], base, other, rule="again")
        grown = _grown(problem, base, other, ledger, progress)
        names, rivals = (" + ".join(found_in(problem, one)) for one in (grown, best))
        kept = _pays(grown, best)
        because = f"explains {'' if kept else 'no '}more than {rivals}"
        gain = best.score - grown.score
        ledger.append(Entry(names, problem.unknown, gain, kept, because, grown, best, "either"))
        best = grown if kept else best
    return best, ledger


def _grown(problem: Problem, base: Fit, first: Fit, ledger: list[Entry], progress: Progress) -> Fit:
    """What is found when `first` is kept first: one effect after the other, until no further one pays."""
    best, winner = base, first
    while _pays(winner, best):
        best = settle(problem, winner, ledger, progress)
        if len(found_in(problem, best)) >= MOST:
            break
        tried = beside(problem, best, progress)
        winner = tried[0]
        ledger += tell(tried, best, winner, kept=_pays(winner, best))
    return best


def _pays(one: Fit, other: Fit) -> bool:
    return other.score - one.score > THRESHOLD
