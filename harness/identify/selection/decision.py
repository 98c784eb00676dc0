"""A decision of the selection: its kind, the evidence beside the fits, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from harness.identify.estimate.fit import Fit


class Rule(StrEnum):
    """Kinds of decisions; names as in diagnosis.json."""

    ADD = "add"  # add a candidate to the fit
    DROP = "drop"  # keep or drop an effect found earlier
    SWAP = "swap"  # replace an effect by a candidate
    SPLIT = "split"  # replace an effect by the two that it imitates
    MERGE = "merge"  # replace two effects by the one that imitates them
    RESTART = "restart"  # restart the search from a runner-up
    PREFER = "prefer"  # prefer the result of the restart to the first, or two effects to a spline term
    SPLINE = "spline"  # add a spline term
    REFINE = "refine"  # double the nodes of a spline term
    ABSORB = "absorb"  # keep or drop an effect beside the spline term that may contain it
    EXPLAIN = "explain"  # keep or drop effects by what they take away of a process noise far above its floor
    JOINT = "joint"  # keep the best of several sets of terms, by held-out errors
    VALIDATE = "validate"  # keep or drop what was selected, by held-out errors
    EXTEND = "extend"  # add a candidate, by held-out errors
    PRUNE = "prune"  # keep or drop an effect, by held-out errors
    EXCHANGE = "exchange"  # replace an effect by a candidate, by held-out errors
    CORRELATED = "correlated"  # keep or drop an effect whose score is correlated in time, by what its gain then weighs
    RESTORE = "restore"  # return to the spline term that likelihood selected, by held-out errors


@dataclass(frozen=True, eq=False)
class Evidence:
    """Evidence of a decision beside the two fits that it compares.

    Attributes:
        winner: the best fit of the round (ADD, SWAP, SPLINE, JOINT, EXTEND, EXCHANGE).
        holder: the fit with the effect to be replaced (SWAP), or without the spline term (ABSORB).
        without: fits without one or the other of the pair (SPLIT).
        before, after: deviance of each recording by fits to the others, without and with the term tried (SPLINE);
            errors of held-out blocks, of the alternative and of the fit tried, each by its own estimator [m] (RESTORE);
            in-sample loss of both [m²], one number each (EXCHANGE).
        tests: number of candidates among which the significance level is divided (EXTEND, EXCHANGE).
        nested: whether the effect is nested in the spline term (ABSORB).
        weight: by which the gain in deviance is divided, since the effect's score is correlated (CORRELATED) [1].
    """

    winner: Fit | None = None
    holder: Fit | None = None
    without: tuple[Fit, ...] = ()
    before: tuple[float, ...] = ()
    after: tuple[float, ...] = ()
    tests: int = 1
    nested: bool = False
    weight: float = 1.0


NONE = Evidence()


@dataclass(frozen=True)
class Decision:
    """Whether the terms tried are kept, by how much they lower the criterion, and the reason."""

    kept: bool
    gain: float
    because: str
