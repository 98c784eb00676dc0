"""The verdict: no missing physics, effects of the catalogue, an unlisted effect, or not identifiable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from analytic.effects import Effect
from harness.failures import Failures, Part, attempt
from harness.identify.estimate.covariance import with_interval_covariance
from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.problem.spline_term import Regressor, SplineTerm
from harness.identify.record.rivals import rival_sets
from harness.identify.selection.candidates import candidates, selected_effects
from harness.identify.selection.criterion import Criterion, same_laws
from harness.identify.selection.decision import Rule
from harness.identify.selection.ledger import Line
from harness.identify.selection.search import Selection, search
from harness.numerics import TWO_SIDED
from harness.progress import Progress, silent


class Verdict(StrEnum):
    """Verdicts; names as in diagnosis.json."""

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
    """An identified effect: its parameters by name, and the effects that are indistinguishable from it.

    `by_recording` has the value in each recording of an effect that differs between them; else it is empty.
    `implausible` names the parameters whose value is outside the usual range: the effect may stand for something else.
    `together` has the sets of effects that are indistinguishable from it only together; `indistinguishable_from` has
    their names, too.
    """

    name: str
    parameters: Mapping[str, Estimate]
    indistinguishable_from: tuple[str, ...]
    by_recording: Mapping[str, Estimate] = field(default_factory=dict)
    implausible: tuple[str, ...] = ()
    together: tuple[tuple[str, ...], ...] = ()

    @property
    def rivals(self) -> tuple[tuple[str, ...], ...]:
        """What is indistinguishable from it: single effects, then sets of them."""
        return rival_sets(self.indistinguishable_from, self.together)


@dataclass(frozen=True)
class Identification:
    """Result of the identification, before validation.

    Attributes:
        problem: the problem that was identified, with what the search estimated of it.
        verdict: the answer.
        effects: identified effects beside the known ones.
        base, found: fits without and with the selected terms.
        ledger: every decision.
        unseen: effects whose typical size is below the detection limit of these recordings, or that could not be tried.
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
        return Selection(self.problem, self.base, self.found, self.ledger)

    @property
    def depends_on(self) -> tuple[Regressor, ...]:
        """Regressors of the unlisted effect, strongest first; empty without a spline term.

        First those of the selected spline term, then those of any other whose BIC is within `spline_keep` of the best.
        A friction term also depends on the velocity, by its sign.
        """
        best = self.found.hypothesis.spline
        if best is None:
            return ()
        criterion = Criterion(self.problem.settings)
        fits = [line.fit for line in self.ledger if line.rule is Rule.SPLINE]
        lowest = min((criterion.value(fit) for fit in fits), default=criterion.value(self.found))
        rivals = [fit for fit in fits if criterion.value(fit) - lowest <= self.problem.settings.spline_keep]
        splines = [best, *(fit.hypothesis.spline for fit in sorted(rivals, key=criterion.value))]
        return tuple(dict.fromkeys(regressor for spline in splines if spline for regressor in _regressors(spline)))


def identify(
    problem: Problem, progress: Progress = silent, failures: Failures | None = None, *, jobs: int = 1
) -> Identification:
    """Select the missing terms and give the verdict, as `harness diagnose` reports and blind trials calibrate it.

    Args:
        failures, jobs: as of `search`.
    """
    return judge(search(problem, progress, failures, jobs=jobs), failures)


def judge(selection: Selection, failures: Failures | None = None) -> Identification:
    """The verdict on a selection, with the intervals of the parameters."""
    problem, plain = selection.problem, selection.found
    criterion = Criterion(problem.settings)
    found = attempt(
        failures, Part.SEARCH, "covariance of the intervals", lambda: with_interval_covariance(problem, plain), plain
    )
    unseen = _unseen(problem, found, selection.ledger, criterion)
    if failures is not None and failures.all:
        tried = {name for line in selection.ledger for name in line.effects}
        unseen += tuple(name for name in candidates(problem) if name not in tried)
    names = selected_effects(problem, found)
    if found.hypothesis.spline is not None:
        verdict = Verdict.UNLISTED
    elif names:
        verdict = Verdict.EFFECT
    elif criterion.far_above_noise_floor(problem, found) or len(unseen) > problem.settings.unseen_share * len(
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
    (acting,) = (term for term in found.terms.effects if term.effect.name == name)
    parameters = {}
    for parameter in acting.effect.parameters:
        value = acting.values[parameter.name]
        half = TWO_SIDED * float(deviations[name, parameter.name])
        parameters[parameter.name] = Estimate(value, value - half, value + half, parameter.unit)
    sets = _rivals(name, found, ledger, Criterion(problem.settings))
    sets |= {frozenset({same}) for same in _same(problem, name, found)}
    alone = {one for rivals in sets if len(rivals) == 1 for one in rivals}
    together = sorted(tuple(sorted(rivals)) for rivals in sets if len(rivals) > 1 and not rivals & alone)
    implausible = tuple(
        one.name for one in acting.effect.parameters if not one.plausible(acting.values[one.name], problem.rig)
    )
    each = _by_recording(acting.effect, found)
    named = tuple(sorted(alone.union(*together)))
    return IdentifiedEffect(name, parameters, named, each, implausible, tuple(together))


def _by_recording(effect: Effect, found: Fit) -> dict[str, Estimate]:
    """The value of an effect in each recording, if they differ."""
    if effect.by_recording is None:
        return {}
    unit, halves = effect.by_recording.unit, found.own_deviations(effect.name)
    values = zip(found.terms.recordings, map(float, found.terms.own[effect.name]), strict=True)
    return {
        name: Estimate(value, value - TWO_SIDED * halves[name], value + TWO_SIDED * halves[name], unit)
        for name, value in values
    }


def _rivals(name: str, found: Fit, ledger: Sequence[Line], criterion: Criterion) -> set[frozenset[str]]:
    """Sets of effects indistinguishable from `name`: tried in its place, or replaced by it in a split or merge."""
    names = frozenset(found.hypothesis.names)
    rivals: set[frozenset[str]] = set()
    for line in ledger:
        if set(line.beside) == names - {name} and name not in line.effects and criterion.rivals(line.fit, found):
            rivals.add(frozenset(line.effects) - names)
        replaced = line.kept and line.rule in (Rule.SPLIT, Rule.MERGE) and name in line.effects
        if replaced and criterion.rivals(line.against, found):
            rivals.add(frozenset(line.against.hypothesis.names) - names)
    return rivals - {frozenset()}


def _same(problem: Problem, name: str, found: Fit) -> set[str]:
    """Effects that say exactly what `name` does beside the others, unknown quantities of the rig included."""
    names = set(found.hypothesis.names)
    return same_laws(name, names).intersection(candidates(problem)) - names


def _unseen(problem: Problem, found: Fit, ledger: Sequence[Line], criterion: Criterion) -> tuple[str, ...]:
    """Effects that were not found and whose typical size is below the detection limit."""
    latest = {line.title: line for line in ledger if line.fit.hypothesis.spline is None and not line.kept}
    unseen = []
    for name, line in latest.items():
        if name in found.hypothesis.names:  # tried in vain at first, found later beside others
            continue
        effect = next((term.effect for term in line.fit.terms.effects if term.effect.name == name), None)
        if effect is None:
            continue
        main = effect.parameters[0]
        error = line.fit.deviations()[name, main.name]
        limit = criterion.detection_limit(line.fit.readings, len(effect.parameters))
        if not error or main.size(problem.rig) / error < limit:
            unseen.append(name)
    return tuple(unseen)


def _regressors(spline: SplineTerm) -> list[Regressor]:
    return [spline.depends, Regressor.VELOCITY] if spline.friction else [spline.depends]
