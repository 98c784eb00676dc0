"""Which effects act: found one after the other, tested together, dropped when they no longer pay.

Every step keeps what lowers the deviance, scaled for what it is worth (`Fit.score`), by more than its price: log n for
a number (BIC), and the `threshold` for a choice among many. All candidates get a look (`fit.looks`), those that promise
something a fit.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TypeVar

from analytic.effects import CATALOGUE
from harness.identify.fit import COARSE, INFLATION, Fit, Look, fit, looks, unfitted
from harness.identify.hypothesis import Hypothesis
from harness.identify.problem import Problem

THRESHOLD = 6.0  # of the score, beyond which an effect is kept
_NEAR = 3.0  # times the angle's floor
MOST = 4  # effects found beside those declared; more are not told apart by recordings of this length

# What a look must promise for a fit to follow: nearly what it costs, and a part of what the best one promises; laws
# that are far from linear keep less of their promise than others.
_STEPS = (COARSE, 1.0, -1.0)  # of looks where much is missing
_SLACK, _PART = 4.0, 0.1
_STANDS_IN = 0.4  # of what it stands in for: a look at that sees the less of it the less linear it is
_MOST_FOLLOWED = 8
_MOSTLY = 0.1  # of the process noise is left by an effect that explains most of what was missing
_FOLLOWED = 2  # starts of a law that are followed to their ends
_HOPELESS = 30.0  # of the score behind the best after one round: five times what would still be told apart

# One law of several numbers that two laws of one number each imitate or are: on a beam that is not level a resistance
# differs by direction, one that bends is a bowl with its centre elsewhere, and friction that grows with speed from what
# it is at rest is resistance and drag. Two causes are the rarer explanation, so
# they have to be the better one by something: of blind trials in which the one acts, the two were better by 0.2 at
# most; in which the two act, by 3.4 at least.
SPLITS = {
    "directional_resistance": ("rolling_resistance", "level_error"),
    "track_curvature": ("level_error", "beam_compliance"),
    "stribeck_friction": ("rolling_resistance", "quadratic_drag"),
}
_RARER = 1.0  # of the score
# What comes first by itself can be what two effects look like together. Where much is left in the end, the search
# begins again with each of so many runners-up beside which a look sees more.
_OTHERS = 4
_SHARE = 0.25  # of the winner's gain, below which another does not begin

Progress = Callable[[str], None]
_S = TypeVar("_S")
_T = TypeVar("_T")


@dataclass(frozen=True)
class Entry:
    """One line of the ledger.

    Attributes:
        effect: what was tried.
        beside: on top of what.
        gain: of the score, beside a curve of the BIC, over `against`.
        kept: whether it was kept then.
        because: why.
        fit, against: with it and without.
        rule: by which it was decided: the "score", the "curve" beside it, or the "prediction" of held-out windows.
    """

    effect: str
    beside: tuple[str, ...]
    gain: float
    kept: bool
    because: str
    fit: Fit
    against: Fit
    rule: str = "score"


def candidates(problem: Problem) -> tuple[str, ...]:
    """What can be tried: the catalogue, but for the pivot where the baseline has it, and for what nothing can show."""
    return tuple(
        name
        for name in CATALOGUE
        if name not in hidden_by(problem.unknown) and not (name == "eccentric_pivot" and problem.model.eccentric)
    )


def hidden_by(unknown: Sequence[str]) -> tuple[str, ...]:
    """Effects that no recording can show where these stand for what is unknown: the rig's estimates take them in.

    K g α of the record is all that a gain of the angle, one of the position and the rolling radius change, but for
    terms that are small at small angles.
    """
    gains = ("angle_gain", "rolling_radius", "position_gain") if "angle_gain" in unknown else ()
    return (*gains, *(("level_error",) if "level_error" in unknown else ()))


def select(
    problem: Problem, progress: Progress = lambda _: None, *, threshold: float = THRESHOLD
) -> tuple[Fit, list[Entry]]:
    """Find the effects that the recordings call for.

    Returns:
        The best fit, and every attempt in order.
    """
    base = fit(problem, Hypothesis(problem.unknown))
    first = beside(problem, base, progress)
    best, ledger = _grown(problem, base, first, progress, threshold)
    for other in first[1 : 1 + _OTHERS]:
        if explained(problem, best) or base.score - other.score <= max(
            threshold, _SHARE * (base.score - first[0].score)
        ):
            break
        if _glimpse(problem, other, progress) < best.score - threshold:
            begin = [other, *(one for one in first if one is not other)]
            grown, attempts = _grown(problem, base, begin, progress, threshold)
            better = grown.score < best.score - threshold
            names, rivals = (" + ".join(found_in(problem, one)) for one in (grown, best))
            because = f"explains {'' if better else 'no '}more than {rivals} does"
            attempts.append(Entry(names, problem.unknown, best.score - grown.score, better, because, grown, best))
            ledger += attempts
            best = grown if better else best
    return best, ledger


def _grown(
    problem: Problem, base: Fit, first: list[Fit], progress: Progress, threshold: float
) -> tuple[Fit, list[Entry]]:
    """One effect after the other, beginning with the first of `first`, until no further one pays."""
    best, tried = base, first
    ledger: list[Entry] = []
    while True:
        winner = tried[0]
        kept = best.score - winner.score > threshold
        ledger += [_entry(one, best, kept and one is winner, winner) for one in tried]
        if not kept:
            return best, ledger
        best = _settle(problem, winner, ledger, progress, threshold)
        if len(found_in(problem, best)) >= MOST:
            return best, ledger
        tried = beside(problem, best, progress)


def found_in(problem: Problem, best: Fit) -> tuple[str, ...]:
    """Effects of a fit that are not among what is unknown of the rig."""
    return tuple(name for name in best.hypothesis.names if name not in problem.unknown)


def explained(problem: Problem, found: Fit) -> bool:
    """Whether what is left is what the angle's own error leaves, or little more."""
    return found.root_density < _NEAR * problem.angle_floor


def beside(
    problem: Problem, base: Fit, progress: Progress, *, without: str = "", in_its_place: bool = False
) -> list[Fit]:
    """Every candidate but `without` beside those of `base`, the best first.

    Fitted are those of which a look promises something; `in_its_place` those that would do most of what it did.
    """
    near = explained(problem, base)

    def promise(found: list[Look]) -> float:
        """Of the score; where much is missing of a score without a price, for the process noise then hides the gain."""
        deviance = min(min(one.promise, one.deviance) for one in found)
        price = math.log(problem.readings) * (len(found[0].numbers) - len(base.numbers)) if near else 0.0
        return (base.deviance - deviance) / INFLATION**2 - price

    seen = _looks(problem, base, progress, without, steps=(COARSE,) if near or in_its_place else _STEPS)
    promises = {name: promise(seen[name]) for name in seen}
    least = max((_STANDS_IN if in_its_place else _PART) * max(promises.values()), -_SLACK)
    names = sorted(seen, key=lambda name: -promises[name])
    followed = {name for name in names[:_MOST_FOLLOWED] if promises[name] >= least}

    def follow(name: str) -> Fit:
        first = seen[name][0]
        if name not in followed:
            return unfitted(problem, _with(base, name), first)
        progress(f"fit of {' + '.join((*base.hypothesis.names, name))}")
        near = first.deviance + _PART * (base.deviance - first.deviance)
        starts = [one.numbers for one in seen[name][:_FOLLOWED] if one.deviance <= near]
        return fit(problem, _with(base, name), density=first.density, starts=starts, rounds=1)

    def finish(one: Fit) -> Fit:
        if one.hypothesis.names[-1] not in followed or one.score > best + _HOPELESS:
            return one
        progress(f"fit of {' + '.join(one.hypothesis.names)}")
        return fit(problem, one.hypothesis, density=one.density, starts=[one.numbers])

    rough = _side_by_side(follow, names)
    best = min(one.score for one in rough)
    return sorted(_side_by_side(finish, rough), key=lambda one: one.score)


def _looks(
    problem: Problem, base: Fit, progress: Progress, without: str = "", *, steps: Sequence[float] = _STEPS
) -> dict[str, list[Look]]:
    """Looks at every candidate but `without` beside those of `base`."""
    names = [name for name in candidates(problem) if name not in (*base.hypothesis.names, without)]

    def look(name: str) -> list[Look]:
        progress(" + ".join((*base.hypothesis.names, name)))
        return looks(problem, _with(base, name), base.density, base.values(), without=base.deviance, steps=steps)

    return dict(zip(names, _side_by_side(look, names), strict=True))


def _glimpse(problem: Problem, base: Fit, progress: Progress) -> float:
    """The least score that a look sees beside `base`."""
    seen = _looks(problem, base, progress)
    return min(unfitted(problem, _with(base, name), found[0]).score for name, found in seen.items())


def _with(base: Fit, name: str) -> Hypothesis:
    return Hypothesis((*base.hypothesis.names, name), base.hypothesis.shape)


def _side_by_side(attempt: Callable[[_S], _T], each: Iterable[_S]) -> list[_T]:
    """All attempts, in order; threads do, because the compiled filter runs without the interpreter's lock."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(attempt, each))


def _settle(problem: Problem, best: Fit, ledger: list[Entry], progress: Progress, threshold: float) -> Fit:
    """Hold what was found against all that could stand in its place, until nothing changes."""
    while True:
        best = _split(problem, best, ledger, progress)
        held = best.hypothesis.names
        if len(found_in(problem, best)) > 1:
            best = _challenge(problem, best, ledger, progress, threshold)
        if best.hypothesis.names == held:
            return best


def _challenge(problem: Problem, best: Fit, ledger: list[Entry], progress: Progress, threshold: float) -> Fit:
    """Hold each kept effect against all others and against none; what the first change leads to, if there is one."""
    for name in found_in(problem, best):
        rest = tuple(other for other in best.hypothesis.names if other != name)
        progress(f"{name} again")
        without = _fit(problem, rest, best)
        if without.score < best.score + threshold:
            because = "no longer pays beside the others"
            ledger.append(Entry(name, rest, without.score - best.score, False, because, best, without))
            return without
        if best.density < _MOSTLY * without.density:
            others = beside(problem, _where(problem, without, best), progress, without=name, in_its_place=True)
        else:
            others = beside(problem, without, progress, without=name)
        better = others[0].score < best.score
        winner = others[0] if better else best
        ledger += [_entry(one, without, one is winner, winner) for one in others]
        if better:
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
    """Hold one law against the two that imitate it, whichever of them was found; two have to explain more."""
    for name, pair in SPLITS.items():
        names = found_in(problem, best)
        single, double = name in names and not set(pair) & set(names), name not in names and set(pair) <= set(names)
        if not (single or double):
            continue
        rest = tuple(other for other in best.hypothesis.names if other not in (name, *pair))
        old, new = (name,), pair
        if double:
            old, new = new, old
        progress(f"{' + '.join(new)} for {' + '.join(old)}")
        other = _fit(problem, (*rest, *new), best)
        gain = best.score - other.score
        kept = gain > (_RARER if single else -_RARER)
        because = f"{'explains' if kept else 'explains no'} more than {' + '.join(old)} does"
        if double and kept:
            because = f"explains as much as {' + '.join(old)} do"
        ledger.append(Entry(" + ".join(new), rest, gain, kept, because, other, best))
        best = other if kept else best
    return best


def _fit(problem: Problem, names: tuple[str, ...], base: Fit) -> Fit:
    return fit(problem, Hypothesis(names), density=base.density, known=base.values())


def _entry(one: Fit, base: Fit, kept: bool, winner: Fit) -> Entry:
    name = one.hypothesis.names[-1]
    least = math.log(base.readings) * (len(base.numbers) - len(one.numbers))  # where nothing of it acts
    gain = max(base.score - one.score, least)
    if kept:
        because = f"predicts better by {gain:.0f} (scaled BIC)"
    elif gain <= 0.0 or math.isnan(gain):
        because = "does not pay for its parameters"
    elif one is winner:
        because = f"gains {gain:.1f} (scaled BIC), within what chance gives"
    else:
        because = (
            f"gains {gain:.0f} (scaled BIC), {one.score - winner.score:.0f} less than {winner.hypothesis.names[-1]}"
        )
    return Entry(name, base.hypothesis.names, gain, kept, because, one, base)
