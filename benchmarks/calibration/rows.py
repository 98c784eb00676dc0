"""What came of a trial, and how it is judged against the truth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Any

from benchmarks.calibration.imperfect import says_imperfection, spline_says
from benchmarks.calibration.trials import Trial, Values
from harness.numerics import TWO_SIDED
from harness.simulator import UNLISTED as STRUCTURES


class Outcome(StrEnum):
    """How a result compares with the truth; every trial has exactly one."""

    RIGHT = "right"  # exactly what acts, or nothing where nothing does
    PARTNER = "partner"  # another effect, which the result says cannot be told from the one that acts
    MORE = "more"  # all that acts, and an effect that does not
    OTHER = "other"  # something else, and it does not say so
    UNLISTED = "unlisted"  # a spline term, where the catalogue has the effect
    NOTHING = "nothing"  # nothing, where something acts
    FAILED = "failed"  # the diagnosis ended with an error

    @property
    def found(self) -> bool:
        """Whether what acts is in the result."""
        return self in (Outcome.RIGHT, Outcome.PARTNER, Outcome.MORE)


@dataclass(frozen=True)
class Named:
    """An effect as a diagnosis named it: (value, low, high) by parameter (SI), and what it cannot be told from."""

    name: str
    values: dict[str, tuple[float, float, float]]
    indistinguishable_from: tuple[str, ...]


@dataclass(frozen=True)
class Interval:
    """An estimate with its 95 % interval, beside the truth."""

    effect: str
    parameter: str
    value: float
    low: float
    high: float
    truth: float

    @property
    def covers(self) -> bool:
        """Whether the truth lies within."""
        return self.low <= self.truth <= self.high

    @property
    def z(self) -> float:
        """Error in standard deviations that the interval on that side stands for; infinite for an empty one."""
        side = self.high - self.value if self.truth > self.value else self.value - self.low
        return (self.value - self.truth) * TWO_SIDED / side if side > 0.0 else math.inf


@dataclass(frozen=True, kw_only=True)
class Row:
    """One trial and its result.

    Attributes:
        trial: what was tried.
        source: digest of the sources that made the row.
        verdict: as in diagnosis.json; empty where it failed.
        named: the effects found.
        depends_on: regressor of the spline term; "reading" of one of the position sensor.
        seconds: that the diagnosis took.
        error: text of what went wrong.
        acted: what was hidden, where that was not known before the trial was posed (SI).
    """

    trial: Trial
    source: str
    verdict: str
    named: tuple[Named, ...] = ()
    depends_on: str | None = None
    seconds: float = math.nan
    error: str | None = None
    acted: Values = field(default_factory=dict)

    @property
    def outcome(self) -> Outcome:
        """Of what was found against what acts; what names an imperfection of the record is passed over."""
        if self.error is not None:
            return Outcome.FAILED
        truth = set(self.trial.hidden)
        names = {one.name for one in self.named if one.name in truth or not self._says_imperfection(one)}
        if self.trial.unlisted:
            first = STRUCTURES[next(iter(self.trial.unlisted))].depends_on[0]
            if self.depends_on is None:
                return Outcome.OTHER if names else Outcome.NOTHING
            if self.depends_on != first:
                return Outcome.OTHER
            return Outcome.RIGHT if names == truth else Outcome.MORE
        if self.depends_on is not None and not spline_says(self.trial.imperfection, self.trial.seed, self.depends_on):
            return Outcome.UNLISTED
        if names == truth:
            return Outcome.RIGHT
        if not names:
            return Outcome.NOTHING
        if truth and names > truth:
            return Outcome.MORE
        return Outcome.PARTNER if self._declares(names, truth) else Outcome.OTHER

    @property
    def says_imperfection(self) -> bool:
        """Whether an imperfection of the record is named as an effect or a spline term."""
        spline = spline_says(self.trial.imperfection, self.trial.seed, self.depends_on)
        return spline or any(one.name not in self.trial.hidden and self._says_imperfection(one) for one in self.named)

    @property
    def false_names(self) -> tuple[str, ...]:
        """Effects, and a spline term, that are named and neither act nor say what is wrong with the record."""
        trial = self.trial
        if self.outcome is Outcome.PARTNER:
            return ()
        names = [one.name for one in self.named if one.name not in trial.hidden and not self._says_imperfection(one)]
        if self.depends_on is not None and not spline_says(trial.imperfection, trial.seed, self.depends_on):
            names.append(f"spline of {self.depends_on}")
        return tuple(names)

    def _says_imperfection(self, one: Named) -> bool:
        values = {key: value for key, (value, _, _) in one.values.items()}
        return says_imperfection(self.trial.imperfection, self.trial.seed, one.name, values)

    def _declares(self, names: set[str], truth: set[str]) -> bool:
        """Whether every effect that is named instead of a true one says that it may be that one."""
        missing = truth - names
        instead = [one for one in self.named if one.name in names - truth]
        return len(missing) == len(instead) == 1 and missing <= set(instead[0].indistinguishable_from)

    def intervals(self) -> Iterator[Interval]:
        """Of all parameters, where everything that acts was named."""
        named = {one.name: one for one in self.named}
        if not self.trial.hidden or not set(self.trial.hidden) <= set(named):
            return
        for effect, values in (self.acted or self.trial.hidden).items():
            for parameter, truth in values.items():
                value, low, high = named[effect].values[parameter]
                yield Interval(effect, parameter, value, low, high, truth)

    def as_dict(self) -> dict[str, Any]:
        """For JSON; what is judged stands beside what it is judged from."""
        judged = {
            "spec": self.trial.spec,
            "outcome": str(self.outcome),
            "covered": [one.covers for one in self.intervals()],
        }
        return asdict(self) | judged

    @classmethod
    def from_dict(cls, record: dict[str, Any]) -> Row:
        """The reverse of `as_dict`; what is judged is judged anew."""
        fields = {key: record[key] for key in ("source", "verdict", "depends_on", "seconds", "error")}
        named = tuple(
            Named(
                one["name"],
                {key: (value, low, high) for key, (value, low, high) in one["values"].items()},
                tuple(one["indistinguishable_from"]),
            )
            for one in record["named"]
        )
        return cls(trial=Trial(**record["trial"]), named=named, acted=record.get("acted", {}), **fields)
