"""The ledger: every decision of the search in order, with its evidence."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from harness.failures import Failures, Part, attempt
from harness.identify.estimate.fit import Fit
from harness.identify.selection.criterion import Criterion
from harness.identify.selection.decision import NONE, Decision, Evidence, Rule

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Line:
    """One decision of the search.

    Attributes:
        rule: the decision rule.
        effects: names of the effects tried; empty for a spline term.
        fit, against: the two fits compared, with the terms tried and without them or with their alternative.
        evidence: further evidence.
        decision: the result.
    """

    rule: Rule
    effects: tuple[str, ...]
    fit: Fit
    against: Fit
    evidence: Evidence
    decision: Decision

    @property
    def title(self) -> str:
        """Name of the terms tried."""
        if self.effects:
            return " + ".join(self.effects)
        spline = self.fit.hypothesis.spline
        return "nothing" if spline is None else spline.name

    @property
    def beside(self) -> tuple[str, ...]:
        """The effects that both fits have, without those tried."""
        return tuple(
            name
            for name in self.fit.hypothesis.names
            if name in self.against.hypothesis.names and name not in self.effects
        )

    @property
    def kept(self) -> bool:
        """Whether the terms tried were kept."""
        return self.decision.kept

    @property
    def gain(self) -> float:
        """Decrease of the criterion."""
        return self.decision.gain

    @property
    def because(self) -> str:
        """The reason."""
        return self.decision.because


class Ledger:
    """Decides by the criterion and records every decision; `failures` collects what could not be tried."""

    def __init__(self, criterion: Criterion, failures: Failures | None = None) -> None:
        self.criterion, self.failures = criterion, failures
        self.lines: list[Line] = []

    def attempt(self, step: str, job: Callable[[], T], otherwise: T) -> T:
        """The result of a step of the search; `otherwise` if it raises and there is a collector of failures."""
        return attempt(self.failures, Part.SEARCH, step, job, otherwise)

    def decide(
        self, rule: Rule, fit: Fit, against: Fit, effects: Sequence[str] = (), evidence: Evidence = NONE
    ) -> bool:
        """Decide and record whether `fit` is kept in preference to `against`.

        Args:
            effects: names of the effects tried; empty for a spline term.
        """
        decision = self.criterion.decide(rule, fit, against, evidence)
        self.lines.append(Line(rule, tuple(effects), fit, against, evidence, decision))
        return decision.kept

    def decide_round(self, rule: Rule, tried: Sequence[Fit], against: Fit, *, holder: Fit | None = None) -> Fit | None:
        """Decide on fits that each add their last effect to `against`, best first; return the one kept, if any."""
        evidence = Evidence(winner=tried[0] if tried else None, holder=holder)
        kept = [fit for fit in tried if self.decide(rule, fit, against, fit.hypothesis.names[-1:], evidence)]
        return kept[0] if kept else None
