"""Search by held-out errors, for recordings that effects and spline terms selected by likelihood predict poorly.

The likelihood weighs one-step predictions. If the process noise stays above the input-noise floor, something else than
the errors of the angle is in them: unmodelled forces, or sensors whose errors have a colour of their own. The
likelihood then may keep what makes predictions over seconds worse and miss what improves them. Predictions of blocks
that were held out decide instead. Effects that are common on measured rigs and often pay only together are searched
together, every subset of them; further ones one at a time.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from analytic.effects import CATALOGUE
from harness.failures import Part, attempt
from harness.identify.estimate.block_errors import block_errors
from harness.identify.estimate.cross_validation import cross_validated
from harness.identify.estimate.fit import Fit
from harness.identify.estimate.free_run_fit import Effort, FreeRunFit, fit_free_runs, in_sample_losses
from harness.identify.estimate.window_errors import tuned_to_windows, window_errors
from harness.identify.problem.hypothesis import Hypothesis
from harness.identify.problem.problem import Problem
from harness.identify.problem.windows import Window, blocks_of, fitted_windows, windows_of
from harness.identify.selection.candidates import candidates, common_effects, fitted_each, selected_effects
from harness.identify.selection.decision import Evidence, Rule
from harness.identify.selection.ledger import Ledger
from harness.parallel import can_fork
from harness.progress import Progress

_S = TypeVar("_S")
_T = TypeVar("_T")

_OF_A_SIZE = 2  # sets of common effects that are cross-validated: a set is rarely best that fits worse than two others
_VANISHED = 1e-3  # of its typical size: a strength below which an effect is not there


def search_by_held_out_errors(
    problem: Problem, base: Fit, found: Fit, ledger: Ledger, progress: Progress, *, jobs: int = 1
) -> tuple[Fit, Fit]:
    """Fits without and with the terms that predict held-out blocks best.

    Those given are returned if nothing is surely better, if the terms of `found` are best and its parameters predict as
    well, or if its spline term, fitted by likelihood, surely does better; and the base for both if it predicts better.
    Without any terms, where physics is missing for certain, that is the base by free runs if it predicts better than by
    likelihood.

    Args:
        base, found: fits by likelihood, without and with the terms that it selects.
        jobs: processes for the fits, which hold Python's global lock most of the time; 1 for threads.
    """
    if len(blocks_of(problem.recordings)) < problem.settings.min_blocks:
        return base, found
    search = _Search(problem, ledger, progress, jobs if can_fork() else 1)
    plain, best = search.jointly(base, found)
    if best is not None and search.restores(found, best):
        return base, found
    if best is plain or (best is None and found.hypothesis == base.hypothesis):
        alone = search.predicting(base, plain)
        return alone, alone
    if best is None or (best.hypothesis == found.refined and _predicts_as_well(problem, found, best)):
        return base, found
    best = search.exchanged(best)  # before each addition: what only stands in for a true cause may ask for another one
    extended: set[frozenset[str]] = set()
    while True:
        best = search.pruned(best)  # before each addition, too: what is idle takes the place of what is not
        effects = frozenset(selected_effects(problem, best))
        # What an addition led to may be pruned to what there was: fits from other values may end elsewhere, and what
        # was added may have been exchanged for something that is not kept.
        ends = len(effects) >= problem.settings.max_effects or effects in extended
        further = None if ends else search.extended(best)
        if further is None:
            return plain, best
        extended.add(effects)
        best = search.exchanged(further)


@dataclass
class _Search:
    """The steps of the search on one problem; losses of fits are compared at the scale of the base."""

    problem: Problem
    ledger: Ledger
    progress: Progress
    jobs: int = 1
    _windows: tuple[Window, ...] = field(init=False)
    _scale: float = field(init=False)

    def __post_init__(self) -> None:
        self._windows = fitted_windows(self.problem.recordings)

    def jointly(self, base: Fit, found: Fit) -> tuple[Fit, Fit | None]:
        """The base, and the best of the subsets of effects that are common on measured rigs and the terms of `found`.

        What explained too little to be selected by likelihood is weighed where `found` has no terms. If nothing is
        surely better than the base, `None`, or the base itself if `found` predicts worse than it.
        """
        problem = self.problem
        first = self._fitted([(base.hypothesis, base)])[0]
        self._scale = first.scale
        plain = cross_validated(problem, first.fit, jobs=self.jobs)
        common = common_effects(problem)
        fits = {frozenset[str](): first}
        for size in range(1, len(common) + 1):
            # From each of the fits with one effect less: where the ball stops there are local minima.
            fitted = self._fitted(
                [
                    (Hypothesis((*problem.unknown, *names)), fits[frozenset(names) - {name}].fit)
                    for names in itertools.combinations(common, size)
                    for name in names
                    if frozenset(names) - {name} in fits
                ]
            )
            for one in fitted:
                subset = frozenset(selected_effects(problem, one.fit))
                fits[subset] = self._better(one, fits.get(subset))
        selected = found.hypothesis != base.hypothesis
        weighed = [found] if selected else self._unexplaining()
        terms = self._validated([one.fit for one in self._fitted([(one.refined, one) for one in weighed])])
        sets = [one for subset, one in fits.items() if subset and not _vanished(problem, one.fit)]
        sets = [one for one in sets if one.fit.hypothesis not in [each.hypothesis for each in weighed]]
        others = self._validated([one.fit for one in self._best_of_each_size(sets)])
        best = self._decided(Rule.JOINT, [*terms, *others], plain, tests=len(terms) + len(sets))
        if best is not None or not (selected and terms):
            return plain, best
        kept = self.ledger.decide(Rule.VALIDATE, terms[0], plain, _added(terms[0], plain))
        return plain, None if kept else plain

    def predicting(self, base: Fit, plain: Fit) -> Fit:
        """Of the fits of the base by likelihood and by free runs the one that predicts better.

        One-step predictions of a model that is certain to lack physics give its parameters little meaning over seconds.
        """
        certain = self.ledger.criterion.far_above_noise_floor(self.problem, base)
        return plain if certain and not _predicts_as_well(self.problem, base, plain) else base

    def _unexplaining(self) -> list[Fit]:
        """What was not selected by likelihood because it explains too little."""
        return [line.fit for line in self.ledger.lines if line.rule is Rule.EXPLAIN and not line.kept]

    def restores(self, found: Fit, best: Fit) -> bool:
        """Whether the spline term of `found` is returned to, whose values free runs over a few windows do not find."""
        if found.hypothesis.spline is None or best.hypothesis == found.refined:
            return False
        self.progress(f"cross-validation by likelihood: {self._title(found.hypothesis)}")
        evidence = Evidence(before=best.held_out, after=tuple(block_errors(self.problem, found).tolist()))
        return self.ledger.decide(Rule.RESTORE, found, best, evidence=evidence)

    def _best_of_each_size(self, sets: Sequence[FreeRunFit]) -> list[FreeRunFit]:
        """Of the sets of as many effects those of lowest loss, up to `_OF_A_SIZE`."""
        by_loss = sorted(sets, key=lambda one: (len(one.fit.hypothesis.names), one.loss(self._scale)))
        sizes = itertools.groupby(by_loss, key=lambda one: len(one.fit.hypothesis.names))
        return [one for _, group in sizes for one in itertools.islice(group, _OF_A_SIZE)]

    def extended(self, best: Fit) -> Fit | None:
        """`best` with the candidate that reduces the held-out error most; `None` if no reduction is sure."""
        names = [name for name in self._candidates() if name not in best.hypothesis.names]
        tried = self._promising(best, [(*best.hypothesis.names, name) for name in names])
        return self._decided(Rule.EXTEND, tried, best, tests=len(names))

    def exchanged(self, best: Fit) -> Fit:
        """`best` with effects replaced by what predicts held-out blocks better; what is as good is a rival.

        Of all exchanges the best one is made, until none is better: whichever effect were looked at first would decide.
        """
        while True:
            others = [name for name in self._candidates() if name not in best.hypothesis.names]
            tried, selected = [], selected_effects(self.problem, best)
            for name in selected:
                swaps = [tuple(other if one == name else one for one in best.hypothesis.names) for other in others]
                tried += self._promising(best, swaps)
            further = self._decided(Rule.EXCHANGE, tried, best, tests=len(selected) * len(others))
            if further is None:
                return best
            best = further

    def pruned(self, best: Fit) -> Fit:
        """`best` without the effects that do not reduce the held-out error beside the others."""
        while len(names := selected_effects(self.problem, best)) > 1:
            rest = [tuple(one for one in best.hypothesis.names if one != name) for name in names]
            fitted = self._fitted([(Hypothesis(each, best.terms.spline), best) for each in rest])
            without = sorted(self._validated([one.fit for one in fitted]), key=self.ledger.criterion.value)
            idle = [one for one in without[:1] if not self.ledger.decide(Rule.PRUNE, best, one, _added(best, one))]
            if not idle:
                break
            best = idle[0]
        return best

    def _candidates(self) -> list[str]:
        """Those with one starting point, so that held-out readings have no say in where their fits begin.

        φ₀ at the start of a recording is unknown too.
        """
        problem = self.problem
        return [
            name
            for name in candidates(problem)
            if not CATALOGUE[name].turning
            and all(len(one.starts_on(problem.visited, problem.rig)) == 1 for one in CATALOGUE[name].parameters)
        ]

    def _promising(self, best: Fit, names: Sequence[tuple[str, ...]]) -> list[Fit]:
        """Of fits with these effects beside the spline term of `best` the few of lowest loss, cross-validated."""
        begun = self._ranked([(Hypothesis(each, best.terms.spline), best) for each in names], effort=Effort.BRIEF)
        promising = [(one.fit.refined, one.fit) for one in begun[: 2 * self.problem.settings.validated_candidates]]
        few = self._ranked(promising, effort=Effort.NEAR)[: self.problem.settings.validated_candidates]
        return self._validated([one.fit for one in few])

    def _validated(self, fits: Sequence[Fit]) -> list[Fit]:
        """The fits with their held-out errors."""

        def validated(fit: Fit) -> Fit:
            return cross_validated(self.problem, fit, jobs=self.jobs)

        # In processes one after the other: there are more folds of each than fits.
        turns = [[fit] for fit in fits] if self.jobs > 1 else [fits]
        return [
            one for turn in turns for one in self._each("cross-validation", validated, turn, lambda fit: fit.hypothesis)
        ]

    def _ranked(self, tried: Sequence[tuple[Hypothesis, Fit]], *, effort: Effort = Effort.FULL) -> list[FreeRunFit]:
        """Fits in which no effect vanishes, lowest loss first."""
        fitted = [one for one in self._fitted(tried, effort=effort) if not _vanished(self.problem, one.fit)]
        return sorted(fitted, key=lambda one: one.loss(self._scale))

    def _fitted(self, tried: Sequence[tuple[Hypothesis, Fit]], *, effort: Effort = Effort.FULL) -> list[FreeRunFit]:
        """Fits to free runs over all windows, each from the values of another fit."""

        def fitted(each: tuple[Hypothesis, Fit]) -> FreeRunFit:
            hypothesis, begin = each
            return fit_free_runs(self.problem, hypothesis, self._windows, initial=begin.values(), effort=effort)

        return self._each("free runs", fitted, tried, lambda one: one[0])

    def _each(
        self, doing: str, function: Callable[[_S], _T], arguments: Sequence[_S], of: Callable[[_S], Hypothesis]
    ) -> list[_T]:
        """The results of all arguments for which there is one.

        Args:
            doing: what is told of each, with the terms of its hypothesis `of`.
        """

        def title(argument: _S) -> str:
            return self._title(of(argument))

        def begins(argument: _S) -> None:
            self.progress(f"{doing}: {title(argument)}")

        done = fitted_each(function, arguments, title, self.ledger.failures, jobs=self.jobs, begins=begins)
        return [result for _, result in done]

    def _title(self, hypothesis: Hypothesis) -> str:
        terms = [name for name in hypothesis.names if name not in self.problem.unknown]
        return " + ".join([*terms, *([hypothesis.spline.name] if hypothesis.spline else [])]) or "no effect"

    def _better(self, one: FreeRunFit, other: FreeRunFit | None) -> FreeRunFit:
        return one if other is None or one.loss(self._scale) < other.loss(self._scale) else other

    def _decided(self, rule: Rule, tried: Sequence[Fit], against: Fit, tests: int = 1) -> Fit | None:
        """Decide on cross-validated fits, best first; the one kept, if any."""
        criterion = self.ledger.criterion
        ranked = sorted(tried, key=criterion.value)
        lasting = [fit for fit in ranked if rule is not Rule.EXTEND or criterion.worth_its_strength(fit, against)]
        winner = next(iter(lasting or ranked), None)
        kept = None
        for fit in ranked:
            evidence = Evidence(winner=winner, tests=tests)
            if rule is Rule.EXCHANGE and fit is winner and criterion.needs_evidence(rule, fit, against, tests):
                evidence = self._with_losses(evidence, fit, against)
            if self.ledger.decide(rule, fit, against, _added(fit, against), evidence):
                kept = fit
        return kept

    def _with_losses(self, evidence: Evidence, fit: Fit, against: Fit) -> Evidence:
        """The evidence of an exchange with the in-sample losses; without them if they cannot be computed."""
        losses = attempt(
            self.ledger.failures,
            Part.CANDIDATE,
            self._title(fit.hypothesis),
            lambda: in_sample_losses(self.problem, self._windows, (against, fit)),
            (),
        )
        return replace(evidence, before=losses[:1], after=losses[1:])


def _predicts_as_well(problem: Problem, found: Fit, best: Fit) -> bool:
    """Whether parameters by likelihood predict windows nearly as well as those by free runs: they are known better."""
    windows = windows_of(problem.recordings)
    by_likelihood = window_errors(problem, tuned_to_windows(problem, found, windows), windows)
    by_free_runs = window_errors(problem, best, windows)
    return float(np.mean(by_likelihood)) < (1.0 + problem.settings.held_out_rival) * float(np.mean(by_free_runs))


def _added(fit: Fit, against: Fit) -> tuple[str, ...]:
    return tuple(name for name in fit.hypothesis.names if name not in against.hypothesis.names)


def _vanished(problem: Problem, fit: Fit) -> bool:
    """Whether one of the effects has no strength."""
    return any(
        abs(one.values[parameter.name]) < _VANISHED * parameter.size(problem.rig)
        for one in fit.terms.effects
        for parameter in one.effect.parameters
        if parameter.name in one.effect.strengths
    )
