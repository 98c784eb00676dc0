"""The one place that decides what is kept, dropped, swapped, split or preferred, and says why.

Fits are compared by the quasi-BIC, D/ĉ + k ln n: deviance D over the overdispersion ĉ, as in the QAIC (Lebreton et al.,
Ecological Monographs 62, 1992), and a price of ln n for each of k parameters (Schwarz, Annals of Statistics 6, 1978).
Where one of the two has a spline term, ĉ = 1: its parameters are many, and its own threshold is the higher one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from harness.identify.estimate.fit import Fit
from harness.identify.problem.problem import Problem
from harness.identify.problem.settings import DEFAULT, Settings
from harness.metrics.bootstrap import Margin, rms_reduction
from harness.numerics import rms


class Rule(StrEnum):
    """What a decision is about; names as in diagnosis.json."""

    ADD = "add"  # a candidate beside what was found
    DROP = "drop"  # an effect found before, beside those found since
    SWAP = "swap"  # a candidate in the place of an effect
    SPLIT = "split"  # two effects in the place of the one that imitates them
    MERGE = "merge"  # one effect in the place of the two that imitate it
    RESTART = "restart"  # the search begins again with a runner-up
    PREFER = "prefer"  # where that led, against where the search had led before
    SPLINE = "spline"  # a spline term beside what was found
    REFINE = "refine"  # twice the nodes of a spline term
    ABSORB = "absorb"  # an effect beside the spline term that may contain it
    VALIDATE = "validate"  # what was found, on held-out windows
    EXTEND = "extend"  # a candidate, on held-out windows


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a decision rests on beside the two fits that it compares.

    Attributes:
        winner: the best fit of its round (ADD, SWAP, SPLINE), or the one whose gain is largest and sure (EXTEND).
        holder: the fit whose place is taken (SWAP), or the one without the spline term (ABSORB).
        without: fits that lack one of the two effects each (SPLIT).
        before, after: held-out figures without and with what is tried: deviance of each recording (SPLINE), RMS error
            of each window [m] (VALIDATE, EXTEND).
        tests: candidates that share the chance of a false positive (EXTEND).
        nested: whether the spline term contains the effect (ABSORB).
    """

    winner: Fit | None = None
    holder: Fit | None = None
    without: tuple[Fit, ...] = ()
    before: tuple[float, ...] = ()
    after: tuple[float, ...] = ()
    tests: int = 1
    nested: bool = False


NONE = Evidence()


@dataclass(frozen=True)
class Decision:
    """Whether something is kept, by how much it lowers the criterion, and why."""

    kept: bool
    gain: float
    because: str


@dataclass(frozen=True)
class Criterion:
    """Every rule of decision, with the settings that it goes by."""

    settings: Settings = field(default=DEFAULT)

    def value(self, one: Fit) -> float:
        """Quasi-BIC of a fit; with a spline term its BIC."""
        return self._value(one, spline=one.hypothesis.spline is not None)

    def gain(self, tried: Fit, against: Fit) -> float:
        """By how much `tried` lowers the criterion; both by BIC where either has a spline term."""
        spline = tried.hypothesis.spline is not None or against.hypothesis.spline is not None
        return self._value(against, spline=spline) - self._value(tried, spline=spline)

    def _value(self, one: Fit, *, spline: bool) -> float:
        overdispersion = 1.0 if spline else self.settings.overdispersion
        return one.deviance / overdispersion + math.log(one.readings) * len(one.theta)

    def decide(self, rule: Rule, tried: Fit, against: Fit, evidence: Evidence = NONE) -> Decision:
        """Decide whether `tried` is kept over `against`.

        Args:
            against: the fit without what is tried, or the one whose result it would replace.
        """
        gain = self.gain(tried, against)
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
            Rule.VALIDATE: self._validate,
            Rule.EXTEND: self._extend,
        }
        kept, because = rules[rule](tried, against, gain, evidence)
        return Decision(bool(kept), float(gain), because)

    def _add(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best of its round is kept if it lowers the criterion by more than `keep`."""
        first = evidence.winner is None or evidence.winner is tried
        kept = first and gain > self.settings.keep
        return kept, self._because(tried, gain, kept, evidence)

    def _drop(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """An effect found before stays as long as it lowers the criterion by `keep`."""
        kept = not gain < self.settings.keep
        return kept, "still pays beside the others" if kept else "no longer pays beside the others"

    def _swap(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best candidate takes the place of an effect if the criterion is lower with it."""
        assert evidence.holder is not None
        kept = evidence.winner is tried and self.value(tried) < self.value(evidence.holder)
        if evidence.winner is tried and not kept and gain > 0.0:
            behind = self.value(tried) - self.value(evidence.holder)
            return kept, f"{_lowers(gain)}, {behind:.1f} less than the effect in whose place it was tried"
        return kept, self._because(tried, gain, kept, evidence)

    def _split(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """Two effects have to explain more than the one, and each of them has to pay."""
        more = gain > self.settings.pair_penalty
        kept = more and all(self.gain(tried, one) > self.settings.keep for one in evidence.without)
        if more and not kept:
            return kept, "the two explain more, but one of them does not pay"
        return kept, f"the two explain {'more' if kept else 'no more'} than the one"

    def _merge(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """One effect takes the place of two that explain no more."""
        kept = gain > -self.settings.pair_penalty
        how = "more than" if gain > self.settings.pair_penalty else "as much as" if kept else "less than"
        return kept, f"the one explains {how} the two"

    def _spline(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """The best spline term is kept if it pays and, fitted without a recording, predicts at least half of them.

        A dozen parameters can follow what happened once; a law acts again.
        """
        pays = evidence.winner is tried and gain > self.settings.spline_keep
        wins = sum(after < before for before, after in zip(evidence.before, evidence.after, strict=True))
        recurs = 2 * wins >= len(evidence.before)
        text = f"lowers the BIC by {gain:.0f}"
        if pays and not recurs:
            text += ", but fitted to some of the recordings it does not predict the others"
        return pays and recurs, text if pays else f"{text}, too little"

    def _absorb(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """An effect beside a spline term has to pay, and not to be what the catalogue took of the same cause."""
        assert evidence.holder is not None
        contained = evidence.nested and self.gain(against, evidence.holder) > self.settings.spline_keep
        if contained:
            return False, "is contained in the spline term"
        kept = not gain < self.settings.keep
        return kept, f"{'pays' if kept else 'does not pay'} beside the spline term"

    def _validate(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """What was found is kept if the windows of recordings that it was not fitted to are predicted better."""
        before, after = (rms(each) for each in (evidence.before, evidence.after))
        kept = after < before
        return kept, f"predicts held-out windows {'better' if kept else 'worse'}: {after:.3g} m for {before:.3g} m RMS"

    def _extend(self, tried: Fit, against: Fit, gain: float, evidence: Evidence) -> tuple[bool, str]:
        """A candidate is kept if it predicts held-out windows better beyond chance, and best of its round."""
        before, after = (rms(each) for each in (evidence.before, evidence.after))
        sure = self.reduction(evidence).sure
        text = f"predicts held-out windows by {after:.3g} m RMS instead of {before:.3g} m"
        if not sure:
            text += ", which may be chance"
        return sure and evidence.winner is tried, text

    def reduction(self, evidence: Evidence) -> Margin:
        """Reduction of the held-out error [m], at the chance that all tests share."""
        before, after = np.array(evidence.before), np.array(evidence.after)
        return rms_reduction(before, after, self.settings.chance / evidence.tests)

    def _because(self, tried: Fit, gain: float, kept: bool, evidence: Evidence) -> str:
        if kept:
            return _lowers(gain)
        if not gain > 0.0:
            return "does not pay for its parameters"
        if evidence.winner is None or evidence.winner is tried:
            return f"{_lowers(gain)}, which may be chance"
        behind = self.value(tried) - self.value(evidence.winner)
        return f"{_lowers(gain)}, {behind:.0f} less than {evidence.winner.hypothesis.names[-1]}"

    def explained(self, problem: Problem, one: Fit) -> bool:
        """Whether the process noise is within a small factor of the input-noise floor: nothing is left to explain."""
        return one.root_process_noise < self.settings.explained_ratio * problem.angle_floor

    def unexplained(self, problem: Problem, one: Fit) -> bool:
        """Whether the process noise is an order of magnitude above the input-noise floor: something certainly acts."""
        return one.root_process_noise > self.settings.unexplained_ratio * problem.angle_floor

    def rivals(self, one: Fit, found: Fit) -> bool:
        """Whether `one` explains nearly as much as `found`, so that the data do not tell them apart."""
        alike = (one.hypothesis.spline is None) == (found.hypothesis.spline is None)
        return alike and self.value(one) < self.value(found) + self.settings.rival

    def rival_separation(self, one: Fit, found: Fit) -> float:
        """Standard deviations from which on `one` is told from `found`, by the deviance alone."""
        price = math.log(found.readings) * (len(one.theta) - len(found.theta))
        return math.sqrt(max(self.settings.rival - price, 0.0))

    def detection_limit(self, readings: int, parameters: int) -> float:
        """Standard deviations from which on an effect of so many parameters is kept."""
        return math.sqrt(self.settings.keep + math.log(readings) * parameters)


def _lowers(gain: float) -> str:
    return f"lowers the quasi-BIC by {gain:.1f}"
