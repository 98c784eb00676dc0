"""Attempts: which effects can be tried, what a round of them finds, and how a line of the ledger tells it.

All candidates get a look (`fit.looks`), those that promise something a fit. Every step keeps what lowers the deviance,
scaled for what it is worth (`Fit.score`), by more than its price: log n for a number (BIC), and the `THRESHOLD` for a
choice among many.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TypeVar

from analytic.effects import CATALOGUE
from harness.identify.estimate.fit import COARSE, INFLATION, Fit, Look, fit, looks, unfitted
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem

THRESHOLD = 6.0  # of the score, beyond which an effect is kept
_NEAR = 3.0  # times the angle's floor

_STEPS = (COARSE, 1.0, -1.0)  # of looks where much is missing
# What a look must promise for a fit to follow: nearly what it costs, and a part of what the best one promises, as laws
# that are far from linear keep less of their promise than others; in the place of an effect, most of what it did.
_SLACK, _PART, _MOST = 4.0, 0.1, 0.4
_MOST_FOLLOWED = 8
_FOLLOWED = 2  # starts of a law that are followed to their ends
_HOPELESS = 30.0  # of the score behind the best after one round: five times what would still be told apart

Progress = Callable[[str], None]
_S = TypeVar("_S")
_T = TypeVar("_T")


@dataclass(frozen=True)
class Entry:
    """One line of the ledger.

    Attributes:
        effect: what was tried.
        beside: on top of what.
        gain: of the score, of the BIC where there is a curve, over `against`.
        kept: whether it was kept then.
        because: why.
        fit, against: with it and without, or with what it was held against.
        rule: by which it was decided: the "score", by more than `THRESHOLD`; a "split" of one law into two, or back;
            "again", a runner-up with which the search begins anew; "either", what that led to against what there was;
            the "curve" beside it; or the "prediction" of held-out windows.
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
    """What can be tried: the catalogue, but for what the model has already, and for what nothing can show."""
    there = {one.effect.name for one in problem.declared if one.effect.relations.once}
    return tuple(
        name
        for name, effect in CATALOGUE.items()
        if name not in hidden_by(problem.unknown)
        and name not in there
        and not effect.relations.in_baseline(problem.model)
    )


def hidden_by(unknown: Sequence[str]) -> tuple[str, ...]:
    """Effects that no recording can show where these stand for what is unknown: the rig's estimates take them in.

    K g α of the record is all that a gain of the angle, one of the position and the rolling radius change, but for
    terms that are small at small angles.
    """
    hidden: list[str] = []
    for name in unknown:
        quantity = CATALOGUE[name].relations.stands_for
        hidden += [name, *(other for other, effect in CATALOGUE.items() if quantity in effect.relations.hidden_by)]
    return tuple(hidden)


def found_in(problem: Problem, best: Fit) -> tuple[str, ...]:
    """Effects of a fit that are not among what is unknown of the rig."""
    return tuple(name for name in best.hypothesis.names if name not in problem.unknown)


def explained(problem: Problem, found: Fit) -> bool:
    """Whether what is left is what the angle's own error leaves, or little more."""
    return found.root_density < _NEAR * problem.angle_floor


def fitted(problem: Problem, names: tuple[str, ...], base: Fit) -> Fit:
    """These effects, fitted from where `base` is."""
    return fit(problem, Hypothesis(names), density=base.density, known=base.values())


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

    seen = _looks(problem, base, progress, without, (COARSE,) if near or in_its_place else _STEPS)
    promises = {name: promise(seen[name]) for name in seen}
    least = max((_MOST if in_its_place else _PART) * max(promises.values()), -_SLACK)
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
        if one.score > best + (_HOPELESS if one.hypothesis.names[-1] in followed else 0.0):
            return one
        progress(f"fit of {' + '.join(one.hypothesis.names)}")
        return fit(problem, one.hypothesis, density=one.density, starts=[one.numbers])

    rough = side_by_side(follow, names)
    best = min((one.score for one in rough if one.hypothesis.names[-1] in followed), default=-math.inf)
    return sorted(side_by_side(finish, rough), key=lambda one: one.score)


def glimpse(problem: Problem, base: Fit, progress: Progress) -> float:
    """The least score that a look sees beside `base`."""
    seen = _looks(problem, base, progress, "", _STEPS)
    return min(unfitted(problem, _with(base, name), found[0]).score for name, found in seen.items())


def _looks(
    problem: Problem, base: Fit, progress: Progress, without: str, steps: Sequence[float]
) -> dict[str, list[Look]]:
    """Looks at every candidate but `without` beside those of `base`."""
    names = [name for name in candidates(problem) if name not in (*base.hypothesis.names, without)]

    def look(name: str) -> list[Look]:
        progress(" + ".join((*base.hypothesis.names, name)))
        return looks(problem, _with(base, name), base.density, base.values(), without=base.deviance, steps=steps)

    return dict(zip(names, side_by_side(look, names), strict=True))


def _with(base: Fit, name: str) -> Hypothesis:
    return Hypothesis((*base.hypothesis.names, name), base.hypothesis.shape)


def side_by_side(attempt: Callable[[_S], _T], each: Iterable[_S]) -> list[_T]:
    """All attempts, in order; threads do, because the compiled filter runs without the interpreter's lock."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(attempt, each))


def tell(tried: Sequence[Fit], base: Fit, winner: Fit, *, rule: str = "score", kept: bool = True) -> list[Entry]:
    """Lines of a round of attempts on top of `base`, of which `winner` was kept if any of them was."""
    return [_line(one, base, winner, kept and one is winner, rule) for one in tried]


def _line(one: Fit, base: Fit, winner: Fit, kept: bool, rule: str) -> Entry:
    name, gain = one.hypothesis.names[-1], base.score - one.score
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
    return Entry(name, base.hypothesis.names, gain, kept, because, one, base, rule)
