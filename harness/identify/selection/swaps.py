"""Effects found are held against all that could stand in their place, until nothing changes."""

from __future__ import annotations

import math
from dataclasses import replace

from analytic.effects import CATALOGUE
from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import THRESHOLD, Entry, Progress, beside, fitted, found_in, tell

MOST = 4  # effects found beside those declared; more are not told apart by recordings of this length
_MOSTLY = 0.1  # of the process noise is left by an effect that explains most of what was missing

# Two causes in the place of one law that they imitate (`Relations.splits_into`) are the rarer explanation, so they have
# to be the better one by something: of blind trials in which the one acts, the two were better by 0.2 at most; in which
# the two act, by 3.4 at least.
RARER = 1.0  # of the score


def settle(problem: Problem, best: Fit, ledger: list[Entry], progress: Progress) -> Fit:
    """What stays of an effect found beside others, with what takes the place of the others.

    Every change but a split lowers the score and the price of the choices together; a split may lead back to what had
    been held before, and that then stays.
    """
    held: list[set[str]] = []
    while True:
        best = _split(problem, best, ledger, progress)
        if set(best.hypothesis.names) in held:
            return best
        held.append(set(best.hypothesis.names))
        former = best
        if len(found_in(problem, best)) > 1:
            best = _challenge(problem, best, ledger, progress)
        if best is former:
            return best


def _challenge(problem: Problem, best: Fit, ledger: list[Entry], progress: Progress) -> Fit:
    """Hold each kept effect against none and against all others; what the first change leads to, if there is one."""
    for name in found_in(problem, best):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"{name} again")
        without = fitted(problem, rest, best)
        if without.score < best.score + THRESHOLD:
            because = "no longer pays beside the others"
            ledger.append(Entry(name, rest, without.score - best.score, False, because, best, without))
            return without
        if best.density < _MOSTLY * without.density:
            others = beside(problem, _where(problem, without, best), progress, without=name, in_its_place=True)
        else:
            others = beside(problem, without, progress, without=name)
        winner = min(others[0], best, key=lambda one: one.score)
        ledger += tell(others, without, winner)
        if winner is not best:
            return winner
    return best


def _where(problem: Problem, without: Fit, best: Fit) -> Fit:
    """`without` an effect, at the values that `best` has with it, and a process noise between those of the two.

    What stands in for that effect is looked for from there: fitted without it, the others have moved to make up for it.
    """
    density = math.sqrt(without.density * best.density)
    (start,) = without.hypothesis.starts(problem, best.values(), density)
    at = without.hypothesis.read(start, problem)
    deviance = problem.deviance(at.effects, at.phases, density, at.shape)
    return replace(without, numbers=start, best=at, density=density, deviance=deviance)


def _split(problem: Problem, best: Fit, ledger: list[Entry], progress: Progress) -> Fit:
    """Hold one law against the two that imitate it, whichever was found; two have to explain more, and each to pay."""
    for name, effect in CATALOGUE.items():
        pair = tuple(part.name for part in effect.relations.splits_into or ())
        names = found_in(problem, best)
        if not pair:
            continue
        parting = name in names and not set(pair) & set(names) and len(names) < MOST
        if not parting and (name in names or not set(pair) <= set(names)):
            continue
        old: tuple[str, ...] = (name,) if parting else pair
        new: tuple[str, ...] = pair if parting else (name,)
        rest = tuple(other for other in best.hypothesis.names if other not in old)
        progress(f"{' + '.join(new)} for {' + '.join(old)}")
        other = fitted(problem, (*rest, *new), best)
        gain = best.score - other.score
        kept = gain > (RARER if parting else -RARER)
        if parting and kept:
            kept = all(fitted(problem, (*rest, one), other).score - other.score > THRESHOLD for one in pair)
        how = "no more than" if not kept else "more than" if gain > RARER else "as much as"
        because = f"{'explain' if parting else 'explains'} {how} {' + '.join(old)}"
        ledger.append(Entry(" + ".join(new), rest, gain, kept, because, other, best, "split"))
        best = other if kept else best
    return best
