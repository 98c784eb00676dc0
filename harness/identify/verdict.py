"""The verdict: nothing, an effect, something that no catalogue lists, or that these recordings cannot tell."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from harness.identify.estimate.covariance import with_interval_covariance
from harness.identify.estimate.fit import TWO_SIDED, Fit
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.selection.candidates import candidates, selected_effects
from harness.identify.selection.criterion import Criterion, Rule
from harness.identify.selection.ledger import Line
from harness.identify.selection.search import Selection, search


class Verdict(StrEnum):
    """First-class answers; names as in diagnosis.json."""

    NONE = "none"
    EFFECT = "effect"
    UNLISTED = "unlisted"
    NOT_IDENTIFIABLE = "not_identifiable"


@dataclass(frozen=True)
class Estimate:
    """A parameter's value with its 95 % interval, in `unit`."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class IdentifiedEffect:
    """An effect that acts: its parameters by name, and the effects that it cannot be told from."""

    name: str
    parameters: Mapping[str, Estimate]
    indistinguishable_from: tuple[str, ...]


@dataclass(frozen=True)
class Identification:
    """What was identified, before anything is validated.

    Attributes:
        problem: what was looked at.
        verdict: the answer.
        effects: that act beside the known ones.
        base, found: fits without and with what was found.
        ledger: every decision.
        unseen: effects whose typical size is below the detection limit of these recordings.
    """

    problem: Problem
    verdict: Verdict
    effects: tuple[IdentifiedEffect, ...]
    base: Fit
    found: Fit
    ledger: tuple[Line, ...]
    unseen: tuple[str, ...]

    @property
    def selection(self) -> Selection:
        """The fits and the ledger alone."""
        return Selection(self.base, self.found, self.ledger)

    @property
    def depends_on(self) -> tuple[Regressor, ...]:
        """What an unlisted law depends on, strongest first; nothing without one.

        First what the spline term depends on, then what any other one does whose BIC is within its threshold of the
        best: that would not have decided. A friction follows the sign of the velocity beside its own argument.
        """
        best = self.found.hypothesis.spline
        if best is None:
            return ()
        criterion = Criterion(self.problem.settings)
        tried = [one.fit for one in self.ledger if one.rule is Rule.SPLINE]
        lowest = min((criterion.value(one) for one in tried), default=criterion.value(self.found))
        near = [one for one in tried if criterion.value(one) - lowest <= self.problem.settings.spline_keep]
        shapes = [best, *(one.hypothesis.spline for one in sorted(near, key=criterion.value))]
        return tuple(dict.fromkeys(on for spline in shapes if spline is not None for on in _arguments(spline)))


def identify(problem: Problem, progress: Callable[[str], None] = lambda _: None) -> Identification:
    """Find what acts, and judge it: what `harness diagnose` says, and what the blind trials calibrate."""
    return judge(problem, search(problem, progress))


def judge(problem: Problem, selection: Selection) -> Identification:
    """The verdict on what was selected."""
    criterion = Criterion(problem.settings)
    found = with_interval_covariance(problem, selection.found)
    unseen = _unseen(problem, selection.ledger, criterion)
    names = selected_effects(problem, found)
    if found.hypothesis.spline is not None:
        verdict = Verdict.UNLISTED
    elif names:
        verdict = Verdict.EFFECT
    elif criterion.unexplained(problem, found) or len(unseen) > problem.settings.unseen_share * len(
        candidates(problem)
    ):
        verdict = Verdict.NOT_IDENTIFIABLE
    else:
        verdict = Verdict.NONE
    return Identification(
        problem=problem,
        verdict=verdict,
        effects=tuple(_identified(problem, name, found, selection.ledger) for name in names),
        base=selection.base,
        found=found,
        ledger=selection.ledger,
        unseen=unseen,
    )


def _identified(problem: Problem, name: str, found: Fit, ledger: Sequence[Line]) -> IdentifiedEffect:
    deviations = found.deviations()
    (acting,) = (one for one in found.terms.effects if one.effect.name == name)
    parameters = {}
    for parameter in acting.effect.parameters:
        value = acting.values[parameter.name]
        reach = TWO_SIDED * problem.settings.inflation * float(deviations[name, parameter.name])
        parameters[parameter.name] = Estimate(value, value - reach, value + reach, parameter.unit)
    rivals = _rivals(name, found, ledger, Criterion(problem.settings))
    return IdentifiedEffect(name, parameters, tuple(sorted(rivals)))


def _rivals(name: str, found: Fit, ledger: Sequence[Line], criterion: Criterion) -> set[str]:
    """What does nearly as well in the place of an effect, or did before it was split and another took that place."""
    rest = set(found.hypothesis.names) - {name}
    rivals: set[str] = set()
    for line in ledger:
        if set(line.beside) == rest and name not in line.effects and criterion.rivals(line.fit, found):
            rivals |= set(line.effects)
        replaced = line.kept and line.rule in (Rule.SPLIT, Rule.MERGE) and name in line.effects
        if replaced and criterion.rivals(line.against, found):
            rivals |= set(line.against.hypothesis.names)
    return rivals - set(found.hypothesis.names)


def _unseen(problem: Problem, ledger: Sequence[Line], criterion: Criterion) -> tuple[str, ...]:
    """Effects of which a typical size is below the detection limit."""
    latest = {line.title: line for line in ledger if line.fit.hypothesis.spline is None and not line.kept}
    unseen = []
    for name, line in latest.items():
        tried = [one.effect for one in line.fit.terms.effects if one.effect.name == name]
        if not tried:
            continue
        key = tried[0].parameters[0]
        error = problem.settings.inflation * line.fit.deviations()[name, key.name]
        limit = criterion.detection_limit(line.fit.readings, len(tried[0].parameters))
        if not error or key.size(problem.rig) / error < limit:
            unseen.append(name)
    return tuple(unseen)


def _arguments(spline: SplineTerm) -> list[Regressor]:
    return [spline.depends, Regressor.VELOCITY] if spline.friction else [spline.depends]
