"""The criterion and every decision rule of the selection, with the reason for each decision.

Fits are compared by the BIC, D + k log n: deviance D and a penalty of log n for each of k parameters (Schwarz, Annals
of Statistics 6, 1978). Process noise is such a parameter: a complete model does without, and an effect that makes it
unnecessary saves its price. Else the process noise would take up most of a small effect in a short recording.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from analytic.effects import CATALOGUE
from analytic.motion import FloatArray
from harness.identify.estimate.fit import Estimator, Fit
from harness.identify.problem.hypothesis import PHASE
from harness.identify.problem.problem import Problem
from harness.identify.problem.settings import DEFAULT, Settings
from harness.identify.problem.windows import AHEAD
from harness.identify.selection.decision import NONE, Decision, Evidence, Rule
from harness.metrics.bootstrap import Margin, mean_reduction
from harness.numerics import TWO_SIDED

_MAY_BE_NONE = "too little for one whose strength may be none"


@dataclass(frozen=True)
class Criterion:
    """The criterion and the decision rules, with their settings."""

    settings: Settings = field(default=DEFAULT)

    def value(self, fit: Fit) -> float:
        """BIC of a fit, with or without process noise, whichever is lower; process noise counts as a parameter.

        Up to the price of one parameter, which all hypotheses then have in common. Of a fit to free runs it is the log
        of its mean held-out error in m, which each parameter, a spline term and an effect with a value for each
        recording for one, has to reduce by `held_out_share`.
        """
        if fit.estimator is Estimator.FREE_RUNS:
            numbers = _numbers(fit) + (fit.hypothesis.spline is not None)
            return math.log(np.mean(fit.held_out)) + self.settings.held_out_share * numbers
        price = math.log(fit.readings)
        return min(fit.deviance, fit.quiet_deviance - price) + price * len(fit.theta)

    def gain(self, tried: Fit, against: Fit) -> float:
        """Decrease of the criterion from `against` to `tried`."""
        return self.value(against) - self.value(tried)

    def ranked(self, fits: Iterable[Fit]) -> list[Fit]:
        """The fits of a round, lowest criterion first; before it, of those indistinguishable from it, the simplest.

        A law of two numbers that fits hardly better than one of a single number is not what the readings tell.
        """
        ranked = sorted(fits, key=self.value)
        near = [fit for fit in ranked if self.value(fit) < self.value(ranked[0]) + self.settings.rival]
        simplest = min(near, key=lambda fit: len(fit.theta), default=None)
        return [] if simplest is None else [simplest, *(fit for fit in ranked if fit is not simplest)]

    def needs_evidence(
        self, rule: Literal[Rule.SPLINE, Rule.SPLIT, Rule.EXCHANGE], tried: Fit, against: Fit, tests: int = 1
    ) -> bool:
        """Whether the decision depends on evidence beside the two fits: the gain is above the first threshold.

        Of an exchange, unless it is large and sure, or to something with fewer or more parameters.

        Args:
            tests: how many exchanges this one is the best of.
        """
        if rule is Rule.EXCHANGE:
            other = _numbers(tried) != _numbers(against)
            settled = other or self._surely_exchanged(tried, against, tests)
            return self.gain(tried, against) > 0.0 and not settled
        threshold = self.settings.spline_keep if rule is Rule.SPLINE else self.settings.pair_penalty
        return self.gain(tried, against) > threshold

    def decide(self, rule: Rule, tried: Fit, against: Fit, evidence: Evidence = NONE) -> Decision:
        """Decide whether `tried` is kept in preference to `against`, the fit that it extends or would replace."""
        gain = self.gain(tried, against) if rule is not Rule.RESTORE else _log_ratio(evidence)
        rules: Mapping[Rule, Callable[[Fit, Fit, float, Evidence], tuple[bool, str]]] = {
            Rule.ADD: self._add,
            Rule.DROP: self._drop,
            Rule.SWAP: self._swap,
            Rule.SPLIT: self._split,
            Rule.MERGE: self._merge,
            Rule.RESTART: self._add,
            Rule.PREFER: self._add,
            Rule.SPLINE: self._spline,
            Rule.REFINE: self._add,
            Rule.ABSORB: self._absorb,
            Rule.EXPLAIN: self._explain,
            Rule.CORRELATED: self._correlated,
            Rule.JOINT: self._joint,
            Rule.VALIDATE: self._validate,
            Rule.EXTEND: self._extend,
            Rule.EXCHANGE: self._exchange,
            Rule.PRUNE: self._prune,
            Rule.RESTORE: self._restore,
        }
        kept, because = rules[rule](tried, against, gain, evidence)
        return Decision(bool(kept), float(gain), because)

    def _add(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best fit of its round is kept if it lowers the criterion by more than `keep`."""
        best = evidence.winner is None or evidence.winner is tried
        kept = best and gain > self.settings.keep
        return kept, self._because(tried, gain, kept, evidence)

    def _drop(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """An effect found earlier is kept if it still lowers the criterion by `keep`."""
        kept = not gain < self.settings.keep
        return (
            kept,
            f"{_lowers(gain)} beside the others" if kept else "is no longer needed beside the others",
        )

    def _swap(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best candidate replaces an effect if the criterion is lower, by `rival` if it has more parameters.

        A law that fits hardly better does not justify them.
        """
        assert evidence.holder is not None
        more = self.settings.rival if len(tried.theta) > len(evidence.holder.theta) else 0.0
        kept = evidence.winner is tried and self.value(tried) < self.value(evidence.holder) - more
        if evidence.winner is tried and not kept and gain > 0.0:
            behind = self.value(tried) - self.value(evidence.holder)
            if behind < 0.0:
                return kept, f"{_lowers(gain)}, only {-behind:.1f} more than the simpler effect that it would replace"
            return kept, f"{_lowers(gain)}, {behind:.1f} less than the effect that it would replace"
        return kept, self._because(tried, gain, kept, evidence)

    def _split(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """Two effects replace one if they lower the criterion by `pair_penalty`, and each of them by `keep`."""
        better = self.needs_evidence(Rule.SPLIT, tried, against)
        kept = better and all(self.gain(tried, single) > self.settings.keep for single in evidence.without)
        if better and not kept:
            return kept, "the pair fits better, but one of its effects is not needed"
        return kept, f"the pair fits {'better' if kept else 'no better'} than the one effect"

    def _merge(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """One effect replaces two unless these lower the criterion by `pair_penalty`."""
        kept = gain > -self.settings.pair_penalty
        how = "better than" if gain > self.settings.pair_penalty else "as well as" if kept else "worse than"
        return kept, f"the one effect fits {how} the pair"

    def _spline(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best spline term is kept if it lowers the BIC by `spline_keep` and at least half of the recordings are
        predicted better by the fit to the others: a dozen parameters can fit what happened only once."""
        significant = evidence.winner is tried and self.needs_evidence(Rule.SPLINE, tried, against)
        wins = sum(after < before for before, after in zip(evidence.before, evidence.after, strict=True))
        reproducible = 2 * wins >= len(evidence.before)
        text = f"lowers the BIC by {gain:.0f}"
        if evidence.winner is not tried and gain > self.settings.spline_keep:
            return False, f"{text}, less than another"
        if significant and not reproducible:
            text += ", but fitted to some of the recordings it does not predict the others"
        return significant and reproducible, text if significant else f"{text}, too little"

    def _absorb(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """An effect beside a spline term is kept if it lowers the BIC by `keep`, and is not nested in the spline term
        while this pays without it."""
        assert evidence.holder is not None
        contained = evidence.nested and self.gain(against, evidence.holder) > self.settings.spline_keep
        if contained:
            return False, "is contained in the spline term"
        kept = not gain < self.settings.keep
        return kept, f"{'is' if kept else 'is not'} needed beside the spline term"

    def _explain(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """Effects are kept if they take away a good part of the density of the process noise.

        Where it is far above its floor, the likelihood is of readings with errors that are neither white nor Gaussian,
        and effects that explain nothing can gain a hundred in it.
        """
        share = 1.0 - tried.process_noise / against.process_noise
        much = self.explains(tried, against)
        return much, f"{_lowers(gain)}, with {max(share, 0.0):.0%} less process noise{'' if much else ', too little'}"

    def _correlated(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """An effect is kept if its gain in deviance, divided by the weight of its score, is worth its price."""
        price = math.log(tried.readings) * (len(tried.theta) - len(against.theta))
        kept = (gain + price) / evidence.weight - price > self.settings.keep
        text = f"{_lowers(gain)}; its score is correlated, with {evidence.weight:.1f} times the variance supposed"
        return kept, text if kept else f"{text}, too little"

    def explains(self, tried: Fit, against: Fit) -> bool:
        """Whether `tried` takes away a good part of the density of the process noise that `against` needs."""
        return tried.process_noise < (1.0 - self.settings.explained_least) * against.process_noise

    def _held_out(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best fit of its round is kept if it surely reduces the held-out error."""
        reduced = self.reduction(tried, against, evidence.tests)
        best = evidence.winner is None or evidence.winner is tried
        text = _held_out_errors(tried, against)
        if gain > 0.0 and not reduced.sure:
            text += ", which is not significant"
        return best and gain > 0.0 and reduced.sure, text

    def _joint(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best of the effects tried together is kept if it surely reduces the held-out error, by a good part."""
        kept, text = self._held_out(tried, against, gain, evidence)
        if kept and gain < self.settings.held_out_least:
            return False, f"{text}, too little"
        return kept, text

    def _extend(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best candidate is kept if it surely reduces the held-out error, and is worth its strength."""
        kept, text = self._held_out(tried, against, gain, evidence)
        weak = gain > 0.0 and not self.worth_its_strength(tried, against)
        return kept and not weak, f"{text}, {_MAY_BE_NONE}" if weak else text

    def _validate(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """What was selected is kept unless held-out blocks are predicted worse with it."""
        return bool(np.mean(tried.held_out) <= np.mean(against.held_out)), _held_out_errors(tried, against)

    def _exchange(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best candidate replaces an effect if it surely reduces the held-out error, by more than a rival.

        A reduction that is less than that is enough if the in-sample loss is lower too, by as much as a rival's: each
        of the two scatters. A further parameter lowers that loss whatever is true, and has to pay in the held-out error
        as where one is added. Something with fewer parameters, whose loss may be higher, only has to predict no worse
        than they are worth, as where one is pruned.
        """
        if _simpler(tried, against):
            return evidence.winner is tried and gain > 0.0, f"{_held_out_errors(tried, against)}, with fewer parameters"
        kept, text = self._held_out(tried, against, gain, evidence)
        kept = kept and self._surely_exchanged(tried, against, evidence.tests)
        beside = self.needs_evidence(Rule.EXCHANGE, tried, against, evidence.tests)
        if evidence.winner is tried and evidence.after and beside:
            share = 1.0 - evidence.after[0] / evidence.before[0]
            kept = share > self.settings.held_out_rival
            text += f"; its in-sample loss is {abs(share):.1%} {'lower' if share > 0.0 else 'higher'}"
            text += "" if kept or share <= 0.0 else ", too little"
        return kept, text

    def _surely_exchanged(self, tried: Fit, against: Fit, tests: int) -> bool:
        """Whether the held-out error is surely lower, though the best of so many is, and by more than a rival's."""
        return self.gain(tried, against) > self.settings.held_out_rival and self.reduction(tried, against, tests).sure

    def _prune(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """An effect is kept if it reduces the held-out error by more than what its parameters have to."""
        text, kept = _held_out_errors(tried, against), gain > 0.0 and self.worth_its_strength(tried, against)
        return kept, text if kept or gain <= 0.0 else f"{text}, {_MAY_BE_NONE}"

    def _restore(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """A spline term by likelihood is returned to if, so fitted, it surely predicts held-out blocks better."""
        before, after = np.array(evidence.before), np.array(evidence.after)
        sure = mean_reduction(before, after, self.settings.chance).sure
        text = f"fitted by likelihood, {_predicts(after, before)}"
        return sure, text if sure or gain <= 0.0 else f"{text}, which is not significant"

    def worth_its_strength(self, tried: Fit, against: Fit) -> bool:
        """Whether what `tried` has beside `against` is surely of some strength, or reduces the held-out error much.

        By as good a part as effects tried together: chance reduces the errors of few blocks by less.
        """
        return _surely_strong(tried, against) or self.gain(tried, against) > self.settings.held_out_least

    def reduction(self, tried: Fit, against: Fit, tests: int = 1) -> Margin:
        """Reduction of the mean held-out error [m], with its interval at the significance level divided by `tests`."""
        before, after = np.array(against.held_out), np.array(tried.held_out)
        return mean_reduction(before, after, self.settings.chance / tests)

    def _because(self, tried: Fit, gain: float, kept: bool, evidence: Evidence) -> str:
        lowers = _lowers(gain)
        if kept:
            return lowers
        short = " (fit not continued)" if tried.abandoned else ""
        if not gain > 0.0:
            return f"does not lower the BIC{short}"
        if evidence.winner is None or evidence.winner is tried:
            return f"{lowers}, too little{short}"
        behind = self.value(tried) - self.value(evidence.winner)
        other = evidence.winner.hypothesis.names[-1]
        if behind < 0.0:
            return f"{lowers}, only {-behind:.0f} more than {other}, which has fewer parameters"
        return f"{lowers}, {behind:.0f} less than {other}{short}"

    def predicts_poorly(self, problem: Problem, errors: Sequence[float]) -> bool:
        """Whether the errors of windows, shape (windows,) [m], are above those that a complete model would make."""
        return len(errors) > 0 and float(np.median(errors)) > self.settings.poor_errors * _complete_error(problem)

    def at_noise_floor(self, problem: Problem, fit: Fit) -> bool:
        """Whether √q is within a small factor of the input-noise floor: nothing is left to explain."""
        return fit.root_process_noise < self.settings.at_floor_ratio * problem.angle_floor

    def below_noise_floor(self, problem: Problem, fit: Fit) -> bool:
        """Whether the fit needs less process noise than the input-noise floor."""
        return fit.root_process_noise < problem.angle_floor

    def far_above_noise_floor(self, problem: Problem, fit: Fit) -> bool:
        """Whether √q is an order of magnitude above the input-noise floor: missing physics is certain.

        The density of a fit to free runs is the one that predicts best; such a fit is made only where this is certain.
        """
        return (
            fit.estimator is Estimator.FREE_RUNS
            or fit.root_process_noise > self.settings.above_floor_ratio * problem.angle_floor
        )

    def rivals(self, fit: Fit, found: Fit) -> bool:
        """Whether `fit` is indistinguishable from `found`.

        Never if only one of them has a spline term or is a fit to free runs. One of much the same law need not pay for
        more parameters: a servo that fits as a lag does is not the rarer cause.
        """
        comparable = (fit.hypothesis.spline is None) == (found.hypothesis.spline is None)
        comparable = comparable and fit.estimator is found.estimator
        if found.estimator is Estimator.FREE_RUNS:
            return comparable and self.value(fit) < self.value(found) + self.settings.held_out_rival
        unpaid = max(_price(fit, found), 0.0) if _alike(fit, found) else 0.0
        return comparable and self.value(fit) - unpaid < self.value(found) + self.settings.rival

    def rival_separation(self, fit: Fit, found: Fit) -> float:
        """Separation √ΔD from which `fit` is distinguishable from `found` [σ].

        Parameters of fits to free runs were not paid for in the deviance.
        """
        price = _price(fit, found) if found.estimator is Estimator.LIKELIHOOD else 0.0
        return math.sqrt(max(self.settings.rival - (min(price, 0.0) if _alike(fit, found) else price), 0.0))

    def detection_limit(self, readings: int, parameters: int) -> float:
        """Size over standard error from which an effect of so many parameters is kept [σ]."""
        return math.sqrt(self.settings.keep + math.log(readings) * parameters)


def _complete_error(problem: Problem) -> float:
    """RMS error of windows predicted by a model that lacks nothing: readings, and the angle's error as white noise [m].

    White noise of density q on ṡ gives the position a variance of q t³/3 after t. Before, it leaves the velocity one
    of √2 q^¾ R^¼, with a reading variance times interval R (steady Kalman filter); coloured noise of variance c² and
    correlation time τ counts as white noise of its density at low frequencies, 2 c² τ.
    """
    interval = float(np.mean([np.median(np.diff(one.time)) for one in problem.recordings]))
    density = problem.angle_floor**2
    share = problem.colour.share
    reading = problem.reading_variance * ((1.0 - share) * interval + share * max(2.0 * problem.colour.time, interval))
    velocity = math.sqrt(2.0) * density**0.75 * reading**0.25
    return math.sqrt(problem.reading_variance + velocity * AHEAD**2 / 3.0 + density * AHEAD**3 / 12.0)


def _surely_strong(tried: Fit, against: Fit) -> bool:
    """Whether the 95 % interval of a strength of what `tried` has beside `against` leaves out 0, if it has any."""
    added = set(tried.hypothesis.names) - set(against.hypothesis.names)
    strengths = [(name, one) for name in added for one in CATALOGUE[name].strengths]
    values, deviations = tried.values(), tried.deviations()
    told = [abs(values[key]) > TWO_SIDED * deviations[key] for key in strengths if key in values]
    return any(told) or not told


def _price(fit: Fit, found: Fit) -> float:
    """What `fit` pays in BIC for having more parameters than `found`."""
    return math.log(found.readings) * (len(fit.theta) - len(found.theta))


def _alike(fit: Fit, found: Fit) -> bool:
    """Whether the two differ in nothing but what makes the ball late, or in a law that is one beside the others."""
    ours, theirs = set(found.hypothesis.names), set(fit.hypothesis.names)
    mine, its = ours - theirs, theirs - ours
    if mine and its and all(CATALOGUE[name].relations.late for name in mine | its):
        return True
    return len(mine) == len(its) == 1 and its <= same_laws(min(mine), ours)


def same_laws(name: str, beside: set[str]) -> set[str]:
    """Effects that say exactly what `name` does where these are fitted beside it."""
    return {one for one, needed in CATALOGUE[name].relations.same_beside.items() if beside.intersection(needed)}


def _simpler(tried: Fit, against: Fit) -> bool:
    return _numbers(tried) < _numbers(against)


def _numbers(fit: Fit) -> int:
    """Parameters of the effects, with which held-out errors are weighed.

    Of an effect with a value for each recording they tell one: the spread, as the values of a held-out recording are
    fitted to its known part.
    """
    each = [name for name in fit.hypothesis.own if name != PHASE]
    return len(fit.hypothesis.parameters) + len(each)


def _log_ratio(evidence: Evidence) -> float:
    """Decrease of the log of the mean held-out error."""
    return math.log(np.mean(evidence.before) / np.mean(evidence.after))


def _held_out_errors(tried: Fit, against: Fit) -> str:
    return _predicts(tried.held_out, against.held_out)


def _predicts(after: Sequence[float] | FloatArray, before: Sequence[float] | FloatArray) -> str:
    mean, instead = (1e3 * float(np.mean(errors)) for errors in (after, before))
    return f"predicts held-out blocks with a mean error of {mean:.3g} mm instead of {instead:.3g} mm"


def _lowers(gain: float) -> str:
    return f"lowers the BIC by {gain:.1f}"
