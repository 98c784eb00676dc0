"""The verdict: nothing, an effect, something that no catalogue lists, or that these recordings cannot tell."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from analytic.rig import Rig
from harness.identify.fit import INFLATION, Fit, fit
from harness.identify.hypothesis import Hypothesis
from harness.identify.in_engines import engine_errors
from harness.identify.problem import Problem
from harness.identify.remainder import remainder
from harness.identify.select import THRESHOLD, Entry, explained, select
from harness.identify.verify import Comparison, held_out, on_identify

_TWO_SIDED = 1.96
# Rivals whose BIC is this close to the kept effect's are not told apart by the data (Kass and Raftery, JASA 90, 1995:
# 6 to 10 is strong evidence).
RIVAL = 6.0
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
class Diagnosis:
    """What the recordings say.

    Attributes:
        problem: what was looked at.
        verdict: the answer.
        findings: the effects found.
        base, found: fits without and with what was found.
        ledger: every attempt.
        identify, heldout: errors before and after.
        engines: the same in the engines' scenes, as in diagnosis.json.
        unseen: effects that would go unseen here at their typical size.
    """

    problem: Problem
    verdict: Verdict
    findings: tuple[Finding, ...]
    base: Fit
    found: Fit
    ledger: tuple[Entry, ...]
    identify: Comparison
    heldout: Comparison
    engines: Mapping[str, Mapping[str, Any]]
    unseen: tuple[str, ...]


def diagnose(problem: Problem, progress: Callable[[str], None] = lambda _: None) -> Diagnosis:
    """Find, trace, verify."""
    base = fit(problem, Hypothesis(()))
    listed, ledger = select(problem, progress)
    found = listed
    if not explained(problem, listed):
        found, more = remainder(problem, listed, progress)
        ledger = [*ledger, *more]
    unseen = _unseen(ledger, problem.rig)
    if found.hypothesis.shape is not None:
        verdict = Verdict.UNLISTED
    elif found.hypothesis.names:
        verdict = Verdict.EFFECT
    elif len(unseen) > _BLIND * len({entry.effect for entry in ledger if not entry.beside}):
        verdict = Verdict.NOT_IDENTIFIABLE
    else:
        verdict = Verdict.NONE
    findings = tuple(_finding(name, found, ledger) for name in found.hypothesis.names)
    return Diagnosis(
        problem=problem,
        verdict=verdict,
        findings=findings,
        base=base,
        found=found,
        ledger=tuple(ledger),
        identify=on_identify(problem, base, found, progress),
        heldout=held_out(problem, base, found, progress),
        engines=engine_errors(problem, base, found, progress),
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
            reach = _TWO_SIDED * INFLATION * float(deviations[name, parameter.name])
            values[parameter.name] = value, value - reach, value + reach, parameter.unit
    rest = tuple(other for other in found.hypothesis.names if other != name)
    rivals = {
        entry.effect
        for entry in ledger
        if entry.effect not in found.hypothesis.names
        and set(entry.beside) == set(rest)
        and entry.fit.score - found.score < RIVAL
        and len(entry.fit.numbers) <= len(found.numbers)
    }
    return Finding(name, values, tuple(sorted(rivals)))


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
        neutral = {"gain": 1.0, "radius": rig.rolling_radius, "eccentricity": rig.eccentricity}.get(key.name, 0.0)
        size = abs(key.typical - neutral)
        price = THRESHOLD + math.log(entry.fit.readings) * len(tried[0].parameters)
        if not deviation or (size / (INFLATION * deviation)) ** 2 < price:
            unseen.append(name)
    return tuple(unseen)


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in words."""
    before, after = diagnosis.heldout.before.rms.get("whole"), diagnosis.heldout.after.rms.get("whole")
    fall = f"the held-out error falls from {_length(before)} to {_length(after)}" if before and after else ""
    match diagnosis.verdict:
        case Verdict.NONE:
            return "Nothing is missing beyond the noise: no effect of the catalogue predicts these recordings better."
        case Verdict.NOT_IDENTIFIABLE:
            return (
                "These recordings cannot tell: nothing was found, but a typical size of most effects would not have "
                f"been seen either ({', '.join(diagnosis.unseen[:6])} …)."
            )
        case Verdict.UNLISTED:
            shape = diagnosis.found.best.shape
            assert shape is not None
            kind = "a friction" if shape.friction else "a force"
            also = f" beside {_listed(diagnosis)}" if diagnosis.findings else ""
            return f"Something that the catalogue does not list: {kind} that depends on {shape.depends}{also}; {fall}."
        case Verdict.EFFECT:
            verb = "was" if len(diagnosis.findings) == 1 else "were"
            return f"{_listed(diagnosis)} {verb} missing; {fall}."


def _listed(diagnosis: Diagnosis) -> str:
    return " and ".join(f"{one.name} ({', '.join(_sizes(one))})" for one in diagnosis.findings)


def _sizes(one: Finding) -> list[str]:
    return [
        f"{key} = {value:.4g} ± {0.5 * (high - low):.1g} {unit}".removesuffix(" 1")
        for key, (value, low, high, unit) in one.values.items()
    ]


def _length(metres: float) -> str:
    return f"{1e3 * metres:.3g} mm"
