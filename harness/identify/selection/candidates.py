"""Candidates: which effects can be added to a fit, a screening fit of each, and a fit of the promising ones."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from analytic.effects import CATALOGUE
from harness.identify.estimate.fit import Fit, fit, unrefined
from harness.identify.estimate.screening import COARSE_STEP, ScreeningFit, screen
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.criterion import Criterion

Progress = Callable[[str], None]
_S = TypeVar("_S")
_T = TypeVar("_T")

_STEPS = (COARSE_STEP, 1.0, -1.0)  # of the Jacobian's differences where much is missing


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


def selected_effects(problem: Problem, one: Fit) -> tuple[str, ...]:
    """Effects of a fit that do not stand for what is unknown of the rig."""
    return tuple(name for name in one.hypothesis.names if name not in problem.unknown)


def refitted(problem: Problem, names: tuple[str, ...], base: Fit) -> Fit:
    """These effects, fitted from where `base` is."""
    return fit(problem, Hypothesis(names), process_noise=base.process_noise, known=base.values())


def fit_candidates(
    problem: Problem, base: Fit, progress: Progress, *, excluding: str = "", replacing: bool = False
) -> list[Fit]:
    """Every candidate beside the effects of `base`, best first; fitted where its screening fit promises something.

    Args:
        excluding: an effect that is not tried.
        replacing: whether candidates are tried in the place of that effect; they then have to do most of what it did.
    """
    settings, criterion = problem.settings, Criterion(problem.settings)
    near = criterion.explained(problem, base)

    def promise(screened: list[ScreeningFit]) -> float:
        """Predicted decrease of the criterion; where much is missing without the price of parameters, because the
        process noise then hides the gain."""
        deviance = min(one.hoped for one in screened)
        price = math.log(problem.readings) * (len(screened[0].theta) - len(base.theta)) if near else 0.0
        return (base.deviance - deviance) / settings.overdispersion - price

    screened = _screened(problem, base, progress, excluding, (COARSE_STEP,) if near or replacing else _STEPS)
    if not screened:
        return []
    promises = {name: promise(screened[name]) for name in screened}
    share = settings.replacement_share if replacing else settings.screened_share
    least = max(share * max(promises.values()), -settings.screened_slack)
    names = sorted(screened, key=lambda name: -promises[name])
    promising = {name for name in names[: settings.max_fitted] if promises[name] >= least}

    def begin(name: str) -> Fit:
        first = screened[name][0]
        if name not in promising:
            return unrefined(problem, _with(base, name), first)
        progress(f"fit of {' + '.join((*base.hypothesis.names, name))}")
        close = first.deviance + settings.screened_share * (base.deviance - first.deviance)
        starts = [one.theta for one in screened[name][: settings.starts_followed] if one.deviance <= close]
        return fit(problem, _with(base, name), process_noise=first.process_noise, starts=starts, rounds=1)

    def finish(one: Fit) -> Fit:
        abandon = settings.abandon_behind if one.hypothesis.names[-1] in promising else 0.0
        if criterion.value(one) > best + abandon:
            return one
        progress(f"fit of {' + '.join(one.hypothesis.names)}")
        return fit(problem, one.hypothesis, process_noise=one.process_noise, starts=[one.theta])

    begun = in_threads(begin, names)
    best = min((criterion.value(one) for one in begun if one.hypothesis.names[-1] in promising), default=-math.inf)
    return sorted(in_threads(finish, begun), key=criterion.value)


def best_screened(problem: Problem, base: Fit, progress: Progress) -> float:
    """The lowest criterion that a screening fit of any candidate reaches beside `base`."""
    screened = _screened(problem, base, progress, "", _STEPS)
    criterion = Criterion(problem.settings)
    ends = (unrefined(problem, _with(base, name), found[0]) for name, found in screened.items())
    return min((criterion.value(one) for one in ends), default=math.inf)


def _screened(
    problem: Problem, base: Fit, progress: Progress, excluding: str, steps: Sequence[float]
) -> dict[str, list[ScreeningFit]]:
    """Screening fits of every candidate beside the effects of `base`."""
    names = [name for name in candidates(problem) if name not in (*base.hypothesis.names, excluding)]

    def screened(name: str) -> list[ScreeningFit]:
        progress(" + ".join((*base.hypothesis.names, name)))
        hypothesis = _with(base, name)
        return screen(problem, hypothesis, base.process_noise, base.values(), without=base.deviance, steps=steps)

    return dict(zip(names, in_threads(screened, names), strict=True))


def _with(base: Fit, name: str) -> Hypothesis:
    return Hypothesis((*base.hypothesis.names, name), base.hypothesis.spline)


def in_threads(function: Callable[[_S], _T], each: Iterable[_S]) -> list[_T]:
    """Results in order; threads do, because the compiled filter runs without the interpreter's lock."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(function, each))
