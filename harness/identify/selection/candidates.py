"""Candidates: the effects that can be added to a fit, a screening fit of each, a full fit of the promising ones."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np

from analytic.effects import CATALOGUE
from harness.failures import Failed, Failures, Part, caught
from harness.identify.estimate.fit import Fit, fit, quiet_deviance, unrefined
from harness.identify.estimate.screening import COARSE_STEP, ScreeningFit, screen
from harness.identify.estimate.starts import starting_points
from harness.identify.estimate.window_errors import window_errors
from harness.identify.filter.run import deviance
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import windows_of
from harness.identify.selection.criterion import Criterion
from harness.parallel import side_by_side
from harness.progress import Progress
from harness.threads import in_threads

_FEW = 2  # effects that may explain a recording; more of them may imitate one law that is not listed
_S = TypeVar("_S")
_T = TypeVar("_T")

_FEWER = 0.5  # share of the integration steps up to which coarse data are worth a search of their own
_FITTED, _NEAR_BEST = 4, 0.3  # candidates fitted to all readings: those that gain nearly as much as the best
_STEPS = (COARSE_STEP, 1.0, -1.0)  # of the Jacobian's differences where much is left to explain


def candidates(problem: Problem) -> tuple[str, ...]:
    """Effects of the catalogue that can be tried: not in the model already, and not hidden by unknown quantities."""
    known = {term.effect.name for term in problem.declared if term.effect.relations.once}
    return tuple(
        name
        for name, effect in CATALOGUE.items()
        if name not in hidden_by(problem.unknown)
        and name not in known
        and (effect.by_recording is None or len(problem.recordings) > 1)
        and not effect.relations.in_baseline(problem.model)
    )


def common_effects(problem: Problem) -> tuple[str, ...]:
    """The candidates that are common on measured rigs."""
    return tuple(name for name in candidates(problem) if CATALOGUE[name].relations.common)


def hidden_by(unknown: Sequence[str]) -> tuple[str, ...]:
    """Effects that cannot be separated from the `unknown` rig quantities, whose estimates absorb them.

    A gain of the angle, a gain of the position and the rolling radius all change K g α, and other terms only little at
    small angles.
    """
    hidden: list[str] = []
    for name in unknown:
        quantity = CATALOGUE[name].relations.stands_for
        hidden += [name, *(other for other, effect in CATALOGUE.items() if quantity in effect.relations.hidden_by)]
    return tuple(hidden)


def selected_effects(problem: Problem, found: Fit) -> tuple[str, ...]:
    """Effects of a fit without the stand-ins for unknown rig quantities."""
    return tuple(name for name in found.hypothesis.names if name not in problem.unknown)


def explained_by_few(problem: Problem, found: Fit) -> bool:
    """Whether one effect or two leave nothing to explain: no other kind of law has then to be tried."""
    few = len(selected_effects(problem, found)) <= _FEW
    return few and Criterion(problem.settings).at_noise_floor(problem, found)


def refitted(problem: Problem, names: tuple[str, ...], base: Fit) -> Fit:
    """A fit of these effects, started from the values of `base`."""
    return fitted_from(problem, base, Hypothesis(names))


def fitted_from(problem: Problem, one: Fit, hypothesis: Hypothesis) -> Fit:
    """A hypothesis fitted to the readings of `problem`, started from the values and the process noise of a fit."""
    return fit(problem, hypothesis, process_noise=one.process_noise, initial=one.values())


def fit_candidates(
    problem: Problem,
    base: Fit,
    progress: Progress,
    *,
    excluding: str = "",
    replacing: bool = False,
    failures: Failures | None = None,
) -> list[Fit]:
    """Fits of `base` with each candidate added, best first; only promising screening fits are optimised further.

    Where `base` leaves the process noise far above its floor, what is missing is seen in a part of the readings: coarse
    data tell which few candidates are fitted to all of them.

    Args:
        excluding: an effect that is not tried.
        replacing: whether candidates replace that effect; they then have to explain most of what it did.
        failures: collects candidates that raise, which are then left out; `None` lets them raise.
    """
    fitted = _fit_from_coarse if is_seen_in_coarse(problem, base) else _fit_candidates
    return fitted(problem, base, progress, excluding, replacing, failures)


def is_seen_in_coarse(problem: Problem, base: Fit) -> bool:
    """Whether coarse data, where they are fewer, tell what `base` lacks."""
    return are_coarse_fewer(problem) and Criterion(problem.settings).far_above_noise_floor(problem, base)


def are_coarse_fewer(problem: Problem) -> bool:
    """Whether coarse data save a good part of the work."""
    return problem.coarse.steps < _FEWER * problem.steps


def predicts_poorly(problem: Problem, found: Fit) -> bool:
    """Whether windows are predicted with larger errors than a complete model would make."""
    errors = window_errors(problem, found, windows_of(problem.recordings))
    return Criterion(problem.settings).predicts_poorly(problem, errors)


def _fit_from_coarse(
    problem: Problem, base: Fit, progress: Progress, excluding: str, replacing: bool, failures: Failures | None
) -> list[Fit]:
    """As `fit_candidates`: fitted to coarse data, the best of these to all readings, one if it explains little."""
    coarse, criterion = problem.coarse, Criterion(problem.settings)
    begin = replace(
        base,
        deviance=deviance(coarse, base.terms, base.process_noise),
        quiet_deviance=math.inf,
        readings=coarse.readings,
    )
    ranked = _fit_candidates(coarse, begin, progress, excluding, replacing, failures)
    least = criterion.gain(ranked[0], begin) * (1.0 - _NEAR_BEST) if ranked else 0.0
    bare = fitted_from(coarse, base, base.refined) if ranked else begin
    count = _FITTED if any(criterion.explains(one, bare) for one in ranked) else 1
    near = {id(one) for one in ranked[:count] if not one.abandoned and criterion.gain(one, begin) >= least}

    def finish(one: Fit) -> Fit:
        if id(one) not in near:
            return _evaluated(problem, one)
        progress(f"fit: {' + '.join(one.hypothesis.names)}")
        return fitted_from(problem, one, one.refined)

    def title(one: Fit) -> str:
        return " + ".join(one.hypothesis.names)

    return criterion.ranked(one for _, one in fitted_each(finish, ranked, title, failures))


def _evaluated(problem: Problem, coarse: Fit) -> Fit:
    """A fit to coarse data at the same values on all readings, not continued.

    Its standard errors are those of the coarse data; what recordings have of their own has none.
    """
    theta = starting_points(problem, coarse.hypothesis, coarse.values(), coarse.process_noise)[0]
    terms, shared = coarse.hypothesis.terms(theta, problem), len(coarse.hypothesis.parameters)
    covariance = np.zeros((len(theta), len(theta)))
    covariance[:shared, :shared] = coarse.covariance[:shared, :shared]
    return replace(
        coarse,
        theta=theta,
        terms=terms,
        deviance=deviance(problem, terms, coarse.process_noise),
        covariance=covariance,
        readings=problem.readings,
        abandoned=True,
        quiet_deviance=quiet_deviance(problem, terms),
    )


def _fit_candidates(
    problem: Problem, base: Fit, progress: Progress, excluding: str, replacing: bool, failures: Failures | None
) -> list[Fit]:
    """As `fit_candidates`, on the readings of `problem`."""
    settings, criterion = problem.settings, Criterion(problem.settings)
    at_floor = criterion.at_noise_floor(problem, base)

    def predicted_decrease(screened: list[ScreeningFit]) -> float:
        """Predicted decrease of the criterion; without the penalty on parameters where much is left to explain,
        because the process noise then hides the gain."""
        deviance = min(end.expected_deviance for end in screened)
        price = math.log(problem.readings) * (len(screened[0].theta) - len(base.theta)) if at_floor else 0.0
        return base.deviance - deviance - price

    steps = (COARSE_STEP,) if at_floor or replacing else _STEPS
    screened = _screened(problem, base, progress, excluding, steps, failures)
    if not screened:
        return []
    decreases = {name: predicted_decrease(screened[name]) for name in screened}
    share = settings.replacement_share if replacing else settings.screened_share
    least = max(share * max(decreases.values()), -settings.screened_slack)
    names = sorted(screened, key=lambda name: -decreases[name])
    promising = {name for name in names[: settings.max_fitted] if decreases[name] >= least}

    def begin(name: str) -> Fit:
        first = screened[name][0]
        if name not in promising:
            return unrefined(problem, _with(base, name), first)
        progress(f"fit: {_title(base, name)}")
        close = first.deviance + settings.screened_share * (base.deviance - first.deviance)
        starts = [end.theta for end in screened[name][: settings.starts_followed] if end.deviance <= close]
        return fit(problem, _with(base, name), process_noise=first.process_noise, starts=starts, rounds=1)

    def finish(first: Fit) -> Fit:
        abandon = settings.abandon_behind if first.hypothesis.names[-1] in promising else 0.0
        if criterion.value(first) > best + abandon:
            return replace(first, abandoned=True)
        progress(f"fit: {title(first)}")
        return fit(problem, first.hypothesis, process_noise=first.process_noise, starts=[first.theta])

    def title(fit: Fit) -> str:
        return " + ".join(fit.hypothesis.names)

    begun = [one for _, one in fitted_each(begin, names, lambda name: _title(base, name), failures)]
    best = min((criterion.value(one) for one in begun if one.hypothesis.names[-1] in promising), default=-math.inf)
    return criterion.ranked(one for _, one in fitted_each(finish, begun, title, failures))


def best_screened(problem: Problem, base: Fit, progress: Progress, failures: Failures | None = None) -> float:
    """The lowest criterion of the screening fits of `base` with a candidate added."""
    screened = _screened(problem, base, progress, "", _STEPS, failures)
    criterion = Criterion(problem.settings)
    fits = (unrefined(problem, _with(base, name), ends[0]) for name, ends in screened.items())
    return min(map(criterion.value, fits), default=math.inf)


def _screened(
    problem: Problem, base: Fit, progress: Progress, excluding: str, steps: Sequence[float], failures: Failures | None
) -> dict[str, list[ScreeningFit]]:
    """Screening fits of `base` with each candidate added, by candidate."""
    names = [name for name in candidates(problem) if name not in (*base.hypothesis.names, excluding)]

    def screened(name: str) -> list[ScreeningFit]:
        progress(f"screening: {_title(base, name)}")
        hypothesis = _with(base, name)
        return screen(problem, hypothesis, base.process_noise, base.values(), without=base.deviance, steps=steps)

    return dict(fitted_each(screened, names, lambda name: _title(base, name), failures))


def _title(base: Fit, name: str) -> str:
    return " + ".join((*base.hypothesis.names, name))


def _with(base: Fit, name: str) -> Hypothesis:
    return Hypothesis((*base.hypothesis.names, name), base.hypothesis.spline)


def fitted_each(
    function: Callable[[_S], _T],
    arguments: Sequence[_S],
    title: Callable[[_S], str],
    failures: Failures | None,
    *,
    jobs: int = 1,
    begins: Callable[[_S], None] = lambda _: None,
) -> list[tuple[_S, _T]]:
    """Each argument with its result, in order; without those of which the function raises, or whose deviance is no
    number.

    Args:
        function: computed in `jobs` forked processes, from which its results are pickled; in threads for one.
        title: names the candidate of an argument.
        failures: collects them; `None` lets them raise.
        begins: told of each argument when its turn comes, in this process.
    """

    def checked(argument: _S) -> _T:
        result = function(argument)
        for one in result if isinstance(result, list) else [result]:
            if math.isnan(getattr(one, "deviance", 0.0)):
                raise FloatingPointError("the deviance of this fit is not a number")
        return result

    def tried(argument: _S) -> _T | Failed:
        if failures is None:
            return checked(argument)
        return caught(Part.CANDIDATE, title(argument), partial(checked, argument))

    def told(argument: _S) -> _T | Failed:
        begins(argument)
        return tried(argument)

    def began(turns: slice) -> None:
        for argument in arguments[turns]:
            begins(argument)

    if jobs > 1:
        began(slice(0, jobs))
        results = side_by_side(
            [partial(tried, one) for one in arguments], jobs, lambda done: began(slice(jobs + done - 1, jobs + done))
        )
    else:
        results = in_threads(told, arguments)
    pairs = []
    for argument, result in zip(arguments, results, strict=True):
        if not isinstance(result, Failed):
            pairs.append((argument, result))
        elif failures is not None:
            failures.add(result)
    return pairs
