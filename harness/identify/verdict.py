"""The verdict: nothing, an effect, something that no catalogue lists, or that these recordings cannot tell."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from analytic.rig import Rig
from harness.identify.estimate.covariance import spread_over
from harness.identify.estimate.fit import INFLATION, TWO_SIDED, Fit, fit
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.selection.candidates import THRESHOLD, Entry, candidates, explained, found_in
from harness.identify.selection.spline_terms import remainder
from harness.identify.selection.stepwise import select

# Rivals whose BIC is this close to the kept effect's are not told apart by the data (Kass and Raftery, JASA 90, 1995:
# 6 to 10 is strong evidence).
RIVAL = 6.0
_UNEXPLAINED = 10.0  # times the angle's floor: something acts for which there is no name and no curve
_BLIND = 0.5  # share of the catalogue that a typical size of would go unseen, from which on the data cannot tell


class Verdict(StrEnum):
    """First-class answers; names as in diagnosis.json."""

    NONE = "none"
    EFFECT = "effect"
    UNLISTED = "unlisted"
    NOT_IDENTIFIABLE = "not_identifiable"


@dataclass(frozen=True)
class Finding:
    """An effect that acts: values, 95 % intervals and units by parameter, and what it cannot be told from."""

    name: str
    values: Mapping[str, tuple[float, float, float, str]]
    indistinguishable_from: tuple[str, ...]


@dataclass(frozen=True)
class Search:
    """What was found, before anything is verified.

    Attributes:
        problem: what was looked at.
        verdict: the answer.
        findings: the effects found.
        base, found: fits without and with what was found.
        ledger: every attempt.
        unseen: effects that would go unseen here at their typical size.
    """

    problem: Problem
    verdict: Verdict
    findings: tuple[Finding, ...]
    base: Fit
    found: Fit
    ledger: tuple[Entry, ...]
    unseen: tuple[str, ...]


def search(problem: Problem, progress: Callable[[str], None] = lambda _: None) -> Search:
    """Find what acts, and say it."""
    base = fit(problem, Hypothesis(problem.unknown))
    listed, ledger = select(problem, base, progress)
    found = listed
    if not explained(problem, listed):
        found, more = remainder(problem, listed, progress)
        ledger = [*ledger, *more]
    return judged(problem, base, found, ledger)


def judged(problem: Problem, base: Fit, found: Fit, ledger: Sequence[Entry]) -> Search:
    """The verdict on what was found."""
    found, unseen = spread_over(problem, found), _unseen(ledger, problem.rig)
    if found.hypothesis.shape is not None:
        verdict = Verdict.UNLISTED
    elif found_in(problem, found):
        verdict = Verdict.EFFECT
    elif found.root_density > _UNEXPLAINED * problem.angle_floor or len(unseen) > _BLIND * len(candidates(problem)):
        verdict = Verdict.NOT_IDENTIFIABLE
    else:
        verdict = Verdict.NONE
    findings = tuple(_finding(name, found, ledger) for name in found_in(problem, found))
    return Search(
        problem=problem,
        verdict=verdict,
        findings=findings,
        base=base,
        found=found,
        ledger=tuple(ledger),
        unseen=unseen,
    )


def _finding(name: str, found: Fit, ledger: Sequence[Entry]) -> Finding:
    deviations = found.deviations()
    values = {}
    for effect in found.best.effects:
        if effect.effect.name != name:
            continue
        for parameter in effect.effect.parameters:
            value = effect.values[parameter.name]
            reach = TWO_SIDED * INFLATION * float(deviations[name, parameter.name])
            values[parameter.name] = value, value - reach, value + reach, parameter.unit
    return Finding(name, values, tuple(sorted(_rivals(name, found, ledger))))


def _rivals(name: str, found: Fit, ledger: Sequence[Entry]) -> set[str]:
    """What does nearly as well in the place of an effect, or did before it and another took that place."""
    rest = set(found.hypothesis.names) - {name}

    def near(one: Fit) -> bool:
        if (one.hypothesis.shape is None) != (found.hypothesis.shape is None):
            return False
        return (one.score if one.hypothesis.shape is None else one.bic) < RIVAL + (
            found.score if found.hypothesis.shape is None else found.bic
        )

    rivals: set[str] = set()
    for entry in ledger:
        tried = entry.effect.split(" + ")
        if set(entry.beside) == rest and name not in tried and near(entry.fit):
            rivals |= set(tried)
        if entry.kept and entry.rule == "split" and name in tried and near(entry.against):
            rivals |= set(entry.against.hypothesis.names)
    return rivals - set(found.hypothesis.names)


def _unseen(ledger: Sequence[Entry], rig: Rig) -> tuple[str, ...]:
    """Effects of which a typical size would have lowered the deviance by less than the price of keeping them."""
    latest = {entry.effect: entry for entry in ledger if entry.fit.hypothesis.shape is None and not entry.kept}
    unseen = []
    for name, entry in latest.items():
        tried = [one.effect for one in entry.fit.best.effects if one.effect.name == name]
        if not tried:
            continue
        key = tried[0].parameters[0]
        deviation = entry.fit.deviations()[name, key.name]
        price = THRESHOLD + math.log(entry.fit.readings) * len(tried[0].parameters)
        if not deviation or (key.size(rig) / (INFLATION * deviation)) ** 2 < price:
            unseen.append(name)
    return tuple(unseen)
