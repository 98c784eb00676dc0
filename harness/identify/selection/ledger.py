"""The ledger: every decision of the search in its order, with what it rested on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from harness.identify.estimate.fit import Fit
from harness.identify.selection.criterion import NONE, Criterion, Decision, Evidence, Rule


@dataclass(frozen=True, eq=False)
class Line:
    """One decision.

    Attributes:
        rule: what it was about.
        effects: what was tried, by name; empty for a spline term.
        fit, against: with it and without, or with what it was held against.
        evidence: what else it rested on.
        decision: what was decided.
    """

    rule: Rule
    effects: tuple[str, ...]
    fit: Fit
    against: Fit
    evidence: Evidence
    decision: Decision

    @property
    def title(self) -> str:
        """What was tried, in words."""
        if self.effects:
            return " + ".join(self.effects)
        spline = self.fit.hypothesis.spline
        return "nothing" if spline is None else spline.name

    @property
    def beside(self) -> tuple[str, ...]:
        """The effects that both fits have, but for what was tried."""
        return tuple(
            name
            for name in self.fit.hypothesis.names
            if name in self.against.hypothesis.names and name not in self.effects
        )

    @property
    def kept(self) -> bool:
        """Whether it was kept then."""
        return self.decision.kept

    @property
    def gain(self) -> float:
        """By how much it lowers the criterion."""
        return self.decision.gain

    @property
    def because(self) -> str:
        """Why it was kept or not."""
        return self.decision.because


class Ledger:
    """Decides by the criterion, and keeps every decision."""

    def __init__(self, criterion: Criterion) -> None:
        self.criterion = criterion
        self.lines: list[Line] = []

    def decide(
        self, rule: Rule, fit: Fit, against: Fit, effects: Sequence[str] = (), evidence: Evidence = NONE
    ) -> bool:
        """Whether `fit` is kept over `against`.

        Args:
            effects: what is tried, by name; nothing for a spline term.
        """
        decision = self.criterion.decide(rule, fit, against, evidence)
        self.lines.append(Line(rule, tuple(effects), fit, against, evidence, decision))
        return decision.kept

    def decide_round(self, rule: Rule, tried: Sequence[Fit], against: Fit, *, holder: Fit | None = None) -> Fit | None:
        """Decide on candidates, best first, each of which adds its last effect to `against`; the one kept, if any."""
        evidence = Evidence(winner=tried[0] if tried else None, holder=holder)
        kept = [one for one in tried if self.decide(rule, one, against, one.hypothesis.names[-1:], evidence)]
        return kept[0] if kept else None
